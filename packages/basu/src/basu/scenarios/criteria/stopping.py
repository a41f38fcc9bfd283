"""Criteria of stopping: coming to rest before a line, an obstacle or an actor."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from basu.errors import ScenarioError
from basu.metrics.boxes import other_boxes, own_boxes
from basu.metrics.stretches import stretches
from basu.scenarios.criteria.criterion import Aspect, Criterion
from basu.scenarios.criteria.margin import present_in
from basu.scenarios.criteria.surrogate_measures import gap_m
from basu.thresholds import AT_REST_MPS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.scenarios.criteria.criterion import Judgement, Played

BEYOND_M = 1.0  # over a line that is still before it, as for stop signs
APART_M = 1e-6  # boxes nearer than that touch


class StoppedFor(Criterion):
    """The ego comes to rest (below 0.1 m/s) before something and stays so for ``stand_s``.

    ``what`` is a role or a thing's name: at rest with its box within ``within_m`` of the ego's, untouched. With
    ``s_m``, a line across the route there, and ``what`` its name: at rest with the front bumper between ``within_m``
    before it and 1 m beyond. ``since`` is a phase from which on it counts.
    """

    aspect = Aspect.COMPLETED

    def __init__(
        self,
        what: str,
        *,
        s_m: float | None = None,
        within_m: float = 10.0,
        stand_s: float = 0.0,
        since: str | None = None,
        deciding: bool = True,
    ) -> None:
        super().__init__(deciding=deciding)
        if within_m <= 0.0 or stand_s < 0.0:
            raise ScenarioError(f"to stop within {within_m:g} m for {stand_s:g} s is nothing a vehicle can do")
        self.name = f"stops for {what}"
        self.what, self.s_m, self.within_m, self.stand_s, self.since = what, s_m, within_m, stand_s, since

    def judge(self, played: Played) -> Judgement:
        """The figure is how far before it the ego came to rest, or how slow it got."""
        history, first = played.history, played.first_tick(self.since)
        limit = f"at rest within {self.within_m:g} m" + (f" for {self.stand_s:g} s" if self.stand_s else "")
        if first is None:
            return self.says(played, None, f"'{self.since}' never began", unit="m", limit=limit)
        away_m = self._away_m(played)
        if np.isnan(away_m).all():
            return self.says(played, None, f"{self.what} never was near the ego", unit="m", limit=limit)
        near = (away_m <= self.within_m) & (away_m >= (-BEYOND_M if self.s_m is not None else APART_M))
        near[:first] = False
        resting = stretches(near & (history.speed_mps() < AT_REST_MPS))
        if not resting:
            tick, sentence = self._on(played, near, away_m)
            return self.says(played, False, sentence, tick=tick, measured=float(away_m[tick]), unit="m", limit=limit)
        begin, end = max(resting, key=lambda rest: rest[1] - rest[0])
        seconds, t_s = (end - begin) * history.facts.step_s, float(history.frames["t_s"][begin])
        return self.says(
            played,
            seconds >= self.stand_s,
            f"it stood {away_m[begin]:.2f} m before {self.what} from {t_s:.2f} s on for {seconds:.2f} s",
            tick=begin,
            measured=float(away_m[begin]),
            unit="m",
            limit=limit,
        )

    def _on(self, played: Played, near: NDArray[np.bool_], away_m: NDArray[np.float64]) -> tuple[int, str]:
        """The frame and the sentence of an ego that drove on."""
        history = played.history
        if not near.any():
            nearest = int(np.nanargmin(np.abs(away_m)))
            return nearest, f"it never was within {self.within_m:g} m before {self.what}"
        speed_mps = history.speed_mps()
        slowest = int(np.flatnonzero(near)[np.argmin(speed_mps[near])])
        return slowest, (
            f"it did not stop for {self.what}: the least speed within {self.within_m:g} m was "
            f"{speed_mps[slowest]:.2f} m/s at {float(history.frames['t_s'][slowest]):.2f} s"
        )

    def _away_m(self, played: Played) -> NDArray[np.float64]:
        """(T,) how far the ego is from it; nan where the record does not have it."""
        history = played.history
        if self.s_m is not None:
            ahead_m: NDArray[np.float64] = self.s_m - history.frames["route_s_m"] - history.facts.vehicle.front_m
            return ahead_m
        present = present_in(played)
        others = present.history.others[present.rows_of(self.what)]
        away_m = np.full(len(history.frames), np.nan)
        own = own_boxes(history.facts, history.frames)[others["tick"]]
        away_m[others["tick"]] = gap_m(own, other_boxes(present.history.facts, others))
        return away_m
