"""The planned route: lane-centre points with arc length, its part up to or from a place, and progress along it."""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.errors import UserError

if TYPE_CHECKING:
    import carla
    from numpy.typing import NDArray

    from basu.routing.timetable import Timetable


class ControlKind(enum.Enum):
    """What makes a driver stop or give way."""

    STOP_SIGN = "stop_sign"  # OpenDRIVE signal type 206
    YIELD_SIGN = "yield_sign"  # 205
    TRAFFIC_LIGHT = "traffic_light"  # 1000001 and its relatives


@dataclass(frozen=True, slots=True, kw_only=True)
class RouteControl:
    """A stop sign, yield sign or traffic light that governs the route's lane."""

    kind: ControlKind  # stop sign, yield sign or traffic light
    landmark_id: str  # OpenDRIVE signal id; a traffic light's actor is world.get_traffic_light_from_opendrive_id(...)
    s_m: float  # along the route, where the line to stop at is crossed
    x_m: float  # the lane's centre at the line, CARLA frame
    y_m: float  # likewise
    z_m: float  # likewise
    yaw_rad: float  # of the lane at the line, CARLA frame (clockwise from above)


@dataclass(frozen=True, slots=True, kw_only=True)
class Stop:
    """A service stop, where passengers get on and off."""

    id: str  # as the route file names it
    name: str  # for people
    s_m: float  # along the route
    x_m: float  # as the route file has it, CARLA frame
    y_m: float  # likewise
    z_m: float  # likewise
    yaw_rad: float  # likewise, clockwise from above


@dataclass(frozen=True, slots=True, kw_only=True)
class Route:
    """A path along lane centres, about one point a metre, all arrays of one length N. CARLA frame, yaw in rad."""

    id: str  # of the route in its file
    town: str  # name of the map
    points_m: NDArray[np.float64]  # (N, 3) x, y, z
    s_m: NDArray[np.float64]  # (N,) arc length in the plane from the first point, strictly increasing
    yaw_rad: NDArray[np.float64]  # (N,) of the lane
    lane_width_m: NDArray[np.float64]  # (N,) of the lane under each point
    speed_limit_mps: NDArray[np.float64]  # (N,) as the map posts it, nan where it posts none
    is_junction: NDArray[np.bool_]  # (N,) whether the point is in a junction
    road_id: NDArray[np.int64]  # (N,) OpenDRIVE road
    lane_id: NDArray[np.int64]  # (N,) OpenDRIVE lane; its sign gives the side of the road
    stops: tuple[Stop, ...] = ()  # in the order in which the route passes them
    controls: tuple[RouteControl, ...] = ()  # likewise
    timetable: Timetable | None = None  # when it is due at its stops; None without a timetable
    waypoints: tuple[carla.Waypoint, ...] = field(default=(), repr=False)  # (N,)

    @property
    def length_m(self) -> float:
        """The arc length of the plan, L_I in equation 5.3."""
        return float(self.s_m[-1])


LEAST_POINTS = 2  # of a route


def until(route: Route, s_m: float) -> Route:
    """Return the route as if it ended at its last point not beyond ``s_m``; distances along it stay what they are."""
    count = max(LEAST_POINTS, int(np.searchsorted(route.s_m, s_m, side="right")))
    if count >= len(route.s_m):
        return route
    last_s_m = float(route.s_m[count - 1])
    per_point = {name: getattr(route, name)[:count] for name in PER_POINT}
    return replace(
        route,
        **per_point,
        stops=tuple(stop for stop in route.stops if stop.s_m <= last_s_m),
        controls=tuple(control for control in route.controls if control.s_m <= last_s_m),
    )


def beginning_at(route: Route, s_m: float) -> Route:
    """Return the route as if it began at its first point not before ``s_m``; distances along it count from there.

    A route that is cut has no timetable: what is due at its stops counts from a departure at its old beginning.

    Raises:
        UserError: the route does not reach so far.
    """
    if s_m <= 0.0:
        return route
    first = int(np.searchsorted(route.s_m, s_m))
    if first > len(route.s_m) - LEAST_POINTS:
        raise UserError(f"route '{route.id}' is {route.length_m:.0f} m long, and no vehicle can begin at {s_m:.0f} m")
    from_m = float(route.s_m[first])
    per_point = {name: getattr(route, name)[first:] for name in PER_POINT}
    return replace(
        route,
        **{**per_point, "s_m": route.s_m[first:] - from_m},
        stops=tuple(replace(stop, s_m=stop.s_m - from_m) for stop in route.stops if stop.s_m >= from_m),
        controls=tuple(replace(each, s_m=each.s_m - from_m) for each in route.controls if each.s_m >= from_m),
        timetable=None,
    )


PER_POINT = (
    "points_m",
    "s_m",
    "yaw_rad",
    "lane_width_m",
    "speed_limit_mps",
    "is_junction",
    "road_id",
    "lane_id",
    "waypoints",
)


BACK_M, AHEAD_M = 5.0, 30.0  # how far from the last known place the next one is searched for


class Progress(NamedTuple):
    """A place along a route."""

    s_m: float  # along it
    lateral_m: float  # off the route, positive to the right
    distance_m: float  # from the nearest point of the route's polyline within the search window

    @staticmethod
    def at_start() -> Progress:
        """Return the progress before the first advance: 0 m."""
        return Progress(0.0, 0.0, 0.0)


def advance(route: Route, before: Progress, x_m: float, y_m: float) -> Progress:
    """Return the place of (x, y), CARLA frame, searched for near ``before``: some metres back to thirty ahead.

    A vehicle that left the route is searched for farther ahead, as far again as it is away, so that it may come back
    beyond what it went round.
    """
    back_m, ahead_m = search_window(before.s_m, before.distance_m)
    first = max(0, int(np.searchsorted(route.s_m, back_m)) - 1)
    end = min(len(route.s_m), int(np.searchsorted(route.s_m, ahead_m)) + 1)
    points_m = route.points_m
    away2 = (points_m[first:end, 0] - x_m) ** 2 + (points_m[first:end, 1] - y_m) ** 2
    nearest = first + int(away2.argmin())
    candidates = [
        _on_segment(route, index, x_m, y_m) for index in (nearest - 1, nearest) if 0 <= index < len(route.s_m) - 1
    ]
    return min(candidates, key=_distance)


def _distance(place: Progress) -> float:
    return place.distance_m


def _on_segment(route: Route, index: int, x_m: float, y_m: float) -> Progress:
    """Return the nearest place on the segment from point ``index`` to the next."""
    (x0_m, y0_m, _), (x1_m, y1_m, _) = route.points_m[index : index + 2].tolist()
    return Progress(*foot_on_segment(float(route.s_m[index]), x0_m, y0_m, x1_m, y1_m, x_m, y_m))


# Numbers to numbers: `linden_gym` compiles these for many vehicles at once.


def search_window(s_m: float, distance_m: float) -> tuple[float, float]:
    """Return from where to where along the route the next place is searched for, after a place at ``s_m``."""
    return s_m - BACK_M, s_m + AHEAD_M + 2.0 * distance_m


def foot_on_segment(
    s_m: float, x0_m: float, y0_m: float, x1_m: float, y1_m: float, x_m: float, y_m: float
) -> tuple[float, float, float]:
    """Return the values of `Progress` at the place nearest to (x, y) on a segment that begins at ``s_m``."""
    along_x_m, along_y_m = x1_m - x0_m, y1_m - y0_m
    length_m = math.hypot(along_x_m, along_y_m)
    to_x_m, to_y_m = x_m - x0_m, y_m - y0_m
    share = min(1.0, max(0.0, (to_x_m * along_x_m + to_y_m * along_y_m) / (length_m * length_m)))
    off_x_m, off_y_m = to_x_m - share * along_x_m, to_y_m - share * along_y_m
    right = along_x_m * off_y_m - along_y_m * off_x_m  # y points south: positive is to the right
    distance_m = math.hypot(off_x_m, off_y_m)
    return s_m + share * length_m, math.copysign(distance_m, right), distance_m
