"""What lies beside the ego's lane: where people walk and where vehicles stand."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import carla

if TYPE_CHECKING:
    from basu.scenarios.place import Place

PAVEMENT_M = 5.6  # from the middle of the lane to the pavement's, where the map knows of none
PARKING_M = 1.05  # from the edge of the lane to the middle of who is parked there, likewise
LANES = 12  # no street has more beside one another
STANDS_IN = (carla.LaneType.Parking, carla.LaneType.Shoulder)


def pavement_m(place: Place, ahead_m: float, side: str) -> float:
    """How far to the right of the route (negative: to the left) the middle of the pavement is."""
    away_m = _away_m(place, ahead_m, side, (carla.LaneType.Sidewalk,)) or PAVEMENT_M
    return away_m if side == "right" else -away_m


def parked_m(place: Place, ahead_m: float) -> float:
    """How far to the right of the route somebody parked at the kerb has its middle."""
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
