"""`is_free` predicts if the opposite lane stays clear of other actors, visible or not, for the duration of a detour.

All actors that the agent knows on the street ahead count. An oncoming vehicle is taken to accelerate to the posted
limit; one out of sight is taken to drive at the limit, just beyond the visible stretch. That is the sight
distance for passing in its plainest form: own time in the other lane times the other's speed (AASHTO, A Policy on
Geometric Design of Highways and Streets, 6th ed., section 3.2.4, distances d2 to d4).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.agents.builtin.rules.corridor import Strip
from basu.agents.builtin.rules.gap_acceptance import START_S, time_to_cover_s
from basu.agents.builtin.rules.obstacles import SIDE_MARGIN_M
from basu.agents.builtin.scene import ActorKind
from basu.thresholds import STANDING_TRAFFIC_MPS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.agents.builtin.driving.path import PathPosition, SampledPath
    from basu.agents.builtin.passing.detour import Detour
    from basu.agents.builtin.passing.road import RoadBesidePath
    from basu.agents.builtin.scene import DrivenVehicle, Other, VehicleGeometry

ONCOMING_RAD, SAME_WAY_RAD = math.radians(120.0), math.radians(60.0)
OTHERS_ACCEL_MPS2 = 1.5  # acceleration of an oncoming vehicle
BESIDE_STREET_M = 1.5  # farther than this to the left of the other lane one is on another street
BEHIND_M = 40.0  # an actor behind in the other lane overtakes; the search goes this far back
MAY_TURN_IN_M = 30.0  # an actor moving this near to the next junction may turn into our street
STEP_M = 1.0


class Need(NamedTuple):
    """What the other lane has to be free for."""

    detour: Detour
    members: frozenset[int]  # actors that are passed
    accel_mps2: float
    margin_s: float
    sight_m: float  # how far from the vehicle others are seen


def time_needed_s(ego: DrivenVehicle, place: PathPosition, body: VehicleGeometry, need: Need) -> float:
    """Until the rear bumper is back in the own lane."""
    way_m = need.detour.extent.to_s_m + body.rear_m - place.s_m
    start_s = START_S if ego.speed_mps < 1.0 else 0.0
    return start_s + time_to_cover_s(way_m, ego.speed_mps, need.accel_mps2, need.detour.speed_mps)


def is_free(
    path: SampledPath,
    road: RoadBesidePath,
    body: VehicleGeometry,
    ego: DrivenVehicle,
    place: PathPosition,
    others: Sequence[Other],
    need: Need,
) -> bool:
    """Whether one may go round now; ``path`` is the middle of the own lane, ``place`` the vehicle's beside it."""
    extent = need.detour.extent
    within_s = time_needed_s(ego, place, body, need) + need.margin_s
    limit_mps = road.limit_mps[place.near]
    if (need.sight_m - (extent.to_s_m - place.s_m)) / limit_mps < within_s:
        return False
    strip = Strip(need.detour.path, place)
    for other in others:
        if other.id in need.members:
            continue
        if other.speed_mps < STANDING_TRAFFIC_MPS:
            if _stands_in_it(strip, other, body, extent.from_s_m, extent.to_s_m):
                return False
        elif other.kind is ActorKind.VEHICLE and _comes(path, road, place, other, need, within_s):
            return False
    return True


def _stands_in_it(strip: Strip, other: Other, body: VehicleGeometry, from_s_m: float, to_s_m: float) -> bool:
    """Whether a standing body blocks the detour."""
    if strip.away_m([other])[0] > other.half_length_m + other.half_width_m + body.half_width_m + SIDE_MARGIN_M:
        return False
    where = strip.footprint(other)
    return (
        where is not None
        and where.overlaps(body.half_width_m + SIDE_MARGIN_M)
        and where.to_s_m > from_s_m
        and where.from_s_m < to_s_m + body.front_m
    )


def _comes(
    path: SampledPath, road: RoadBesidePath, place: PathPosition, other: Other, need: Need, within_s: float
) -> bool:
    """Whether a moving vehicle will be where we need to be."""
    extent = need.detour.extent
    street_end_s_m = min(road.next_junction_s_m(extent.to_s_m), extent.to_s_m + need.sight_m)
    s_m, lateral_m, heading_rad = _beside(path, place, other, street_end_s_m)
    off_rad = abs(math.remainder(other.yaw_rad - heading_rad, math.tau))
    limit_mps = road.limit_mps[place.near]
    end = path.index_at(street_end_s_m)
    away_m = math.hypot(other.x_m - path.x_m[end], other.y_m - path.y_m[end])
    if s_m > street_end_s_m - STEP_M and away_m < MAY_TURN_IN_M and off_rad > SAME_WAY_RAD:
        gap_m = away_m - other.half_length_m + street_end_s_m - extent.to_s_m
        return time_to_cover_s(gap_m, other.speed_mps, OTHERS_ACCEL_MPS2, limit_mps) < within_s
    room_m, half_lane_m = road.left_room_m[path.index_at(extent.aside_s_m)], road.half_lane_m[place.near]
    if not -room_m - BESIDE_STREET_M < lateral_m < half_lane_m:
        return False
    if off_rad > ONCOMING_RAD:
        gap_m = s_m - other.half_length_m - extent.to_s_m
        if s_m + other.half_length_m < place.s_m:
            return False  # it is past us
        return time_to_cover_s(gap_m, other.speed_mps, OTHERS_ACCEL_MPS2, limit_mps) < within_s
    if off_rad < SAME_WAY_RAD:
        overtakes = lateral_m < -half_lane_m and place.s_m - BEHIND_M < s_m < place.s_m
        return overtakes or place.s_m < s_m < extent.to_s_m
    return extent.from_s_m < s_m < extent.to_s_m


def _beside(path: SampledPath, place: PathPosition, other: Other, until_s_m: float) -> tuple[float, float, float]:
    """Arc length, distance to the right and heading of the path where it passes a body, from behind us to far ahead.

    Beyond ``until_s_m``, where the path may turn off, the street is taken to lead straight on.
    """
    first, end = path.index_at(place.s_m - BEHIND_M), path.index_at(until_s_m) + 1
    gaps_m = path.points_m[first:end] - (other.x_m, other.y_m)
    near = first + int(np.einsum("wd,wd->w", gaps_m, gaps_m).argmin())
    dx_m, dy_m, heading_rad = other.x_m - path.x_m[near], other.y_m - path.y_m[near], path.heading_rad[near]
    cos, sin = math.cos(heading_rad), math.sin(heading_rad)
    return path.s_m[near] + dx_m * cos + dy_m * sin, dy_m * cos - dx_m * sin, heading_rad
