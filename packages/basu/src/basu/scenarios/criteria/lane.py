"""Staying in one's lane: within its edges, or at least on the road."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from basu.metrics.stretches import stretches
from basu.metrics.validity import BEYOND_M, beyond_edge_m
from basu.scenarios.criteria.criterion import Aspect, Criterion

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.records.history import History
    from basu.scenarios.criteria.criterion import Judgement, Played

HOLD_S = 1.0  # a vehicle back for so long has regained its lane, and not swung through it
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
        tolerance_m: float = BEYOND_M,
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
        aside_m = np.abs(history.frames["lateral_m"])
        worst = int(max(candidates.tolist(), key=lambda tick: (beyond_m[tick], aside_m[tick])))
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


class Regains(Criterion):
    """Back on its way within ``within_s`` of a disturbance's end, which is the beginning of the phase ``after``.

    Back is within ``lateral_m`` of the route's middle and within ``yaw_deg`` of its direction, for a second on end.
    """

    aspect = Aspect.COMPLETED
    name = "regains its lane"

    def __init__(
        self,
        within_s: float = 5.0,
        lateral_m: float = 0.75,
        yaw_deg: float = 10.0,
        *,
        after: str = "resolution",
        deciding: bool = True,
    ) -> None:
        super().__init__(deciding=deciding)
        self.within_s, self.lateral_m, self.yaw_deg, self.after = within_s, lateral_m, yaw_deg, after

    def judge(self, played: Played) -> Judgement:
        """The figure is the time that it took."""
        limit = f"within {self.within_s:g} s of {self.after}, by {self.lateral_m:g} m and {self.yaw_deg:g}°"
        first = played.first_tick(self.after)
        if first is None:
            return self.says(played, None, f"'{self.after}' never began", unit="s", limit=limit)
        frames, step_s = played.history.frames, played.history.facts.step_s
        off_rad = _off_direction_rad(played.history)
        back = (np.abs(frames["lateral_m"]) <= self.lateral_m) & (np.abs(off_rad) <= np.radians(self.yaw_deg))
        back[:first] = False
        held = [s for s, e in stretches(back) if e == len(back) or (e - s) * step_s >= HOLD_S]
        tick = held[0] if held else len(back) - 1
        took_s = float(frames["t_s"][tick] - frames["t_s"][first])
        where = f"{abs(float(frames['lateral_m'][tick])):.2f} m and {abs(float(np.degrees(off_rad[tick]))):.1f}° off"
        said = f"it was back {took_s:.2f} s after" if held else f"it was not back {took_s:.2f} s after"
        farthest_m = float(np.abs(frames["lateral_m"][first : tick + 1]).max())
        return self.says(
            played,
            bool(held) and took_s <= self.within_s,
            f"{said} the disturbance, {where} its way; until then it was up to {farthest_m:.2f} m off",
            tick=tick,
            measured=took_s,
            unit="s",
            limit=limit,
        )


def _off_direction_rad(history: History) -> NDArray[np.float64]:
    """(T,) the ego's heading less that of its route, within a half turn."""
    route, frames = history.facts.route, history.frames
    planned_rad = np.interp(frames["route_s_m"], route.s_m, np.unwrap(route.yaw_rad))
    off_rad: NDArray[np.float64] = np.angle(np.exp(1j * (frames["yaw_rad"] - planned_rad)))
    return off_rad


def _beyond_m(history: History) -> NDArray[np.float64]:
    """(T,) how far the ego's middle was beyond the edge of the planned lane or of the road, whichever is more."""
    off_lane_m = history.frames["off_lane_m"]
    beyond_m: NDArray[np.float64] = np.maximum(beyond_edge_m(history), np.where(off_lane_m > 0.0, off_lane_m, -np.inf))
    return beyond_m
