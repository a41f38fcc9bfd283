"""The route as the leaderboard hands it to an agent: transforms and GPS places, each with what to do there."""

from __future__ import annotations

import math
import sys
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from basu.agents.leaderboard.provided.road_option import RoadOption

if TYPE_CHECKING:
    import carla
    from numpy.typing import NDArray

    from basu.agents.leaderboard.gps import Gps
    from basu.routing import Route

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
