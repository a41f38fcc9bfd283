"""`SlowerUntilTtc`: a vehicle in the next lane is slower than the ego, until a cut-in meets a time to collision."""

from __future__ import annotations

import math
from collections import deque
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.scenarios.actions.path_follower import FollowerLimits, PathFollower
from basu.scenarios.stage import EGO

if TYPE_CHECKING:
    from basu.scenarios.paths import Path

LEAST_MPS = 0.5  # along the lane; slower, it does not get into the ego's lane
SETTLED_S = 1.0  # for which it has its speed before it moves sideways, and the ego has had its own before it sets off
LAG_S = 0.075  # a frame until the lane change begins, and half a frame by which a led vehicle is behind its path
STEADY_MPS = 0.2  # by which a steady speed changes in that time


class LaneChangeCrossing(NamedTuple):
    """A lane change up to the moment of the intrusion."""

    along_m: float
    driven_m: float
    share: float  # of its speed that a vehicle has along the lane in that moment


def crossing_to(moved_m: float, across_m: float, over_m: float) -> LaneChangeCrossing:
    """Return the part of a lane change, ``across_m`` over ``over_m``, in which it moves ``moved_m`` sideways.

    The change is that of `Path.swerved`.
    """
    u = np.linspace(0.0, 1.0, 1001)
    right_m = across_m * u**3 * (10.0 - 15.0 * u + 6.0 * u**2)
    driven_m = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(u * over_m), np.diff(right_m)))])
    at = float(np.interp(moved_m, right_m, u))
    slope = across_m / over_m * 30.0 * at**2 * (1.0 - at) ** 2
    return LaneChangeCrossing(at * over_m, float(np.interp(at, u, driven_m)), 1.0 / math.hypot(1.0, slope))


class SlowerUntilTtc(PathFollower):
    """Let a vehicle wait beside the ego's lane, set off before the ego, and keep ``difference_mps`` less than it had.

    Done at the moment for a lane change: its side will cross a line at a time to collision of ``ttc_s``. The line is
    ``edge_m`` beside the middle of its lane. So its speed and the moment follow from the ego's own driving. ``over_m``
    and ``across_m`` are those of the lane change to come.
    """

    def __init__(
        self,
        actor: str,
        path: Path,
        difference_mps: float,
        ttc_s: float,
        *,
        edge_m: float,
        across_m: float,
        over_m: float,
        accelerate_mps2: float = 3.5,
    ) -> None:
        super().__init__(
            f"{actor} is {difference_mps:.1f} m/s slower than the ego until {ttc_s:g} s before a collision",
            actor,
            path,
            limits=FollowerLimits(accelerate_mps2, 4.0),
        )
        self.difference_mps, self.ttc_s = difference_mps, ttc_s
        self.edge_m, self.across_m, self.over_m = edge_m, across_m, over_m
        self.keeps_mps: float | None = None

    def begin(self) -> None:
        """The vehicle waits."""
        super().begin()
        self.keeps_mps = None
        moved_m = self.edge_m - self.stage.body(self.actor).half_width_m
        self.crossing = crossing_to(moved_m, self.across_m, self.over_m)
        self.ego_mps: deque[float] = deque(maxlen=1 + round(SETTLED_S / self.stage.step_s))

    def wanted_mps(self) -> float:
        """None until it is time to set off, then what the ego's steady speed makes it, once and for all."""
        if self.keeps_mps is None:
            ego_mps = self.stage.body(EGO).forward_mps
            self.ego_mps.append(ego_mps)
            along_mps = ego_mps - self.difference_mps
            is_steady = len(self.ego_mps) == self.ego_mps.maxlen and max(self.ego_mps) - min(self.ego_mps) < STEADY_MPS
            if is_steady and along_mps >= LEAST_MPS and self._gap_m() <= self._sets_off_m(ego_mps, along_mps):
                self.keeps_mps = along_mps / self.crossing.share
        return self.keeps_mps or 0.0

    def over(self) -> str | None:
        """How far and how fast the ego is behind, once it is time."""
        if self.keeps_mps is None or abs(self.speed_mps - self.keeps_mps) > 1e-6:
            return None
        ego_mps, gap_m = self.stage.body(EGO).forward_mps, self._gap_m()
        if gap_m > self._begins_m(ego_mps, self.keeps_mps):
            return None
        return f"the ego {gap_m:.1f} m behind at {ego_mps:.1f} m/s"

    def _gap_m(self) -> float:
        """Return the distance between the bumpers along the path."""
        ego, body = self.stage.body(EGO), self.stage.body(self.actor)
        behind_m = self.s_m - self.path.nearest(ego.x_m, ego.y_m).s_m  # it is far behind at first
        return behind_m - ego.half_length_m - body.half_length_m

    def _begins_m(self, ego_mps: float, keeps_mps: float) -> float:
        """Return the gap at which the lane change begins: the ego comes nearer until the intrusion."""
        crosses_s = self.crossing.driven_m / keeps_mps
        return (self.ttc_s + LAG_S) * self.difference_mps + ego_mps * crosses_s - self.crossing.along_m

    def _sets_off_m(self, ego_mps: float, along_mps: float) -> float:
        """Return the gap at which it sets off: it needs some time to have its speed."""
        keeps_mps = along_mps / self.crossing.share
        rises_s = keeps_mps / self.limits.accelerate_mps2
        waits_m = (ego_mps - keeps_mps) * SETTLED_S + (ego_mps - keeps_mps / 2.0) * rises_s
        return self._begins_m(ego_mps, keeps_mps) + max(0.0, waits_m)
