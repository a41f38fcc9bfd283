"""A vehicle's motion in one frame, and how it is read out of a world snapshot."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import carla


class VehicleMotion(NamedTuple):
    """A vehicle's motion in the world: CARLA's axes, m, rad, s."""

    x_m: float
    y_m: float
    z_m: float
    roll_rad: float
    pitch_rad: float
    yaw_rad: float
    velocity_x_mps: float
    velocity_y_mps: float
    velocity_z_mps: float
    acceleration_x_mps2: float
    acceleration_y_mps2: float
    acceleration_z_mps2: float
    angular_velocity_x_radps: float
    angular_velocity_y_radps: float
    angular_velocity_z_radps: float


def motion_of(snapshot: carla.ActorSnapshot) -> VehicleMotion:
    """Return the motion of a vehicle from its part of a world snapshot."""
    transform = snapshot.get_transform()
    at, turned = transform.location, transform.rotation
    velocity, acceleration, spin = snapshot.get_velocity(), snapshot.get_acceleration(), snapshot.get_angular_velocity()
    radians = math.radians
    return VehicleMotion(
        at.x,
        at.y,
        at.z,
        radians(turned.roll),
        radians(turned.pitch),
        radians(turned.yaw),
        velocity.x,
        velocity.y,
        velocity.z,
        acceleration.x,
        acceleration.y,
        acceleration.z,
        radians(spin.x),
        radians(spin.y),
        radians(spin.z),
    )
