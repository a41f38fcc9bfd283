"""Frames and rotations. The one place where CARLA's left-handed frame and OpenDRIVE's right-handed one meet.

CARLA: x east, y south, z up, yaw clockwise from above. OpenDRIVE: x east, y north, z up, heading counter-clockwise.
"""

import math

import numpy as np
from numpy.typing import NDArray

from linden.protocol.values.space import Rotation, Transform, Vector3D

Matrix = NDArray[np.float64]


def rotation_matrix(rotation: Rotation) -> Matrix:
    """Return the (3, 3) matrix with the turned x, y, z axes as columns. Source: GetMatrix of ``carla/geom``."""
    pitch, yaw, roll = (math.radians(angle) for angle in rotation)
    sp, cp, sy, cy, sr, cr = (
        math.sin(pitch),
        math.cos(pitch),
        math.sin(yaw),
        math.cos(yaw),
        math.sin(roll),
        math.cos(roll),
    )
    return np.array(
        [
            [cp * cy, cy * sp * sr - sy * cr, -cy * sp * cr - sy * sr],
            [cp * sy, sy * sp * sr + cy * cr, -sy * sp * cr + cy * sr],
            [sp, -cp * sr, cp * cr],
        ]
    )


def rotation_of(matrix: Matrix) -> Rotation:
    """Return the rotation of a (3, 3) matrix of :func:`rotation_matrix`; yaw 0 where the nose points straight up."""
    pitch = math.asin(max(-1.0, min(1.0, float(matrix[2, 0]))))
    if abs(matrix[2, 0]) > 1.0 - 1e-12:
        roll = math.atan2(math.copysign(1.0, matrix[2, 0]) * matrix[0, 1], matrix[1, 1])
        return Rotation(math.degrees(pitch), 0.0, math.degrees(roll))
    yaw = math.atan2(matrix[1, 0], matrix[0, 0])
    roll = math.atan2(-matrix[2, 1], matrix[2, 2])
    return Rotation(math.degrees(pitch), math.degrees(yaw), math.degrees(roll))


def compose(world_from_parent: Transform, parent_from_child: Transform) -> Transform:
    """Return ``world_from_child``."""
    turn = rotation_matrix(world_from_parent.rotation)
    location = np.asarray(world_from_parent.location) + turn @ np.asarray(parent_from_child.location)
    rotation = rotation_of(turn @ rotation_matrix(parent_from_child.rotation))
    return Transform(Vector3D(*map(float, location)), rotation)


def relative(world_from_parent: Transform, world_from_child: Transform) -> Transform:
    """Return ``parent_from_child``: what :func:`compose` makes the child of."""
    back = rotation_matrix(world_from_parent.rotation).T
    apart = np.asarray(world_from_child.location) - np.asarray(world_from_parent.location)
    rotation = rotation_of(back @ rotation_matrix(world_from_child.rotation))
    return Transform(Vector3D(*map(float, back @ apart)), rotation)


def from_opendrive(x_m: float, y_m: float, z_m: float, heading_rad: float) -> Transform:
    """Return the pose in CARLA's frame of a point and heading in OpenDRIVE's."""
    return Transform(Vector3D(x_m, -y_m, z_m), Rotation(0.0, -math.degrees(heading_rad), 0.0))


def points_from_opendrive(points_m: Matrix) -> Matrix:
    """Return points (N, 3) of OpenDRIVE's frame in CARLA's."""
    mirrored: Matrix = points_m * np.array([1.0, -1.0, 1.0])
    return mirrored
