"""The route as the leaderboard gives it to an agent: transforms and GPS positions, each with a road option.

The leaderboard reckons its plan with a plain Mercator projection, as CARLA's GNSS did until 0.9.15: latitude falls as
y grows. CARLA 0.9.16 reckons otherwise and lets latitude grow with y, so that there plan, sensor and compass
contradict each other. Agents were written for the agreement: they get both in the leaderboard's degrees.
"""

from __future__ import annotations

import math
import re
import sys
from typing import TYPE_CHECKING, Any, NamedTuple

import carla
import numpy as np

from basu_leaderboard.provided.planned_agent import RoadOption

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.routing import Route


EARTH_RADIUS_M = 6378137.0  # the equator's, as in CARLA
NOWHERE = (42.0, 2.0)  # the leaderboard's, where a map does not say where it lies
REFERENCE = re.compile(r"\+(lat_0|lon_0)=(-?[0-9.]+(?:[eE][-+]?\d+)?)")
STEPS = 3  # of Newton's method, for a function that is all but a straight line


class Place(NamedTuple):
    """Degrees, and m above the map's zero."""

    latitude: float
    longitude: float
    altitude_m: float


class Gps:
    """The leaderboard's degrees on one map."""

    def __init__(self, carla_map: carla.Map) -> None:
        self._map = carla_map
        self._latitude, self._longitude = reference(carla_map.to_opendrive())
        self._scale = math.cos(math.radians(self._latitude))
        self._north_m = _mercator_m(self._latitude, self._scale)
        self._last = carla.Location()

    def place(self, at: carla.Location) -> Place:
        """Where a location lies; Mercator's projection, scaled at the map's reference."""
        east_rad = at.x / (EARTH_RADIUS_M * self._scale)
        north_rad = (self._north_m - at.y) / (EARTH_RADIUS_M * self._scale)
        latitude = math.degrees(2.0 * math.atan(math.exp(north_rad)) - math.pi / 2.0)
        return Place(latitude, self._longitude + math.degrees(east_rad), at.z)

    def measured(self, fix: NDArray[np.float64]) -> NDArray[np.float64]:
        """A measurement of CARLA's in these degrees; both (3,), latitude, longitude and altitude in m."""
        place = self.place(self._location(float(fix[0]), float(fix[1])))
        return np.array([place.latitude, place.longitude, fix[2]], np.float64)

    def _location(self, latitude: float, longitude: float) -> carla.Location:
        """Where CARLA's degrees are: its own function turned round by Newton's method from the last result."""
        at = self._last
        for _ in range(STEPS):
            here, east, south = (
                self._degrees(carla.Location(at.x + x_m, at.y + y_m)) for x_m, y_m in ((0, 0), (1, 0), (0, 1))
            )
            slope = np.column_stack([east - here, south - here])
            x_m, y_m = np.linalg.solve(slope, np.array([latitude, longitude]) - here)
            at = carla.Location(at.x + x_m, at.y + y_m)
        self._last = at
        return at

    def _degrees(self, at: carla.Location) -> NDArray[np.float64]:
        """CARLA's latitude and longitude of a location."""
        found = self._map.transform_to_geolocation(at)
        return np.array([found.latitude, found.longitude])


def reference(opendrive: str) -> tuple[float, float]:
    """Latitude and longitude of a map's origin in degrees, from its geoReference."""
    found = re.search(r"<geoReference>(.*?)</geoReference>", opendrive, re.DOTALL)
    said = dict(REFERENCE.findall(found.group(1))) if found else {}
    return float(said.get("lat_0", NOWHERE[0])), float(said.get("lon_0", NOWHERE[1]))


def _mercator_m(latitude: float, scale: float) -> float:
    """How far north of the equator a latitude lies on the map."""
    return scale * EARTH_RADIUS_M * math.log(math.tan(math.pi / 4.0 + math.radians(latitude) / 2.0))


TURN_RAD = math.radians(35.0)  # less is straight on: so CARLA's global_route_planner.py
THEIR_OPTIONS = "agents.navigation.local_planner"


class GlobalPlan(NamedTuple):
    """The dense plan, about a point a metre, in both forms."""

    gps: list[tuple[dict[str, float], Any]]  # lat, lon in degrees, z in m; RoadOption
    world: list[tuple[carla.Transform, Any]]


def global_plan(route: Route, gps: Gps) -> GlobalPlan:
    """Tell a route in the leaderboard's terms; the options are CARLA's own where the agent has loaded those."""
    theirs: Any = getattr(sys.modules.get(THEIR_OPTIONS), "RoadOption", RoadOption)
    options = [theirs[RoadOption(number).name] for number in road_options(route.yaw_rad, route.is_junction)]
    plan = GlobalPlan([], [])
    for waypoint, option in zip(route.waypoints, options, strict=True):
        pose = waypoint.transform
        place = gps.place(pose.location)
        plan.gps.append(({"lat": place.latitude, "lon": place.longitude, "z": place.altitude_m}, option))
        plan.world.append((pose, option))
    return plan


def road_options(yaw_rad: NDArray[np.float64], is_junction: NDArray[np.bool_]) -> NDArray[np.int64]:
    """What to do at each of N points: left, right or straight on through a junction, else follow the lane.

    How a junction is crossed is judged by the turn from the road before it to its end. CARLA's planner looks at the
    other ways through the junction too, and may call the leftmost of two right turns a left one; this does not. A
    route that begins in a junction follows its lane there, as in CARLA's.

    Args:
        yaw_rad: (N,) of the lane, clockwise.
        is_junction: (N,).
    """
    options = np.full(len(yaw_rad), RoadOption.LANEFOLLOW, np.int64)
    edges = np.flatnonzero(np.diff(is_junction.astype(np.int8), prepend=0, append=0))
    for begin, end in edges.reshape(-1, 2):
        if begin == 0:
            continue
        turn_rad = float(yaw_rad[end - 1] - yaw_rad[begin - 1])
        turn_rad = math.atan2(math.sin(turn_rad), math.cos(turn_rad))
        if abs(turn_rad) < TURN_RAD:
            options[begin:end] = RoadOption.STRAIGHT
        else:
            options[begin:end] = RoadOption.LEFT if turn_rad < 0.0 else RoadOption.RIGHT
    return options
