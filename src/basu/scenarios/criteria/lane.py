"""Staying in one's lane: within its edges, or at least on the road."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from basu.metrics.stretches import stretches
from basu.scenarios.criteria.criterion import Criterion

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.history import History
    from basu.scenarios.criteria.criterion import Judgement, Played

LEAST_S = 0.2  # shorter stretches outside are forgiven: the lookup of lanes may skip where they meet


class KeepsLane(Criterion):
    """The ego's middle stays within ``tolerance_m`` of its lane's edges (0.5 m is the leaderboard's).

    The lane is that of the planned route. With ``passing`` the ego may leave it deliberately, as round an obstacle:
    then only the road counts, that is the edge of the nearest driving or parking lane, of either direction. Without it
    both count. ``since`` is a phase from which on it is judged.
    """

    name = "keeps lane"

    def __init__(
        self,
        tolerance_m: float = 0.5,
        *,
        passing: bool = False,
        since: str | None = None,
        deciding: bool = True,
    ) -> None:
        super().__init__(deciding=deciding)
        self.name = "keeps on the road" if passing else "keeps lane"
        self.tolerance_m, self.passing, self.since = tolerance_m, passing, since

    def judge(self, played: Played) -> Judgement:
        """The figure is how far it was beyond the edge at most, not above 0 where it never was."""
        limit = f"at most {self.tolerance_m:g} m beyond the edge"
        first = played.first_tick(self.since)
        if first is None:
            return self.says(played, None, f"'{self.since}' never began", unit="m", limit=limit)
        history = played.history
        beyond_m = history.frames["off_lane_m"] if self.passing else _beyond_m(history)
        outside = beyond_m > self.tolerance_m
        outside[:first] = False
        for begin, end in stretches(outside):
            if (end - begin) * history.facts.step_s < LEAST_S:
                outside[begin:end] = False
        where = np.flatnonzero(outside)
        candidates = where if len(where) else np.arange(first, len(outside))
        worst = int(candidates[np.argmax(beyond_m[candidates])])
        most_m = float(beyond_m[worst])
        return self.says(
            played,
            len(where) == 0,
            self._sentence(history, outside, worst),
            tick=worst,
            measured=most_m,
            unit="m",
            limit=limit,
        )

    def _sentence(self, history: History, outside: NDArray[np.bool_], worst: int) -> str:
        """What the worst frame shows."""
        frame = history.frames[worst]
        side = "right" if frame["lateral_m"] > 0.0 else "left"
        at = (
            f"{abs(float(frame['lateral_m'])):.2f} m to the {side} of its route's middle at {float(frame['t_s']):.2f} s"
        )
        edge = "the road" if self.passing else "its lane"
        if not outside.any():
            return f"it kept within {edge}; at most it was {at}"
        seconds = np.count_nonzero(outside) * history.facts.step_s
        beyond_m = float(frame["off_lane_m"] if self.passing else _beyond_m(history)[worst])
        speed_mps = float(history.speed_mps()[worst])
        how = f"for {seconds:.2f} s it was off {edge}, up to {beyond_m:.2f} m beyond the edge"
        return f"{how}: {at} at {speed_mps:.2f} m/s"


def _beyond_m(history: History) -> NDArray[np.float64]:
    """(T,) how far the ego's middle was beyond the edge of the planned lane or of the road, whichever is more."""
    route, frames = history.facts.route, history.frames
    index = np.clip(np.searchsorted(route.s_m, frames["route_s_m"], side="right") - 1, 0, None)
    beside_m = np.abs(frames["lateral_m"]) - route.lane_width_m[index] / 2.0
    beyond_m: NDArray[np.float64] = np.maximum(
        beside_m, np.where(frames["off_lane_m"] > 0.0, frames["off_lane_m"], -np.inf)
    )
    return beyond_m
