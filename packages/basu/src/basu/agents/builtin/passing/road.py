"""`RoadBesidePath`: lane widths, free width to the left, limits, junctions, stop lines and stops along a path."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from basu.agents.builtin.driving.task import junctions
from basu.routing import ControlKind

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.agents.builtin.driving.path import SampledPath
    from basu.routing import Route


@dataclass(frozen=True, slots=True, eq=False)
class RoadBesidePath:
    """N values beside a path's points, and places along it; m, m/s."""

    half_lane_m: list[float]
    left_room_m: list[float]  # from the lane's middle to the left edge of what may be driven on, 0 in junctions
    right_lane_m: list[float]  # from the lane's middle to that of a lane of the same direction on its right, 0: none
    limit_mps: list[float]  # posted; what others are taken to drive at most
    junctions_s_m: tuple[tuple[float, float], ...]
    lines_s_m: tuple[float, ...]  # stop and yield lines, lights: where one may stand in a queue
    stops_s_m: tuple[float, ...]  # service stops

    def least_left_room_m(self, path: SampledPath, from_s_m: float, to_s_m: float) -> float:
        """The narrowest room on a stretch."""
        return min(self.left_room_m[path.index_at(from_s_m) : path.index_at(to_s_m) + 1])

    def meets_junction(self, from_s_m: float, to_s_m: float) -> bool:
        """Whether a stretch reaches into a junction."""
        return any(begin < to_s_m and end > from_s_m for begin, end in self.junctions_s_m)

    def next_junction_s_m(self, s_m: float) -> float:
        """Where the next junction begins, inf where there is none."""
        return min((begin for begin, _ in self.junctions_s_m if begin > s_m), default=math.inf)

    def next_line_s_m(self, s_m: float) -> float:
        """The next place at which one may have to wait, inf where there is none."""
        return min((mark for mark in (*self.lines_s_m, self.next_junction_s_m(s_m)) if mark > s_m), default=math.inf)


def make_road(
    route: Route,
    path: SampledPath,
    left_width_m: NDArray[np.float64],
    right_lane_m: NDArray[np.float64],
    unposted_mps: float,
) -> RoadBesidePath:
    """Lay what is known of a route's points beside a path's.

    Args:
        route: with M points.
        path: with N points.
        left_width_m: (M,) of the driving lane to the left, whatever its direction, 0 where there is none.
        right_lane_m: (M,) to the middle of the lane to the right that leads the same way, 0 where there is none.
        unposted_mps: the speed that others are taken to drive where no limit is posted.
    """
    nearest = np.searchsorted(route.s_m, path.s_m).clip(0, len(route.s_m) - 1)
    half_m = route.lane_width_m / 2.0
    posted_mps = np.where(np.isnan(route.speed_limit_mps), unposted_mps, route.speed_limit_mps)
    signs = {ControlKind.STOP_SIGN, ControlKind.YIELD_SIGN, ControlKind.TRAFFIC_LIGHT}
    return RoadBesidePath(
        half_lane_m=half_m[nearest].tolist(),
        left_room_m=np.where(route.is_junction, 0.0, half_m + left_width_m)[nearest].tolist(),
        right_lane_m=np.where(route.is_junction, 0.0, right_lane_m)[nearest].tolist(),
        limit_mps=posted_mps[nearest].tolist(),
        junctions_s_m=tuple(junctions(route)),
        lines_s_m=tuple(c.s_m for c in route.controls if c.kind in signs),
        stops_s_m=tuple(stop.s_m for stop in route.stops),
    )
