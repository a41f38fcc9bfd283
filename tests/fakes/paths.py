"""Records of drives along any path: progress by the benchmark's own search, lanes by formula."""

import math
from collections.abc import Sequence

import numpy as np

from basu.records.history import FRAME, Facts, History, Recorder
from basu.records.history.model import NO_LIGHT
from basu.routing import Route, RouteControl, Stop
from basu.routing.planned_route import Progress, advance
from fakes.drives import DRIVING, STEP_S, VEHICLE

LANE_M = 3.5
Points = Sequence[tuple[float, float]]


def route_along(corners: Points, controls: tuple[RouteControl, ...] = (), stops: tuple[Stop, ...] = ()) -> Route:
    """A route a point a metre through corners, in the right-hand lane of a street with two lanes."""
    x_m, y_m, s_m = resampled(corners, 1.0)
    yaw_rad = np.arctan2(np.gradient(y_m), np.gradient(x_m))
    count = len(s_m)
    return Route(
        id="path",
        town="Nowhere",
        points_m=np.column_stack([x_m, y_m, np.zeros(count)]),
        s_m=s_m,
        yaw_rad=yaw_rad,
        lane_width_m=np.full(count, LANE_M),
        speed_limit_mps=np.full(count, 11.0),
        is_junction=np.zeros(count, dtype=np.bool_),
        road_id=np.ones(count, dtype=np.int64),
        lane_id=np.full(count, -1, dtype=np.int64),
        controls=controls,
        stops=stops,
    )


def resampled(corners: Points, step_m: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """x, y and length along a polyline, ``step_m`` apart."""
    corner_m = np.array(corners, dtype=np.float64)
    at_m = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(corner_m, axis=0).T))])
    s_m = np.arange(0.0, at_m[-1] + 1e-6, step_m)
    return np.interp(s_m, at_m, corner_m[:, 0]), np.interp(s_m, at_m, corner_m[:, 1]), s_m


def along(route: Route, corners: Points, *, speed_mps: float = 8.0, rests_at: Points = ()) -> History:
    """The record of driving through ``corners`` at a steady speed, resting 2 s at each of ``rests_at``."""
    x_m, y_m, _ = resampled(corners, speed_mps * STEP_S)
    rest = {int(np.argmin(np.hypot(x_m - x, y_m - y))) for x, y in rests_at}
    poses = []
    for index, (x, y) in enumerate(zip(x_m.tolist(), y_m.tolist(), strict=True)):
        ahead = min(index + 1, len(x_m) - 1)
        yaw_rad = math.atan2(y_m[ahead] - y_m[ahead - 1], x_m[ahead] - x_m[ahead - 1])
        poses += [(x, y, yaw_rad, 0.0)] * (40 if index in rest else 0) + [(x, y, yaw_rad, speed_mps)]
    return driven_through(route, poses)


def driven_through(route: Route, poses: Sequence[tuple[float, float, float, float]]) -> History:
    """The record of poses (x, y, yaw, speed), one a tick."""
    recorder, progress = Recorder(), Progress.at_start()
    for tick, (x_m, y_m, yaw_rad, speed_mps) in enumerate(poses):
        progress = advance(route, progress, x_m, y_m)
        values = {
            "tick": tick,
            "t_s": tick * STEP_S,
            "x_m": x_m,
            "y_m": y_m,
            "yaw_rad": yaw_rad,
            "velocity_x_mps": speed_mps * math.cos(yaw_rad),
            "velocity_y_mps": speed_mps * math.sin(yaw_rad),
            "traffic_light_state": NO_LIGHT,
            "route_s_m": progress.s_m,
            "lateral_m": progress.lateral_m,
            "route_light": NO_LIGHT,
            **lane_under(route, x_m, y_m),
        }
        recorder.frame([float(values.get(name, 0.0)) for name in FRAME.names or ()])
    facts = Facts(step_s=STEP_S, vehicle=VEHICLE, route=route, actor_types={}, actor_sizes={})
    return recorder.history(facts)


def lane_under(route: Route, x_m: float, y_m: float) -> dict[str, float]:
    """The columns of the lane at a place: the route's lane, the oncoming one to its left, or none."""
    away_m = np.hypot(route.points_m[:, 0] - x_m, route.points_m[:, 1] - y_m)
    nearest = int(np.argmin(away_m))
    yaw_rad = float(route.yaw_rad[nearest])
    to_x_m, to_y_m = x_m - route.points_m[nearest, 0], y_m - route.points_m[nearest, 1]
    right = to_y_m * math.cos(yaw_rad) - to_x_m * math.sin(yaw_rad)
    offset_m = math.copysign(float(away_m[nearest]), right)
    if -1.5 * LANE_M <= offset_m <= 0.5 * LANE_M:
        is_own = offset_m >= -0.5 * LANE_M
        lane = {"lane_id": -1, "lane_heading_rad": 0.0} if is_own else {"lane_id": 1, "lane_heading_rad": math.pi}
        return {"road_id": 1, "lane_type": DRIVING, "lane_width_m": LANE_M, **lane}
    return {"off_lane_m": max(offset_m - 0.5 * LANE_M, -1.5 * LANE_M - offset_m)}
