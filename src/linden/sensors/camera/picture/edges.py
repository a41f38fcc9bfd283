"""Where a picture has edges: pixels that need more than one ray, and the rays they get."""

import math

import numpy as np
from numpy.typing import NDArray

from linden.casting.crew import in_stretches
from linden.casting.rays import NOTHING, Hits, Rays
from linden.compiled import unlocked
from linden.geometry import rotation_matrix
from linden.sensors.camera.rays import TILE_PX, directions, tile_counts
from linden.sensors.camera.spec import CameraSpec
from linden.values.space import Transform

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

    def work(start: int, stop: int) -> None:
        mark_loop(hits.instance, hits.distance_m, hits.normal, light, across, down, edge, start, stop)

    in_stretches(len(edge), work, multiple=TILE_PX**2)
    return np.flatnonzero(edge)


def finer(spec: CameraSpec, rows: NDArray[np.intp], pose: Transform) -> Rays:
    """Return the rays (SAMPLES M) in the world that the pixels of ``rows`` (M,) get."""
    origin, direction = (np.empty((SAMPLES * len(rows), 3), np.float32) for _ in range(2))
    turn, place = rotation_matrix(pose.rotation).astype(np.float32), np.array(pose.location, np.float32)
    vectors, aside = directions(spec), offsets(spec)

    def work(start: int, stop: int) -> None:
        split_loop(vectors, rows, aside, turn, place, origin, direction, start, stop)

    in_stretches(len(rows), work, multiple=TILE_PX)
    return Rays(origin, direction)


def offsets(spec: CameraSpec) -> F32:
    """Return how far (SAMPLES, 2) to the right and down the rays of a pixel go past its middle, one metre ahead."""
    return ((np.array(_PLACES) - 0.5) / spec.focal_px).astype(np.float32)


@unlocked
def split_loop(
    vectors: F32, rows: NDArray[np.intp], offsets: F32, turn: F32, place: F32, origin: F32, direction: F32,
    start: int, stop: int,
) -> None:  # fmt: skip
    """Write the samples of rows ``start`` to ``stop``."""
    for k in range(start, stop):
        ahead, right, up = vectors[rows[k]]
        for sample in range(SAMPLES):
            y, z = right / ahead + offsets[sample, 0], up / ahead - offsets[sample, 1]
            length = math.sqrt(1.0 + y * y + z * z)
            for axis in range(3):
                origin[SAMPLES * k + sample, axis] = place[axis]
                along = turn[axis, 0] + turn[axis, 1] * y + turn[axis, 2] * z
                direction[SAMPLES * k + sample, axis] = along / length


@unlocked
def mark_loop(
    instance: I32, distance_m: F32, normal: F32, light: F32, across: int, down: int, edge: NDArray[np.bool_],
    start: int, stop: int,
) -> None:  # fmt: skip
    """Mark the edges among rays ``start`` to ``stop``."""
    width, height = across * TILE_PX, down * TILE_PX
    for ray in range(start, stop):
        tile, within = ray // (TILE_PX * TILE_PX), ray % (TILE_PX * TILE_PX)
        y = tile // across * TILE_PX + within // TILE_PX
        x = tile % across * TILE_PX + within % TILE_PX
        here = light[ray, 0] + light[ray, 1] + light[ray, 2]
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
            there = light[other, 0] + light[other, 1] + light[other, 2]
            if abs(here - there) > _CONTRAST * (here + there + 0.1):
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
