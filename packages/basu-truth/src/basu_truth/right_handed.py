"""CARLA's left-handed frames as the right-handed ones of data sets: y to the left, angles anticlockwise from above."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial.transform import Rotation

from basu_truth.geometry import matrix

if TYPE_CHECKING:
    from basu_truth.geometry import F64
    from basu_truth.truth import Pose

MIRROR = np.diag([1.0, -1.0, 1.0, 1.0])
FROM_CAMERA = np.array([[0.0, 0.0, 1.0, 0.0], [-1.0, 0.0, 0.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
"""From a picture's axes (x right, y down, z forward) to x forward, y left, z up."""


def right_handed(pose: Pose) -> F64:
    """Return the matrix (4, 4) of a pose between right-handed frames: x forward, y left, z up."""
    turned: F64 = MIRROR @ matrix(pose) @ MIRROR
    return turned


def translation(transform: F64) -> list[float]:
    """Return the place of a matrix (4, 4), m, to the tenth of a millimetre."""
    return [round(value, 4) for value in transform[:3, 3].tolist()]


def quaternion(transform: F64) -> list[float]:
    """Return the attitude of a matrix (4, 4) as w, x, y, z, with w not below 0."""
    x, y, z, w = Rotation.from_matrix(transform[:3, :3]).as_quat().tolist()
    sign = -1.0 if w < 0.0 else 1.0
    return [round(sign * value, 8) for value in (w, x, y, z)]


def yaw_deg_of(rotation: list[float]) -> float:
    """Return CARLA's yaw, clockwise from above in degrees, of a quaternion w, x, y, z of a right-handed frame."""
    w, x, y, z = rotation
    forward = Rotation.from_quat([x, y, z, w]).apply([1.0, 0.0, 0.0])
    return -math.degrees(math.atan2(forward[1], forward[0]))
