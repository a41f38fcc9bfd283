"""The record of a drive that a ROS bag holds, such as a real shuttle's, for ``basu score``."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import carla
import numpy as np

from basu.errors import UserError
from basu.managers.base_manager import Ego
from basu.managers.observations import NO_LANE, LaneFinder
from basu.records.history import Facts, History, Vehicle
from basu.records.history.model import FRAME, NO_LIGHT, OTHER
from basu.records.structured import StructuredArray
from basu.routing import Route, lane_graph, plan
from basu.routing.planned_route import Progress, advance

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from basu.routing.route_file import RouteDescription
    from basu_ros.bag_track import Track

STEP_S = 0.05  # as a run's
SPACING_M = 1.0  # between the points of a route
LEAST_M = 2.0  # of a drive


class Shape(NamedTuple):
    """The vehicle in the bag: lengths in m, from the point that its odometry tells the place of."""

    front_m: float
    rear_m: float
    width_m: float
    origin_m: float = 0.0  # how far the vehicle's middle lies ahead of that point


def record_of(
    track: Track, shape: Shape, *, carla_map: carla.Map | None, description: RouteDescription | None, town: str
) -> History:
    """Return the record of a drive, a frame every 0.05 s; the route is the driven path where none is given.

    Without a map nothing is known of lanes and limits.

    Raises:
        UserError: the vehicle stood all the time, or the route cannot be laid on the map.
    """
    t_s = np.arange(0.0, track.t_s[-1] + 1e-9, STEP_S)
    pose = _resampled(t_s, track.t_s, track.pose)
    pose[:, 0] += shape.origin_m * np.cos(pose[:, 5])
    pose[:, 1] += shape.origin_m * np.sin(pose[:, 5])
    velocity = _resampled(t_s, track.t_s, track.velocity_mps)
    columns = [pose, velocity, np.gradient(velocity, STEP_S, axis=0) if len(t_s) > 1 else 0.0 * velocity]
    motion = np.hstack([*columns, _resampled(t_s, track.t_s, track.spin_radps)])
    motion[:, 3:6] = np.remainder(motion[:, 3:6] + math.pi, math.tau) - math.pi
    if description is not None and carla_map is not None:
        route = plan(carla_map, description)
    else:
        route = _driven(motion, carla_map, town)
    rows = _rows(t_s, motion, _held(t_s, track), route, carla_map)
    vehicle = Vehicle(type_id="bag", front_m=shape.front_m, rear_m=shape.rear_m, width_m=shape.width_m)
    facts = Facts(step_s=STEP_S, vehicle=vehicle, route=route, actor_types={}, actor_sizes={})
    nothing = np.zeros(0, dtype=OTHER)
    return History(facts=facts, frames=rows, others=nothing, collisions=(), lane_invasions=())


def _resampled(t_s: NDArray[np.float64], at_s: NDArray[np.float64], values: NDArray[np.float64]) -> NDArray[np.float64]:
    """(T, K) values between those at ``at_s``."""
    return np.stack([np.interp(t_s, at_s, column) for column in values.T], axis=1)


def _held(t_s: NDArray[np.float64], track: Track) -> NDArray[np.float64]:
    """(T, 5) the latest control at each time; zero before the first."""
    if len(track.controls) == 0:
        return np.zeros((len(t_s), 5))
    latest = np.searchsorted(track.control_t_s, t_s + 1e-9, side="right") - 1
    return np.where(latest[:, None] >= 0, track.controls[np.maximum(latest, 0)], 0.0)


def _driven(motion: NDArray[np.float64], carla_map: carla.Map | None, town: str) -> Route:
    """The driven path as a route, with the lanes below it where there is a map."""
    steps_m = np.hypot(*np.diff(motion[:, :2], axis=0).T)
    along_m = np.concatenate([[0.0], np.cumsum(np.where(steps_m > 1e-4, steps_m, 0.0))])
    if along_m[-1] < LEAST_M:
        raise UserError(f"the vehicle in the bag moved {along_m[-1]:.2f} m; a drive needs {LEAST_M:g} m to be scored")
    s_m = np.linspace(0.0, along_m[-1], 1 + max(1, round(along_m[-1] / SPACING_M)))
    moved = np.concatenate([[True], np.diff(along_m) > 0.0])
    points = np.stack([np.interp(s_m, along_m[moved], motion[moved, axis]) for axis in range(3)], axis=1)
    yaw = np.unwrap(motion[moved, 5])
    lanes = _lanes_below(points, carla_map)
    return Route(
        id="driven",
        town=town,
        points_m=points,
        s_m=s_m,
        yaw_rad=np.interp(s_m, along_m[moved], yaw),
        lane_width_m=np.array([math.nan if lane is None else lane.lane_width for lane in lanes]),
        speed_limit_mps=_limits(lanes, carla_map),
        is_junction=np.array([lane is not None and lane.is_junction for lane in lanes], dtype=np.bool_),
        road_id=np.array([0 if lane is None else lane.road_id for lane in lanes], dtype=np.int64),
        lane_id=np.array([0 if lane is None else lane.lane_id for lane in lanes], dtype=np.int64),
    )


def _lanes_below(points: NDArray[np.float64], carla_map: carla.Map | None) -> list[carla.Waypoint | None]:
    """The nearest driving lane of each point; None without a map."""
    if carla_map is None:
        return [None] * len(points)
    return [carla_map.get_waypoint(carla.Location(*map(float, point))) for point in points]


def _limits(lanes: list[carla.Waypoint | None], carla_map: carla.Map | None) -> NDArray[np.float64]:
    """The posted limits in m/s, nan where none is known."""
    if carla_map is None:
        return np.full(len(lanes), math.nan)
    roads = lane_graph.build(carla_map).roads
    return np.array([math.nan if lane is None else roads[lane.road_id].limit_at(lane.s) for lane in lanes])


def _rows(
    t_s: NDArray[np.float64],
    motion: NDArray[np.float64],
    controls: NDArray[np.float64],
    route: Route,
    carla_map: carla.Map | None,
) -> StructuredArray:
    """The frames of the record."""
    finder: Callable[[Ego], tuple[float, ...]] = (
        (lambda _: NO_LANE) if carla_map is None else LaneFinder(carla_map).under
    )
    place = Progress.at_start()
    rows = []
    for tick, (time_s, state, control) in enumerate(zip(t_s.tolist(), motion.tolist(), controls.tolist(), strict=True)):
        ego = Ego(*state)
        place = advance(route, place, ego.x_m, ego.y_m)
        limit = route.speed_limit_mps[int(np.searchsorted(route.s_m, place.s_m, side="right")) - 1]
        posted = 0.0 if math.isnan(limit) else float(limit)
        seen = (posted, NO_LIGHT, place.s_m, place.lateral_m, NO_LIGHT, 0)
        rows.append((tick, time_s, *ego, *control, *control, *seen, *finder(ego)))
    return np.array(rows, dtype=FRAME)
