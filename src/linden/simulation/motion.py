"""Where every actor is and how it moves, as the 15 numbers that each row of the snapshot carries."""

import math

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kernel

F64 = NDArray[np.float64]
F32 = NDArray[np.float32]
I32 = NDArray[np.int32]

MOTION_OFFSET = 5
"""Byte at which location, rotation, velocity, angular velocity and acceleration begin in a row; see values.snapshot."""


@kernel
def _axes(pitch_deg: float, yaw_deg: float, roll_deg: float) -> F64:  # pragma: no cover - compiled
    """Return the (3, 3) matrix of ``linden.geometry.rotation_matrix``."""
    sp, cp = math.sin(math.radians(pitch_deg)), math.cos(math.radians(pitch_deg))
    sy, cy = math.sin(math.radians(yaw_deg)), math.cos(math.radians(yaw_deg))
    sr, cr = math.sin(math.radians(roll_deg)), math.cos(math.radians(roll_deg))
    axes = np.empty((3, 3))
    axes[0, 0], axes[0, 1], axes[0, 2] = cp * cy, cy * sp * sr - sy * cr, -cy * sp * cr - sy * sr
    axes[1, 0], axes[1, 1], axes[1, 2] = cp * sy, sy * sp * sr + cy * cr, -sy * sp * cr + cy * sr
    axes[2, 0], axes[2, 1], axes[2, 2] = sp, -cp * sr, cp * cr
    return axes


@kernel
def _follow(parent: F64, relative: F64, pose: F64) -> None:  # pragma: no cover - compiled
    """Write into ``pose`` (6,) where a child with ``relative`` (6,) to its ``parent`` (6,) is; m and degrees."""
    outer = _axes(parent[3], parent[4], parent[5])
    inner = _axes(relative[3], relative[4], relative[5])
    turn = np.zeros((3, 3))
    for i in range(3):
        for j in range(3):
            for k in range(3):
                turn[i, j] += outer[i, k] * inner[k, j]
    for axis in range(3):
        pose[axis] = (
            parent[axis] + outer[axis, 0] * relative[0] + outer[axis, 1] * relative[1] + outer[axis, 2] * relative[2]
        )
    sine = min(1.0, max(-1.0, turn[2, 0]))
    pose[3] = math.degrees(math.asin(sine))
    if abs(sine) > 1.0 - 1e-12:  # straight up or down: yaw and roll turn about one axis, so all of it is roll
        pose[4] = 0.0
        pose[5] = math.degrees(math.atan2(math.copysign(1.0, sine) * turn[0, 1], turn[1, 1]))
    else:
        pose[4] = math.degrees(math.atan2(turn[1, 0], turn[0, 0]))
        pose[5] = math.degrees(math.atan2(-turn[2, 1], turn[2, 2]))


@kernel
def gather_motion(
    count: int,
    pose: F64,
    relative: F64,
    parent_row: I32,
    slot: I32,
    position: F64,
    rotation: F64,
    velocity: F64,
    angular_velocity: F64,
    acceleration: F64,
    motion: F32,
) -> None:  # pragma: no cover - compiled
    """Bring ``pose`` up to date for the first ``count`` actors and write ``motion`` (N, 15) for the snapshot.

    ``pose``, ``relative``: (N, 6) m and degrees. The rest are columns of the bodies, (M, 3), SI with radians, read
    where ``slot`` is not negative. Parents stand further up than their children, so one pass is enough.
    """
    for row in range(count):
        body = slot[row]
        motion[row, 6:15] = 0.0
        if body >= 0:
            for axis in range(3):
                pose[row, axis] = position[body, axis]
                degrees = math.degrees(rotation[body, axis])
                pose[row, 3 + axis] = degrees - 360.0 * math.floor((degrees + 180.0) / 360.0)
                motion[row, 6 + axis] = velocity[body, axis]
                motion[row, 9 + axis] = math.degrees(angular_velocity[body, axis])
                motion[row, 12 + axis] = acceleration[body, axis]
        elif parent_row[row] >= 0:
            _follow(pose[parent_row[row]], relative[row], pose[row])
        for axis in range(6):
            motion[row, axis] = pose[row, axis]
