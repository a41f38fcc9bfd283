"""The axes of a body in the world, inside kernels: the matrix of ``linden.geometry``, in radians, without arrays."""

import math

from linden.compiled import part


@part
def forward(pitch_rad: float, yaw_rad: float) -> tuple[float, float, float]:
    """Return the nose's direction in CARLA's frame (first column of ``geometry.rotation_matrix``)."""
    return math.cos(pitch_rad) * math.cos(yaw_rad), math.cos(pitch_rad) * math.sin(yaw_rad), math.sin(pitch_rad)


@part
def rightward(pitch_rad: float, yaw_rad: float, roll_rad: float) -> tuple[float, float, float]:
    """Return the direction to the right (second column)."""
    tilt = math.sin(pitch_rad) * math.sin(roll_rad)
    x = math.cos(yaw_rad) * tilt - math.sin(yaw_rad) * math.cos(roll_rad)
    y = math.sin(yaw_rad) * tilt + math.cos(yaw_rad) * math.cos(roll_rad)
    return x, y, -math.cos(pitch_rad) * math.sin(roll_rad)


@part
def within_turn(angle_rad: float) -> float:
    """Return the angle as one in [-pi, pi)."""
    if -math.pi <= angle_rad < math.pi:
        return angle_rad
    return angle_rad - 2.0 * math.pi * math.floor((angle_rad + math.pi) / (2.0 * math.pi))
