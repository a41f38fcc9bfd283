"""Speeding while a drive lasts: the same episodes as ``speeding`` finds, each frame looked at once."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from basu.metrics.speeding import LEAST_S, episode, limits_mps

if TYPE_CHECKING:
    from collections.abc import Callable

    from basu.metrics.infraction import Evidence
    from basu.records.history import History


@dataclass(slots=True)
class _Open:
    """An episode that goes on."""

    first: int
    top_mps: float
    posted_mps: float

    def see(self, speed_mps: float, limit_mps: float) -> None:
        """Keep the largest excess, the earliest of equal ones."""
        if speed_mps - limit_mps > self.top_mps - self.posted_mps:
            self.top_mps, self.posted_mps = speed_mps, limit_mps


class SpeedingSoFar:
    """The episodes until now; ``pending`` holds the one that goes on."""

    def __init__(self, tolerance_mps: float) -> None:
        self.settled: list[Evidence] = []
        self.pending: list[Evidence] = []
        self._tolerance_mps = tolerance_mps
        self._seen = 0  # frames looked at
        self._open: _Open | None = None

    def look(self, window: Callable[[int], History]) -> None:
        """Take in the frames that are new."""
        history = window(self._seen)
        speeds, limits = history.speed_mps().tolist(), limits_mps(history).tolist()
        for tick, (speed_mps, limit_mps) in enumerate(zip(speeds, limits, strict=True), self._seen):
            if speed_mps <= limit_mps:
                self.settled += self._told(window, tick)
                self._open = None
            elif self._open is not None:
                self._open.see(speed_mps, limit_mps)
            elif speed_mps > limit_mps + self._tolerance_mps:
                self._open = _Open(tick, speed_mps, limit_mps)
        self._seen += len(speeds)
        self.pending = self._told(window, self._seen)

    def _told(self, window: Callable[[int], History], end: int) -> list[Evidence]:
        """The open episode as it is at ``end``, nothing where there is none or it is too short to count."""
        if self._open is None:
            return []
        begun = window(self._open.first)
        seconds = (end - self._open.first) * begun.facts.step_s
        if seconds < LEAST_S:
            return []
        told = episode(begun, 0, top_mps=self._open.top_mps, posted_mps=self._open.posted_mps, seconds=seconds)
        return [replace(told, tick=self._open.first)]
