"""From CARLA's left-handed frame into the right-handed one that Rerun draws: y changes its sign, so it points north.

Shown is x east, y north, z up. A rotation R becomes S R S with S = diag(1, -1, 1): what turns clockwise as seen from
above, as CARLA's yaw does, turns clockwise on the screen too.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

MIRROR = np.array([1.0, -1.0, 1.0])


class Pose(NamedTuple):
    """Somebody's place and attitude: CARLA's frame, m and rad."""

    x_m: float
    y_m: float
    z_m: float
    roll_rad: float
    pitch_rad: float
    yaw_rad: float


def shown(points_m: ArrayLike) -> NDArray[np.float64]:
    """Points (..., 3) of CARLA's frame, or of a vehicle's or sensor's own, as they are drawn."""
    mirrored: NDArray[np.float64] = np.asarray(points_m, dtype=np.float64) * MIRROR
    return mirrored


def turned(pose: Pose) -> NDArray[np.float64]:
    """(3, 3) the rotation from somebody's own frame into the world, as it is drawn.

    The matrix before it is mirrored: LibCarla, ``carla/geom/Transform.h``, ``GetMatrix``.
    """
    (sr, cr), (sp, cp), (sy, cy) = (
        (math.sin(angle), math.cos(angle)) for angle in (pose.roll_rad, pose.pitch_rad, pose.yaw_rad)
    )
    world_from_own = np.array(
        [
            [cp * cy, cy * sp * sr - sy * cr, -cy * sp * cr - sy * sr],
            [cp * sy, sy * sp * sr + cy * cr, -sy * sp * cr + cy * sr],
            [sp, -cp * sr, cp * cr],
        ]
    )
    mirrored: NDArray[np.float64] = world_from_own * np.outer(MIRROR, MIRROR)
    return mirrored


def about_the_vertical(yaw_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, 4) quaternions (x, y, z, w) of yaws, as they are drawn."""
    half = -np.asarray(yaw_rad, dtype=np.float64) / 2.0
    zero = np.zeros_like(half)
    return np.column_stack([zero, zero, np.sin(half), np.cos(half)])
