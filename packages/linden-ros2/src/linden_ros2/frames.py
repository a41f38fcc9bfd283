"""CARLA's left-handed frames as ROS's right-handed ones, and back; also optical frames and the camera matrix.

CARLA: x forward, y right, z up, yaw clockwise from above, pitch up, roll to the right. ROS (REP 103): x forward, y
left, z up, every turn counter-clockwise about its axis. A position, velocity, acceleration or force changes the sign of
y. An angular velocity is an axial vector, so a mirrored y changes the signs of x and z instead. Quaternions are
(x, y, z, w), as ROS orders them. The official ros-bridge keeps the sign of x in the angular velocity of its odometry
and turns it in that of its IMU; REP 103 decides here, for both.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from numpy.typing import NDArray

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

IDENTITY: Quaternion = (0.0, 0.0, 0.0, 1.0)
OPTICAL: Quaternion = (-0.5, 0.5, -0.5, 0.5)
"""Turns a body frame into an optical one: z forward, x right, y down (REP 103, suffix frames)."""


class Pose(NamedTuple):
    """A place and an attitude in a right-handed frame: m, unit quaternion."""

    position_m: Vector
    attitude: Quaternion


def vector(x: float, y: float, z: float) -> Vector:
    """Return a position, velocity, acceleration or force of CARLA's axes in ROS's; the same function leads back."""
    return (x, -y, z)


def axial(x: float, y: float, z: float) -> Vector:
    """Return an angular velocity of CARLA's axes in ROS's; the same function leads back. The unit stays."""
    return (-x, y, -z)


def attitude(roll_rad: float, pitch_rad: float, yaw_rad: float) -> Quaternion:
    """Return the quaternion of CARLA's angles: yaw, then pitch, then roll (Diebel 2006, equation 290, mirrored)."""
    roll, pitch, yaw = roll_rad / 2.0, -pitch_rad / 2.0, -yaw_rad / 2.0
    cos_r, sin_r, cos_p, sin_p = math.cos(roll), math.sin(roll), math.cos(pitch), math.sin(pitch)
    cos_y, sin_y = math.cos(yaw), math.sin(yaw)
    return (
        sin_r * cos_p * cos_y - cos_r * sin_p * sin_y,
        cos_r * sin_p * cos_y + sin_r * cos_p * sin_y,
        cos_r * cos_p * sin_y - sin_r * sin_p * cos_y,
        cos_r * cos_p * cos_y + sin_r * sin_p * sin_y,
    )


def angles(turn: Quaternion) -> Vector:
    """Return CARLA's roll, pitch and yaw in rad of a quaternion, which need not have length 1."""
    x, y, z, w = (value / math.hypot(*turn) for value in turn)
    roll = math.atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    pitch = math.asin(max(-1.0, min(1.0, 2.0 * (w * y - z * x))))
    yaw = math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return (roll, -pitch, -yaw)


def times(first: Quaternion, second: Quaternion) -> Quaternion:
    """Return the Hamilton product: the turn ``second``, seen in the frame that ``first`` turns."""
    ax, ay, az, aw = first
    bx, by, bz, bw = second
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def rotated(turn: Quaternion, arrow: Vector) -> Vector:
    """Return ``arrow`` of the turned frame in the frame outside of it."""
    conjugate = (-turn[0], -turn[1], -turn[2], turn[3])
    x, y, z, _ = times(times(turn, (*arrow, 0.0)), conjugate)
    return (x, y, z)


def in_body(turn: Quaternion, arrow: Vector) -> Vector:
    """Return ``arrow`` of the frame outside in the turned frame."""
    return rotated((-turn[0], -turn[1], -turn[2], turn[3]), arrow)


def moved_back(pose: Pose, distance_m: float) -> Pose:
    """Return the pose that lies ``distance_m`` behind ``pose`` along its own x axis."""
    back = rotated(pose.attitude, (-distance_m, 0.0, 0.0))
    x, y, z = (at + by for at, by in zip(pose.position_m, back, strict=True))
    return Pose((x, y, z), pose.attitude)


def points(measured: NDArray[Any]) -> NDArray[Any]:
    """Return a copy of (N, K) float32 points, or of (N,) structured ones with a field y, with y turned around.

    By multiplication: `numpy.negative` with a strided column as its own output returns wrong numbers in numpy 2.2.6.
    """
    turned = measured.copy()
    if turned.dtype.names is None:
        turned[:, 1] *= -1.0
    else:
        turned["y"] *= -1.0
    return turned


def focal_length_px(width_px: int, horizontal_fov_deg: float) -> float:
    """Return the focal length of a pinhole camera in pixels.

    Raises:
        ValueError: the field of view is not between 0 and 180 degrees.
    """
    if not 0.0 < horizontal_fov_deg < 180.0:
        raise ValueError(f"a field of view of {horizontal_fov_deg} degrees has no focal length")
    return width_px / (2.0 * math.tan(math.radians(horizontal_fov_deg) / 2.0))
