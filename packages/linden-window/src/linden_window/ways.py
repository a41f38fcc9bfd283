"""`Ways`: the way along the lanes of a map from a vehicle to a place, with the speed at each point of it.

The process of the pages looks for ways, so that no search delays a tick. `linden_window.errands` drives them.
"""

import heapq
import math

import numpy as np
from numpy.typing import NDArray

from linden.maps.opendrive.evaluate.tables import Tables, tables_of
from linden.maps.opendrive.links import is_forward, lane_links
from linden.maps.opendrive.parse import parse
from linden.protocol.values.enums import LaneType

F64 = NDArray[np.float64]

STEP_M = 1.5
"""Between two points of a way."""
REACH_M = 30.0
"""A lane that is farther away from a place is not taken."""
ON_M = 3.0
"""A place that is farther away from the middle of all lanes is not on one."""
_TURNED_DEG = 60.0
"""A lane that points into another direction is none that the vehicle is on."""
_UNPOSTED_MPS = 30.0 / 3.6
"""Limit where the map posts none: CARLA's, ``linden.simulation.episode``."""
_ACROSS_MPS2 = 1.8
"""Comfortable in curves, also for standing passengers."""
_SLOWS_MPS2 = 1.5
_SLOWEST_MPS = 2.0
_CURVE_M = 4.5
"""Length over which a bend is measured."""


class Ways:
    """The driving lanes of a map as points in the direction of travel, in CARLA's frame."""

    def __init__(self, text: str) -> None:
        """Sample the lanes of an OpenDRIVE text.

        Raises:
            UserError: the text is no OpenDRIVE that can be used.
        """
        opendrive = parse(text)
        tables = tables_of(opendrive)
        self._after = lane_links(opendrive).successors
        rows = np.flatnonzero(tables.lanes["type_bits"] & int(LaneType.DRIVING))
        self._begins: dict[int, slice] = {}
        parts: list[F64] = [np.zeros((0, 5))]
        at = 0
        for row in rows.tolist():
            points = _points_of(tables, row)
            self._begins[row] = slice(at, at + len(points))
            at += len(points)
            parts.append(points)
        self._points = np.concatenate(parts)
        self._lane = np.repeat(rows, [self._begins[row].stop - self._begins[row].start for row in rows.tolist()])

    def way(self, x_m: float, y_m: float, yaw_deg: float, to_x_m: float, to_y_m: float) -> F64 | None:
        """Return points (N, 3) of x, y in m and the speed in m/s; None where no lane leads from one to the other."""
        starts = self._near(x_m, y_m, yaw_deg)
        goals = self._near(to_x_m, to_y_m, None)
        for goal in goals:
            for start in starts:
                lanes = self._lanes(int(self._lane[start]), int(self._lane[goal]), start, goal)
                if lanes is not None:
                    return _with_speeds(self._along(lanes, start, goal))
        return None

    def heading_deg(self, x_m: float, y_m: float) -> float | None:
        """Return the direction of travel of the lane at a place, degrees; None where there is none within ``ON_M``."""
        away = np.hypot(self._points[:, 0] - x_m, self._points[:, 1] - y_m)
        if not len(away) or away.min() > ON_M:
            return None
        return float(np.degrees(self._points[np.argmin(away), 2]))

    def _near(self, x_m: float, y_m: float, yaw_deg: float | None) -> list[int]:
        """Return the nearest point of each lane near a place, nearest lane first."""
        away = np.hypot(self._points[:, 0] - x_m, self._points[:, 1] - y_m)
        if yaw_deg is not None:
            turned = np.abs((np.degrees(self._points[:, 2]) - yaw_deg + 180.0) % 360.0 - 180.0)
            away = np.where(turned > _TURNED_DEG, np.inf, away)
        near = np.flatnonzero(away < REACH_M)
        near = near[np.argsort(away[near], kind="stable")]
        _, first = np.unique(self._lane[near], return_index=True)
        return [int(point) for point in near[np.sort(first)]][:8]

    def _lanes(self, start: int, goal: int, start_point: int, goal_point: int) -> list[int] | None:
        """Return the lanes of the quickest way, by Dijkstra's algorithm."""
        if start == goal and goal_point >= start_point:
            return [start]
        best: dict[int, float] = {}
        before: dict[int, int] = {}
        waiting = [(self._duration_s(after), after, start) for after in self._after[start] if after in self._begins]
        heapq.heapify(waiting)
        while waiting:
            cost, lane, came = heapq.heappop(waiting)
            if lane in best:
                continue
            best[lane], before[lane] = cost, came
            if lane == goal:
                found = [lane]
                while len(found) == 1 or found[-1] != start:
                    found.append(before[found[-1]])
                return found[::-1]
            for after in self._after[lane]:
                if after in self._begins and after not in best:
                    heapq.heappush(waiting, (cost + self._duration_s(after), after, lane))
        return None

    def _duration_s(self, lane: int) -> float:
        points = self._points[self._begins[lane]]
        return STEP_M * len(points) / float(points[:, 3].min())

    def _along(self, lanes: list[int], start: int, goal: int) -> F64:
        parts = [self._points[self._begins[lane]] for lane in lanes]
        first, last = start - self._begins[lanes[0]].start, goal - self._begins[lanes[-1]].start
        parts[-1] = parts[-1][: last + 1]
        parts[0] = parts[0][first:]
        return np.concatenate(parts)


def _points_of(tables: Tables, row: int) -> F64:
    """Return points (N, 5) of a lane in the direction of travel: x, y in m, yaw in rad, limit in m/s, z in m."""
    lane = tables.lanes[row]
    start_m, end_m = float(lane["start_m"]), float(lane["end_m"])
    count = max(2, math.ceil((end_m - start_m) / STEP_M) + 1)
    s_m = np.linspace(start_m + 1e-3, max(start_m + 2e-3, end_m - 1e-3), count).astype(np.float64)
    rows = np.full(count, row)
    places = tables.lane_centres(rows, s_m)
    limit = tables.speeds.value(rows, s_m)
    forward = is_forward(tables.roads[int(lane["road"])], int(lane["lane_id"]))
    yaw = -places.heading_rad + (0.0 if forward else math.pi)
    found = np.column_stack([places.x_m, -places.y_m, yaw, np.where(limit > 0.0, limit, _UNPOSTED_MPS), places.z_m])
    return found if forward else found[::-1]


def _with_speeds(points: F64) -> F64:
    """Return x, y and the speed of points: slow in bends, and 0 at the end."""
    step = np.hypot(*np.diff(points[:, :2], axis=0).T)
    points = points[np.append(True, step > 0.05)]
    gone = np.append(0.0, np.cumsum(np.hypot(*np.diff(points[:, :2], axis=0).T)))
    yaw = np.unwrap(points[:, 2])
    ahead = np.interp(gone + _CURVE_M / 2.0, gone, yaw)
    bend = np.abs(ahead - np.interp(gone - _CURVE_M / 2.0, gone, yaw)) / _CURVE_M
    speed = np.minimum(points[:, 3], np.maximum(_SLOWEST_MPS, np.sqrt(_ACROSS_MPS2 / np.maximum(bend, 1e-6))))
    speed[-1] = 0.0
    for at in range(len(speed) - 2, -1, -1):
        speed[at] = min(speed[at], math.sqrt(speed[at + 1] ** 2 + 2.0 * _SLOWS_MPS2 * (gone[at + 1] - gone[at])))
    return np.column_stack([points[:, :2], speed])
