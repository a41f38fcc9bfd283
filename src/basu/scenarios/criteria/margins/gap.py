"""The distance between two boxes seen from above, exactly, for many pairs at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from basu.metrics.passengers.boxes import touching

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.metrics.passengers.boxes import Boxes

CORNERS = np.array([(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)])


def gap_m(a: Boxes, b: Boxes) -> NDArray[np.float64]:
    """(N,) from each box to its partner, 0 where they touch.

    Two convex shapes apart are nearest at a corner of one of them, so the corners of each against the other box are all
    there is to look at: 16 clamped differences a pair.
    """
    apart_m = np.minimum(_corners_to(a, b), _corners_to(b, a))
    return np.where(touching(a, b), 0.0, apart_m)


def _corners_to(a: Boxes, b: Boxes) -> NDArray[np.float64]:
    """(N,) the least distance from the corners of each ``a`` to its ``b``."""
    corners = a[:, None, :2] + _turned(CORNERS[None] * a[:, None, 3:], a[:, 2])  # (N, 4, 2)
    within = _turned(corners - b[:, None, :2], -b[:, 2])
    beyond = np.maximum(np.abs(within) - b[:, None, 3:], 0.0)
    least: NDArray[np.float64] = np.hypot(beyond[..., 0], beyond[..., 1]).min(axis=1)
    return least


def _turned(points: NDArray[np.float64], yaw_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, 4, 2) points turned by an angle each."""
    cos, sin = np.cos(yaw_rad)[:, None], np.sin(yaw_rad)[:, None]
    x, y = points[..., 0], points[..., 1]
    return np.stack([x * cos - y * sin, x * sin + y * cos], axis=-1)
