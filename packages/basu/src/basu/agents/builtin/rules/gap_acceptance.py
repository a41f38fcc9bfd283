"""Gap acceptance: predicted conflicts on the road ahead, and critical headways for crossing and joining.

Whatever the critical headway of the handbook says, a slow vehicle needs the time that it takes to leave the crossing
behind; the longer of the two counts. After all patience, a vehicle takes a gap of the bare crossing time.
"""

from __future__ import annotations

import enum
import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.agents.builtin.driving.manner import LEFT_FROM_MINOR_S, RIGHT_FROM_MINOR_S, THROUGH_FROM_MINOR_S
from basu.agents.builtin.scene import ActorKind
from basu.thresholds import STANDING_TRAFFIC_MPS

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from basu.agents.builtin.driving.manner import Gaps, Manner
    from basu.agents.builtin.driving.path import SampledPath
    from basu.agents.builtin.scene import DrivenVehicle, Other, VehicleGeometry


START_S = 1.5  # from the decision until the vehicle really moves, with a margin
USED_SHARE = 0.8  # of the comfortable acceleration that is there on average: it has to build up first
TURN_RAD = math.radians(45.0)  # a way that turns by less than this goes through


class Movement(enum.Enum):
    """What a way does in a junction; the value is the critical headway from a minor street, s."""

    LEFT = LEFT_FROM_MINOR_S
    THROUGH = THROUGH_FROM_MINOR_S
    RIGHT = RIGHT_FROM_MINOR_S


def movement(path: SampledPath, from_s_m: float, to_s_m: float) -> Movement:
    """What the path does between two arc lengths."""
    turn_rad = path.heading_at_rad(to_s_m) - path.heading_at_rad(from_s_m)
    if abs(turn_rad) < TURN_RAD:
        return Movement.THROUGH
    return Movement.LEFT if turn_rad < 0.0 else Movement.RIGHT


def time_to_cover_s(distance_m: float, speed_mps: float, accel_mps2: float, top_mps: float) -> float:
    """Seconds for a distance, speeding up evenly to ``top_mps`` and no further; a faster vehicle keeps its speed."""
    if distance_m <= 0.0:
        return 0.0
    speed_mps = max(speed_mps, 0.0)
    top_mps = max(top_mps, speed_mps, 0.1)
    rise_m = (top_mps * top_mps - speed_mps * speed_mps) / (2.0 * accel_mps2)
    if distance_m <= rise_m:
        return (math.sqrt(speed_mps * speed_mps + 2.0 * accel_mps2 * distance_m) - speed_mps) / accel_mps2
    return (top_mps - speed_mps) / accel_mps2 + (distance_m - rise_m) / top_mps


class GapRule(NamedTuple):
    """What one vehicle accepts at one line."""

    critical_s: float  # the handbook's headway times the manner's factor
    margin_s: float
    patience_s: float
    accel_mps2: float  # with which it crosses …
    top_mps: float  # … up to this speed

    def needed_s(self, distance_m: float, speed_mps: float, waited_s: float) -> float:
        """Return the least gap in s; after ``distance_m``, the rear bumper has left the crossing."""
        start_s = START_S if speed_mps < 1.0 else 0.0
        own_s = start_s + time_to_cover_s(distance_m, speed_mps, self.accel_mps2, self.top_mps)
        return own_s if waited_s > self.patience_s else max(self.critical_s, own_s + self.margin_s)


def make_rule(gaps: Gaps, manner: Manner, critical_s: float, top_mps: float) -> GapRule:
    """The rule at a line behind which one drives ``top_mps`` at most."""
    accel_mps2 = USED_SHARE * manner.comfort.accel_mps2
    return GapRule(gaps.factor * critical_s, gaps.margin_s, gaps.patience_s, accel_mps2, top_mps)


TURNING_S = 2.0  # a vehicle that turns now is taken to turn on for this long, then to go straight
STEP_S = 0.5  # of predictions
CLEARANCE_M = 0.4  # beyond both half widths
ASTERN_RAD = math.radians(110.0)  # seen at more than this from straight ahead, with our heading: it follows us
SAME_WAY_RAD = math.radians(50.0)
NEARBY_M = 12.0  # a standing vehicle this near to the zone may be waiting to cross it
WAITING_REACH_M = 15.0  # it would then drive this far straight ahead


class Zone(NamedTuple):
    """The part of the path between a line and where the crossing is left behind."""

    points_m: NDArray[np.float64]  # (M, 2), CARLA frame
    length_m: float
    half_width_m: float  # of the vehicle that is to drive over it


def make_zone(path: SampledPath, from_s_m: float, to_s_m: float, body: VehicleGeometry) -> Zone:
    """The path's points between two arc lengths."""
    first, end = path.index_at(from_s_m), path.index_at(to_s_m) + 1
    return Zone(path.points_m[first:end:2], max(to_s_m - from_s_m, 0.0), body.half_width_m)


def predicted_m(other: Other, until_s: float) -> NDArray[np.float64]:
    """(T, 2) positions from now on, ``STEP_S`` apart: constant speed, and a turn that ends after ``TURNING_S``."""
    time_s = np.arange(0.0, until_s + STEP_S / 2, STEP_S)
    turn_rad = other.yaw_rate_radps * np.minimum(time_s, TURNING_S)
    course_rad = math.atan2(other.velocity_y_mps, other.velocity_x_mps) + turn_rad
    middle_rad = 0.5 * (course_rad[1:] + course_rad[:-1])
    stride_m = other.speed_mps * STEP_S
    x_m = other.x_m + np.concatenate([[0.0], np.cumsum(stride_m * np.cos(middle_rad))])
    y_m = other.y_m + np.concatenate([[0.0], np.cumsum(stride_m * np.sin(middle_rad))])
    return np.column_stack([x_m, y_m])


def crossing(zone: Zone, ego: DrivenVehicle, others: Iterable[Other], within_s: float) -> frozenset[int]:
    """Ids of the moving vehicles that are on the zone, or will be before ``within_s`` are over."""
    return frozenset(
        other.id
        for other in others
        if other.kind is ActorKind.VEHICLE
        and other.speed_mps > STANDING_TRAFFIC_MPS
        and _may_reach(zone, other, within_s)
        and not _follows(ego, other)
        and _touches(zone, predicted_m(other, within_s), other)
    )


def waiting(zone: Zone, ego: DrivenVehicle, others: Iterable[Other]) -> frozenset[int]:
    """Ids of the vehicles that stand beside the zone and point at it."""
    return frozenset(
        other.id
        for other in others
        if other.kind is ActorKind.VEHICLE
        and other.speed_mps <= STANDING_TRAFFIC_MPS
        and not _follows(ego, other)
        and float(_away_m(zone, np.array([[other.x_m, other.y_m]])).min()) <= NEARBY_M + other.half_length_m
        and _touches(zone, _straight_on_m(other), other)
    )


def _may_reach(zone: Zone, other: Other, within_s: float) -> bool:
    """A cheap first look: whether it gets near the zone at all, whichever way it drives."""
    middle_m = zone.points_m[len(zone.points_m) // 2].tolist()
    reach_m = other.speed_mps * (within_s + STEP_S) + other.half_width_m + CLEARANCE_M
    reach_m += (
        zone.half_width_m + zone.length_m + 1.0
    )  # no point of the zone is farther from its middle than it is long
    return math.hypot(other.x_m - middle_m[0], other.y_m - middle_m[1]) < reach_m


def _straight_on_m(other: Other) -> NDArray[np.float64]:
    """(T, 2) the ground ahead of a standing vehicle, from its front bumper on."""
    along_m = np.arange(0.0, WAITING_REACH_M, 1.0) + other.half_length_m
    return np.column_stack(
        [other.x_m + along_m * math.cos(other.yaw_rad), other.y_m + along_m * math.sin(other.yaw_rad)]
    )


def _away_m(zone: Zone, points_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """(T,) how far each point lies from the zone's middle line."""
    gaps = points_m[:, None, :] - zone.points_m[None, :, :]  # (T, M, 2)
    return np.asarray(np.hypot(gaps[..., 0], gaps[..., 1]).min(axis=1))


def _touches(zone: Zone, points_m: NDArray[np.float64], other: Other) -> bool:
    """Whether a body that passes through the points comes too near to a vehicle on the zone."""
    return bool(_away_m(zone, points_m).min() < zone.half_width_m + other.half_width_m + CLEARANCE_M)


def _follows(ego: DrivenVehicle, other: Other) -> bool:
    """Whether the other comes behind on our own way, where it cannot cross before us."""
    bearing_rad = math.atan2(other.y_m - ego.y_m, other.x_m - ego.x_m)
    astern = abs(math.remainder(bearing_rad - ego.yaw_rad, math.tau)) > ASTERN_RAD
    return astern and abs(math.remainder(other.yaw_rad - ego.yaw_rad, math.tau)) < SAME_WAY_RAD
