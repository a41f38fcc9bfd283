"""Data types of the driving agents: `VehicleGeometry`, `DrivenVehicle`, `Other` actors, and speed `Restriction`.

World frame throughout: CARLA's (metres, x east, y south, angles in rad clockwise from above).
"""

from __future__ import annotations

import enum
from typing import NamedTuple

from basu.agents.sight.actors import ActorKind, Other

__all__ = ["ActorKind", "DrivenVehicle", "Other", "Restriction", "Urgency", "VehicleGeometry"]


class VehicleGeometry(NamedTuple):
    """What does not change about the driven vehicle; lengths in its own frame, from the actor's origin."""

    wheelbase_m: float
    rear_axle_m: float  # how far the rear axle lies behind the origin
    front_m: float  # from the origin to the front bumper
    rear_m: float  # from the origin to the rear bumper
    half_width_m: float


class DrivenVehicle(NamedTuple):
    """The driven vehicle now."""

    time_s: float
    x_m: float
    y_m: float
    yaw_rad: float
    speed_mps: float  # along its own axis, negative when rolling backwards
    gear: int = 1  # 0 while the gearbox shifts, and before the first throttle
    parked: bool = False  # whether the parking brake holds it, as while doors are open


class Urgency(enum.IntEnum):
    """How hard a restriction may be met when it cannot be met in comfort."""

    GENTLE = 0  # a speed to slow down to, a service stop: late is better than rough
    FIRM = 1  # a stop line: firm braking, no more
    VITAL = 2  # a person's life: all that the tyres give
    RESERVE = 3  # likewise, where comfort is looked after already: hard braking as soon as nothing less will do


class Restriction(NamedTuple):
    """Be no faster than ``speed_mps`` once ``distance_m`` more is driven (negative: it should have been already)."""

    distance_m: float
    speed_mps: float
    urgency: Urgency
    reason: str
    last_resort_m: float = 0.0  # a vital one: how much farther there still is before contact
