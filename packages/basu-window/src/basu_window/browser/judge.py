"""The judgement of a drive while it lasts: score so far, infractions, and the latest collisions."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.infraction import counts

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.managers.metrics_manager import MetricsManager
    from basu.metrics.infraction import Evidence
    from basu.metrics.score import Scores

EVERY_S = 0.5  # the least time between two judgements
SHARE = 0.05  # of the wall time, at most, goes into judging: a copy of the record takes longer the longer it is
WINDOW_TICKS = 200  # of the graph of collisions


class Judgement(NamedTuple):
    """The drive so far."""

    scores: Scores | None = None  # None before the first judgement
    found: tuple[Evidence, ...] = ()
    contacts: tuple[tuple[int, float], ...] = ()  # tick and impulse in N s

    def impulses(self, tick: int) -> NDArray[np.float64]:
        """(WINDOW_TICKS,) impulses of the ticks up to ``tick``."""
        window = np.zeros(WINDOW_TICKS)
        for at, impulse_ns in self.contacts:
            if 0 <= (ago := tick - at) < WINDOW_TICKS:
                window[WINDOW_TICKS - 1 - ago] += impulse_ns
        return window

    def tally(self) -> list[str]:
        """Return what was done wrong and how often, in words."""
        return [f"{number} x {kind.value.replace('_', ' ')}" for kind, number in counts(self.found).items()]


class Judge:
    """Judges the record so far, twice a second at most."""

    def __init__(self, metrics: MetricsManager) -> None:
        self._metrics = metrics
        self._next_s = 0.0
        self.latest = Judgement()

    def refresh(self, now_s: float, *, anyway: bool = False) -> None:
        """Judge the record so far, if that is due; ``now_s`` is of ``time.perf_counter``."""
        if now_s < self._next_s and not anyway:
            return
        found = self._metrics.infractions_so_far()
        self.latest = Judgement(self._metrics.scores_so_far(), found, _contacts(self._metrics))
        self._next_s = now_s + max(EVERY_S, (time.perf_counter() - now_s) / SHARE)


def _contacts(metrics: MetricsManager) -> tuple[tuple[int, float], ...]:
    """Return the latest messages of the collision sensor."""
    latest = metrics.contacts_since(metrics.ticks - WINDOW_TICKS)
    return tuple((event.tick, float(np.linalg.norm(event.impulse_ns))) for event in latest)
