"""The axes of a body in the world, inside kernels: the matrix of ``linden.geometry``, in radians, without arrays."""

import math

from linden.compiled import kernel

Axis = tuple[float, float, float]


@kernel
def plane_axes(pitch_rad: float, yaw_rad: float, roll_rad: float) -> tuple[Axis, Axis]:
    """Return the directions forward and to the right: the first two columns of ``geometry.rotation_matrix``."""
    sp, cp = math.sin(pitch_rad), math.cos(pitch_rad)
    sy, cy = math.sin(yaw_rad), math.cos(yaw_rad)
    sr, cr = math.sin(roll_rad), math.cos(roll_rad)
    return turned_axes(sp, cp, sy, cy, sr, cr)


@kernel
def turned_axes(sp: float, cp: float, sy: float, cy: float, sr: float, cr: float) -> tuple[Axis, Axis]:
    """Return :func:`plane_axes` of the sines and cosines of pitch, yaw and roll."""
    return (cp * cy, cp * sy, sp), (cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, -cp * sr)


@kernel
def body_axes(pitch_rad: float, yaw_rad: float, roll_rad: float) -> tuple[Axis, Axis, Axis]:
    """Return the directions forward, to the right and up: the columns of ``geometry.rotation_matrix``."""
    nose, side = plane_axes(pitch_rad, yaw_rad, roll_rad)
    sp, cp = math.sin(pitch_rad), math.cos(pitch_rad)
    sy, cy = math.sin(yaw_rad), math.cos(yaw_rad)
    sr, cr = math.sin(roll_rad), math.cos(roll_rad)
    return nose, side, (-cy * sp * cr - sy * sr, -sy * sp * cr + cy * sr, cp * cr)


@kernel
def within_turn(angle_rad: float) -> float:
    """Return the angle as one in [-pi, pi)."""
    if -math.pi <= angle_rad < math.pi:
        return angle_rad
    return angle_rad - 2.0 * math.pi * math.floor((angle_rad + math.pi) / (2.0 * math.pi))
