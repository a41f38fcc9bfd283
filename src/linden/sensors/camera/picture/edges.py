"""Where a picture has edges: pixels that need more than one ray, and the rays they get."""

import numpy as np
from numpy.typing import NDArray

from linden.casting.crew import in_stretches
from linden.casting.rays import NOTHING, Hits
from linden.compiled import unlocked
from linden.sensors.camera.rays import TILE_PX, distorted, pixels, tile_counts, towards
from linden.sensors.camera.spec import CameraSpec

F32 = NDArray[np.float32]
I32 = NDArray[np.int32]

SAMPLES = 4
_PLACES = ((0.125, 0.375), (0.375, 0.875), (0.625, 0.125), (0.875, 0.625))
"""Of the rays in a pixel: a rotated grid, no two in one row or column."""

_CONTRAST = 0.14
_STEP = 0.06
"""Differences that are an edge: of the light, and of the distances."""


def edge_rays(spec: CameraSpec, hits: Hits, light: F32) -> NDArray[np.intp]:
    """Return the rays whose pixels differ from one of their four neighbours, in order."""
    across, down = tile_counts(spec)
    edge = np.empty(len(light), np.bool_)
    flat = light.sum(axis=1, dtype=np.float32)

    def work(start: int, stop: int) -> None:
        _mark(hits.instance, hits.distance_m, hits.normal, flat, across, down, edge, start, stop)

    in_stretches(len(edge), work, multiple=TILE_PX**2)
    return np.flatnonzero(edge)


def finer(spec: CameraSpec, rows: NDArray[np.intp]) -> F32:
    """Return unit vectors (SAMPLES M, 3), in the camera's frame, of the rays that the pixels of ``rows`` (M,) get."""
    across_px, down_px = (values[rows] for values in pixels(spec))
    places = np.array(_PLACES)
    right = (across_px[:, None] + places[:, 0] - spec.width_px / 2.0).ravel() / spec.focal_px
    below = (down_px[:, None] + places[:, 1] - spec.height_px / 2.0).ravel() / spec.focal_px
    return towards(*distorted(spec, right, below))


@unlocked
def _mark(
    instance: I32, distance_m: F32, normal: F32, light: F32, across: int, down: int, edge: NDArray[np.bool_],
    start: int, stop: int,
) -> None:  # fmt: skip
    width, height = across * TILE_PX, down * TILE_PX
    for ray in range(start, stop):
        tile, within = ray // (TILE_PX * TILE_PX), ray % (TILE_PX * TILE_PX)
        y = tile // across * TILE_PX + within // TILE_PX
        x = tile % across * TILE_PX + within % TILE_PX
        found = False
        for side in range(4):
            row, column = y + (side == 0) - (side == 1), x + (side == 2) - (side == 3)
            if row < 0 or column < 0 or row >= height or column >= width:
                continue
            other = (row // TILE_PX * across + column // TILE_PX) * TILE_PX * TILE_PX
            other += row % TILE_PX * TILE_PX + column % TILE_PX
            if instance[ray] != instance[other]:
                found = True
                break
            if abs(light[ray] - light[other]) > _CONTRAST * (light[ray] + light[other] + 0.1):
                found = True
                break
            if instance[ray] != NOTHING and (
                abs(distance_m[ray] - distance_m[other]) > _STEP * min(distance_m[ray], distance_m[other])
                and normal[ray, 0] * normal[other, 0]
                + normal[ray, 1] * normal[other, 1]
                + normal[ray, 2] * normal[other, 2]
                < 0.99
            ):
                found = True
                break
        edge[ray] = found
