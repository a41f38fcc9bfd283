"""Ways across a street on foot, seen from the ego's route, and when to set out so as to meet it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

import carla

from basu.scenarios.paths import Path
from basu.scenarios.triggers import TimeToArrival

if TYPE_CHECKING:
    from basu.scenarios.place import Place

Side = Literal["right", "left"]
FRONT_M = 2.2  # from a vehicle's middle to its bumper: the shuttle's is 2.0 m, a car's about 2.4 m
PAVEMENT_M = 5.6  # from the middle of the lane to the pavement's, where the map knows of none
PARKING_M = 1.05  # from the edge of the lane to the middle of who is parked there, likewise
STARTS_MPS2 = 8.0  # how walkers get going, as linden.physics.walker has it
LANES = 12  # no street has more beside one another
STANDS_IN = (carla.LaneType.Parking, carla.LaneType.Shoulder)


def pavement_m(place: Place, ahead_m: float, side: str) -> float:
    """How far to the right of the route (negative: to the left) the middle of the pavement is."""
    away_m = _away_m(place, ahead_m, side, (carla.LaneType.Sidewalk,)) or PAVEMENT_M
    return away_m if side == "right" else -away_m


def parked_m(place: Place, ahead_m: float) -> float:
    """How far to the right of the route somebody parked at the kerb has its middle."""
    return _away_m(place, ahead_m, "right", STANDS_IN) or place.width_m(ahead_m) / 2.0 + PARKING_M


def other_side(side: str) -> Side:
    """The side across the street."""
    return "left" if side == "right" else "right"


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


def across(place: Place, ahead_m: float, from_right_m: float, to_right_m: float) -> Path:
    """Straight across the route."""
    return Path.through([place.at(ahead_m, from_right_m)[:3], place.at(ahead_m, to_right_m)[:3]])


def facing_deg(from_right_m: float) -> float:
    """How somebody beside the route is turned who looks across it."""
    return -90.0 if from_right_m > 0.0 else 90.0


def walking_s(distance_m: float, speed_mps: float) -> float:
    """How long somebody who stands needs for a way."""
    return distance_m / speed_mps + speed_mps / (2.0 * STARTS_MPS2)


def ego_is_due(place: Place, ahead_m: float, seconds: float, what: str) -> TimeToArrival:
    """The ego's bumper is so many seconds from a place ahead of the trigger point."""
    return TimeToArrival(place.trigger_s_m + ahead_m - FRONT_M, seconds, what)
