"""Pictures through any lens, sampled from square pinhole pictures: the faces of a cube around the camera."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from carla_driver_interface.geometry import Pose
from scipy.spatial.transform import Rotation

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

FOV_DEG = 90.0
MARGIN_PX = 1
"""Pixels beyond the cube's edge, so that sampling between pixels never leaves a face."""
SMALLEST_PX, LARGEST_PX = 64, 2048
TURNS = {
    "front": (0.0, 0.0), "right": (90.0, 0.0), "left": (-90.0, 0.0), "back": (180.0, 0.0), "up": (0.0, 90.0),
    "down": (0.0, -90.0),
}  # fmt: skip
"""The turn of each face's optical frame against the camera's, in degrees: about y (down), then about its own x."""


class Faces(NamedTuple):
    """The faces that a lens looks through, and where each pixel finds its colour."""

    size_px: int
    fov_deg: float
    pixels: Mapping[str, tuple[NDArray[np.bool_], NDArray[np.float64], NDArray[np.float64]]]
    """By face: which pixels look through it, and where in its picture, x and y in its pixels."""

    def pose(self, camera: Pose, face: str) -> Pose:
        """Return the optical frame of a face for the optical frame of the camera."""
        return camera @ Pose.from_rotation([0.0, 0.0, 0.0], turn_of(face))

    def picture(self, seen: Mapping[str, NDArray[np.uint8]]) -> NDArray[np.uint8]:
        """Return the (H, W, 3) picture, sampled bilinearly from (N, N, 3) pictures of faces; black beyond the lens."""
        shape = next(iter(self.pixels.values()))[0].shape
        picture = np.zeros((*shape, 3), np.uint8)
        for face, (mask, x_px, y_px) in self.pixels.items():
            picture[mask] = _sampled(seen[face], x_px, y_px)
        return picture


def turn_of(face: str) -> Rotation:
    """Return the rotation from a face's optical frame to the camera's."""
    about_y, about_x = TURNS[face]
    return Rotation.from_euler("YX", [about_y, about_x], degrees=True)


def faces_of(directions: NDArray[np.float64]) -> Faces:
    """Return the faces for (H, W, 3) unit vectors of pixels, NaN where a lens shows nothing.

    A face has as many pixels for an angle as the lens has in its middle.
    """
    names = list(TURNS)
    axes = np.array([turn_of(name).apply([0.0, 0.0, 1.0]) for name in names])
    nearest = np.argmax(np.nan_to_num(directions) @ axes.T, axis=-1)
    is_seen = np.isfinite(directions).all(axis=-1)
    size_px = _size_px(directions)
    focal_px = size_px / 2.0  # of the cube itself; the picture is wider by the margin
    whole_px = size_px + 2 * MARGIN_PX
    pixels = {}
    for number, name in enumerate(names):
        mask = is_seen & (nearest == number)
        if mask.any():
            x, y, z = turn_of(name).inv().apply(directions[mask]).T
            pixels[name] = (mask, whole_px / 2.0 + focal_px * x / z, whole_px / 2.0 + focal_px * y / z)
    return Faces(whole_px, math.degrees(2.0 * math.atan(whole_px / (2.0 * focal_px))), pixels)


def _size_px(directions: NDArray[np.float64]) -> int:
    """Return the pixels along an edge of the cube."""
    rows, columns = directions.shape[0] // 2, directions.shape[1] // 2
    middle = directions[rows : rows + 1, max(0, columns - 1) : columns + 1]
    step_rad = float(np.linalg.norm(middle[0, -1] - middle[0, 0]))
    wanted = 2.0 / step_rad if step_rad > 0.0 else SMALLEST_PX
    return min(LARGEST_PX, max(SMALLEST_PX, math.ceil(wanted))) if math.isfinite(wanted) else SMALLEST_PX


def _sampled(seen: NDArray[np.uint8], x_px: NDArray[np.float64], y_px: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return the colours between the four nearest pixels."""
    x, y = x_px - 0.5, y_px - 0.5
    left, top = np.floor(x).astype(int), np.floor(y).astype(int)
    last = len(seen) - 2
    left, top = np.clip(left, 0, last), np.clip(top, 0, last)
    across, down = (x - left)[:, None], (y - top)[:, None]
    upper = seen[top, left] * (1.0 - across) + seen[top, left + 1] * across
    lower = seen[top + 1, left] * (1.0 - across) + seen[top + 1, left + 1] * across
    colours: NDArray[np.uint8] = np.rint(upper * (1.0 - down) + lower * down).clip(0, 255).astype(np.uint8)
    return colours
