"""Paths along the map's lanes, and the places beside the ego's lane."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

import carla

from basu.errors import ScenarioError
from basu.scenarios.paths.path import Path

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.scenarios.place import Place
    from basu.scenarios.stage import Pose


Turn = Literal["straight", "left", "right"]
STEP_M = 1.0  # between the points of a path along a lane
LOOK_M = 60.0  # a way through a junction is looked along no farther than this
WANTED_RAD: dict[Turn, float] = {"straight": 0.0, "left": -math.pi / 2.0, "right": math.pi / 2.0}


def point_of(waypoint: carla.Waypoint) -> tuple[float, float, float]:
    """Where a way point is."""
    at = waypoint.transform.location
    return at.x, at.y, at.z


def yaw_rad_of(waypoint: carla.Waypoint) -> float:
    """Where it heads."""
    return math.radians(waypoint.transform.rotation.yaw)


def turned_rad(before: carla.Waypoint, after: carla.Waypoint) -> float:
    """By how much the heading differs, clockwise, within (-pi, pi]."""
    return math.remainder(yaw_rad_of(after) - yaw_rad_of(before), math.tau)


def turn_of(angle_rad: float) -> Turn:
    """The word for a change of heading; what turns by less than 45 degrees goes straight on."""
    if abs(angle_rad) < math.pi / 4.0:
        return "straight"
    return "right" if angle_rad > 0.0 else "left"


def waypoint_at(carla_map: carla.Map, pose: Pose) -> carla.Waypoint:
    """The driving lane at a pose.

    Raises:
        ScenarioError: there is none within 5 m.
    """
    at = carla.Location(pose.x_m, pose.y_m, pose.z_m)
    found = carla_map.get_waypoint(at, project_to_road=True, lane_type=carla.LaneType.Driving)
    away_m = math.inf if found is None else math.dist(point_of(found)[:2], (pose.x_m, pose.y_m))
    if found is None or away_m > max(5.0, found.lane_width):
        raise ScenarioError(f"no driving lane lies at ({pose.x_m:.1f}, {pose.y_m:.1f})")
    return found


def through_junction(entered: carla.Waypoint) -> carla.Waypoint:
    """The last way point of a connecting road, from one on it."""
    here = entered
    for _ in range(int(LOOK_M / STEP_M)):
        ahead = here.next(STEP_M)
        if not ahead or not ahead[0].is_junction:
            return here
        here = ahead[0]
    return here


def followed(start: carla.Waypoint, length_m: float, turns: Sequence[Turn] = ()) -> list[carla.Waypoint]:
    """Way points ahead along the lane; at each fork the next of ``turns``, and straight on where none is left.

    Ends early where the road does.
    """
    way, left = [start], list(turns)
    for _ in range(math.ceil(length_m / STEP_M)):
        ahead = way[-1].next(STEP_M)
        if not ahead:
            break
        if len(ahead) > 1:
            ahead = [_chosen(way[-1], ahead, left.pop(0) if left else "straight")]
        way.append(ahead[0])
    return way


def _chosen(before: carla.Waypoint, ahead: list[carla.Waypoint], turn: Turn) -> carla.Waypoint:
    """The branch that turns most nearly as wanted."""

    def off_rad(branch: carla.Waypoint) -> float:
        return abs(math.remainder(turned_rad(before, through_junction(branch)) - WANTED_RAD[turn], math.tau))

    return min(ahead, key=off_rad)


def along_lane(carla_map: carla.Map, start: Pose, length_m: float, turns: Sequence[Turn] = ()) -> Path:
    """Along the lane at a pose, in the lane's direction; at forks the turns in order, then straight on."""
    return Path.through([point_of(w) for w in followed(waypoint_at(carla_map, start), length_m, turns)])


def back_along_lane(end: carla.Waypoint, length_m: float) -> list[carla.Waypoint]:
    """Way points that lead to ``end``, itself the last; where several lead there, the straightest."""
    way = [end]
    for _ in range(math.ceil(length_m / STEP_M)):
        behind = way[-1].previous(STEP_M)
        if not behind:
            break
        here = way[-1]
        way.append(min(behind, key=lambda before: abs(turned_rad(before, here))))
    return way[::-1]


def oncoming(place: Place, from_ahead_m: float, to_ahead_m: float, right_m: float = 0.0) -> Path:
    """The opposite lane beside the ego's route, towards the ego: from far ahead of the trigger point to nearer.

    ``right_m`` is to the right in the direction of driving there. Where the map has no opposite lane, the path is the
    route's mirrored about its left edge, so that a one-way street can be driven against.

    Raises:
        ScenarioError: ``from_ahead_m`` is not beyond ``to_ahead_m``.
    """
    if from_ahead_m <= to_ahead_m:
        raise ScenarioError(f"oncoming: it begins at {from_ahead_m:.0f} m, not beyond its end at {to_ahead_m:.0f} m")
    points = []
    for step in range(math.floor((from_ahead_m - to_ahead_m) / STEP_M) + 1):
        ahead_m = from_ahead_m - step * STEP_M
        points.append(place.at(ahead_m, -lanes_apart_m(place, ahead_m))[:3])
    return Path.through(points).beside(right_m)


def lanes_apart_m(place: Place, ahead_m: float) -> float:
    """From the middle of the route's lane to that of the nearest lane against it; a lane's width where none is."""
    width_m = place.width_m(ahead_m)
    if not place.route.waypoints:
        return width_m
    lane = place.waypoint(ahead_m)
    here, direction, away_m = point_of(lane), lane.lane_id > 0, 0.0
    while lane is not None and away_m < 4.0 * width_m:
        lane = lane.get_left_lane()
        if lane is None:
            break
        away_m = math.dist(point_of(lane)[:2], here[:2])
        if lane.lane_type == carla.LaneType.Driving and (lane.lane_id > 0) != direction:
            return away_m
        if (lane.lane_id > 0) != direction:
            break
    return width_m


PAVEMENT_M = 5.6  # from the middle of the lane to the pavement's, where the map knows of none
PARKING_M = 1.05  # from the edge of the lane to the middle of a parked vehicle, likewise
LANES = 12  # no street has more beside one another
STANDS_IN = (carla.LaneType.Parking, carla.LaneType.Shoulder)


def pavement_m(place: Place, ahead_m: float, side: str) -> float:
    """How far to the right of the route (negative: to the left) the middle of the pavement is."""
    away_m = _away_m(place, ahead_m, side, (carla.LaneType.Sidewalk,)) or PAVEMENT_M
    return away_m if side == "right" else -away_m


def parked_m(place: Place, ahead_m: float) -> float:
    """How far to the right of the route a vehicle parked at the kerb has its middle."""
    return _away_m(place, ahead_m, "right", STANDS_IN) or place.width_m(ahead_m) / 2.0 + PARKING_M


def _away_m(place: Place, ahead_m: float, side: str, kinds: tuple[carla.LaneType, ...]) -> float | None:
    """From the route's lane to the nearest lane of some kinds on a side of the street; None where there is none."""
    if not place.route.waypoints:
        return None
    lane = place.waypoint(ahead_m)
    nearer: carla.Waypoint = lane
    outwards = side == "right"
    for _ in range(LANES):
        beside = nearer.get_right_lane() if outwards else nearer.get_left_lane()
        if beside is None:
            return None
        if not outwards and beside.lane_id * nearer.lane_id < 0:
            outwards = True  # over the middle of the street, where right is outwards
        if beside.lane_type in kinds:
            here, there = lane.transform.location, beside.transform.location
            return math.hypot(there.x - here.x, there.y - here.y)
        nearer = beside
    return None
