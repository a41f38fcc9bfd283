"""The rays of a camera's pixels: which direction each pixel looks, in the order in which casters are fastest.

Rays go in tiles of 4 x 4 pixels, for a packet of 16 that lie together meets the same triangles; tiles go row by row. At
the right and lower edge tiles may reach over the picture; what their rays meet there is never shown.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from linden.compiled import unlocked
from linden.geometry import rotation_matrix
from linden.protocol.values.space import Transform
from linden.sensors.camera.spec import CameraSpec, Lens
from linden.sensors.casting.caster import Rays
from linden.sensors.casting.thread_pool import in_stretches

F32 = NDArray[np.float32]

TILE_PX = 4
TILE = TILE_PX**2
"""Rays."""


@lru_cache(maxsize=32)
def directions(spec: CameraSpec) -> F32:
    """Return unit vectors (N, 3) through the middle of each pixel, tile by tile: x forward, y right, z up."""
    across_px, down_px = pixels(spec)
    right = (across_px + 0.5 - spec.width_px / 2.0) / spec.focal_px
    below = (down_px + 0.5 - spec.height_px / 2.0) / spec.focal_px
    right, below = distorted(spec, right, below)
    return towards(right, below)


def towards(right: NDArray[np.float64], below: NDArray[np.float64]) -> F32:
    """Return unit vectors (N, 3) to places on the plane one metre ahead."""
    vectors = np.column_stack([np.ones_like(right), right, -below])
    return np.ascontiguousarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True), np.float32)


def pixels(spec: CameraSpec) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return column and row (N,) of the pixel of each ray."""
    tiles_across, tiles_down = tile_counts(spec)
    down, across, row, column = np.meshgrid(
        np.arange(tiles_down), np.arange(tiles_across), np.arange(TILE_PX), np.arange(TILE_PX), indexing="ij"
    )
    return (across * TILE_PX + column).ravel().astype(np.float64), (down * TILE_PX + row).ravel().astype(np.float64)


def tile_counts(spec: CameraSpec) -> tuple[int, int]:
    """Return how many tiles a picture has across and down."""
    return -(-spec.width_px // TILE_PX), -(-spec.height_px // TILE_PX)


def distorted(
    spec: CameraSpec, right: NDArray[np.float64], below: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return where on the plane one metre ahead a lens lets pixels look that would see ``right`` and ``below``.

    CARLA's lens is a material of Unreal's, of which the names of the parameters are public and the formula is not. Here
    it is the cubic lens of those names (SSontech, "Lens distortion, cubic", f = 1 + r² (k + kcube r)), its radius in
    units of the picture's size over the lens's, faded in from the middle by the circle: min(1, multiplier r^falloff).
    """
    lens: Lens = spec.lens
    if lens.circle_multiplier == 0.0:
        return right, below
    half_right = spec.width_px / 2.0 / spec.focal_px
    half_below = spec.height_px / 2.0 / spec.focal_px
    x, y = right / half_right, below / half_below  # -1 to 1 over the picture
    radius = np.hypot(x, y)
    r2 = lens.x_size * x * x + lens.y_size * y * y
    weight = np.minimum(1.0, lens.circle_multiplier * radius**lens.circle_falloff)
    stretch = 1.0 + weight * r2 * (lens.k + lens.kcube * np.sqrt(r2))
    return right * stretch, below * stretch


@lru_cache(maxsize=32)
def pixel_of_ray(spec: CameraSpec) -> NDArray[np.int32]:
    """Return (N,) which pixel, counted row by row, each ray is; -1 beyond the picture's edge."""
    across_px, down_px = pixels(spec)
    shown = (across_px < spec.width_px) & (down_px < spec.height_px)
    return np.where(shown, down_px * spec.width_px + across_px, -1).astype(np.int32)


def aim(vectors: F32, pose: Transform) -> Rays:
    """Return the rays in the world of directions (N, 3) in the frame of a sensor at ``pose``."""
    origin, direction = np.empty_like(vectors), np.empty_like(vectors)
    turn, place = rotation_matrix(pose.rotation).astype(np.float32), np.array(pose.location, np.float32)

    def work(start: int, stop: int) -> None:
        aim_loop(vectors, turn, place, origin, direction, start, stop)

    in_stretches(len(vectors), work, multiple=TILE_PX**2)
    return Rays(origin, direction)


@unlocked
def aim_loop(vectors: F32, turn: F32, place: F32, origin: F32, direction: F32, start: int, stop: int) -> None:
    """Write rays ``start`` to ``stop`` in the world."""
    for i in range(start, stop):
        x, y, z = vectors[i, 0], vectors[i, 1], vectors[i, 2]
        origin[i, 0], origin[i, 1], origin[i, 2] = place[0], place[1], place[2]
        direction[i, 0] = turn[0, 0] * x + turn[0, 1] * y + turn[0, 2] * z
        direction[i, 1] = turn[1, 0] * x + turn[1, 1] * y + turn[1, 2] * z
        direction[i, 2] = turn[2, 0] * x + turn[2, 1] * y + turn[2, 2] * z
