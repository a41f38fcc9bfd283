"""Walls beside roads, piece by piece."""

import numpy as np
from numpy.typing import NDArray

from linden.scene.objects import Kind, Scene, assembled, boxes_on, things_with
from linden.values.enums import SemanticTag

F64 = NDArray[np.float64]

HALF_THICKNESS_M = 0.02
"""CARLA's walls are sheets without thickness; a box needs some."""


def walls(feet_m: F64, height_m: float) -> Scene:
    """Return walls of a height over pieces (N, 2, 3) of their feet, from and to."""
    middle, ahead = feet_m.mean(axis=1), feet_m[:, 1] - feet_m[:, 0]
    middle[:, 2] = feet_m[:, :, 2].min(axis=1)
    things = things_with(Kind.WALL, middle, np.arctan2(ahead[:, 1], ahead[:, 0]))
    half = 0.5 * np.column_stack(
        [np.hypot(ahead[:, 0], ahead[:, 1]), np.zeros(len(ahead)), abs(ahead[:, 2]) + height_m]
    )
    half[:, 1] = HALF_THICKNESS_M
    return assembled(things, boxes_on(things, half * (0.0, 0.0, 1.0), half, SemanticTag.WALLS))
