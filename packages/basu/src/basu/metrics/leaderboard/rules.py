"""The infraction `penalty` by the CARLA leaderboard's versions 1.0, 2.0 and 2.1: events with factors or points.

Sources: ``leaderboard/utils/statistics_manager.py`` of carla-simulator/leaderboard, branches leaderboard-1.0, -2.0 and
-2.1. Versions 1.0 and 2.0 multiply a factor for each event. Version 2.1 adds up points and takes 1 / (1 + points), so
the tenth infraction still counts. The share of the way outside the lanes is multiplied on in all of them: that way
shall not count as driven.
"""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping


class Version(enum.Enum):
    """Versions of the leaderboard that score differently."""

    V1_0 = "1.0"
    V2_0 = "2.0"
    V2_1 = "2.1"


class Kind(enum.Enum):
    """The leaderboard's names for what happens, as its result files have them."""

    COLLISION_PEDESTRIAN = "collisions_pedestrian"
    COLLISION_VEHICLE = "collisions_vehicle"
    COLLISION_STATIC = "collisions_layout"
    RED_LIGHT = "red_light"
    STOP = "stop_infraction"
    OUTSIDE_LANES = "outside_route_lanes"
    MIN_SPEED = "min_speed_infractions"
    YIELD_EMERGENCY = "yield_emergency_vehicle_infractions"
    SCENARIO_TIMEOUT = "scenario_timeouts"
    ROUTE_DEVIATION = "route_dev"
    ROUTE_TIMEOUT = "route_timeout"
    BLOCKED = "vehicle_blocked"


@dataclass(frozen=True, slots=True, kw_only=True)
class LeaderboardEvent:
    """One thing that the leaderboard would have written down."""

    kind: Kind
    tick: int
    percentage: float | None = None  # outside the lanes: of the way driven; too slow: own of the traffic's mean speed


FACTORS: Mapping[Kind, float] = {
    Kind.COLLISION_PEDESTRIAN: 0.5,
    Kind.COLLISION_VEHICLE: 0.6,
    Kind.COLLISION_STATIC: 0.65,
    Kind.RED_LIGHT: 0.7,
    Kind.STOP: 0.8,
    Kind.SCENARIO_TIMEOUT: 0.7,
    Kind.YIELD_EMERGENCY: 0.7,
}
MIN_SPEED_FACTOR = 0.7  # of 2.0, for a vehicle that does not move at all
POINTS: Mapping[Kind, float] = {
    Kind.COLLISION_PEDESTRIAN: 1.0,
    Kind.COLLISION_VEHICLE: 0.7,
    Kind.COLLISION_STATIC: 0.6,
    Kind.RED_LIGHT: 0.4,
    Kind.STOP: 0.25,
    Kind.SCENARIO_TIMEOUT: 0.4,
    Kind.YIELD_EMERGENCY: 0.4,
    Kind.MIN_SPEED: 0.4,
}


def penalty(version: Version, events: Iterable[LeaderboardEvent]) -> float:
    """The infraction penalty, 1 for a drive without events; events that end a drive cost nothing here."""
    events = tuple(events)
    outside = math.prod(1.0 - (e.percentage or 0.0) / 100.0 for e in events if e.kind is Kind.OUTSIDE_LANES)
    if version is Version.V2_1:
        points = sum(POINTS[e.kind] * _slow_share(e) for e in events if e.kind in POINTS)
        return outside / (1.0 + points)
    factors = math.prod(FACTORS[e.kind] for e in events if e.kind in FACTORS)
    if version is Version.V1_0:
        return outside * factors
    slow = math.prod(1.0 - (1.0 - MIN_SPEED_FACTOR) * _slow_share(e) for e in events if e.kind is Kind.MIN_SPEED)
    return outside * factors * slow


def _slow_share(event: LeaderboardEvent) -> float:
    """How much of its penalty an event takes: all, but for being slow, where it is what is missing to 100 %."""
    return 1.0 if event.kind is not Kind.MIN_SPEED else 1.0 - (event.percentage or 0.0) / 100.0
