"""Edges of a picture: pixels that need more than one ray, and the rays they get."""

import math

import numpy as np
from numpy.typing import NDArray

from linden.compiled import shading, shading_part, unlocked
from linden.geometry import rotation_matrix
from linden.protocol.values.space import Transform
from linden.sensors.camera.picture.texture_noise import narrow
from linden.sensors.camera.pixel_rays import TILE, TILE_PX, directions, tile_counts
from linden.sensors.camera.spec import CameraSpec
from linden.sensors.casting.caster import NOTHING, Hits, Rays
from linden.sensors.casting.thread_pool import in_stretches

F32 = NDArray[np.float32]
I32 = NDArray[np.int32]

SAMPLES = 4
_PLACES = ((0.125, 0.375), (0.375, 0.875), (0.625, 0.125), (0.875, 0.625))
"""Of the rays in a pixel: a rotated grid, no two in one row or column."""

_CONTRAST, _LEAST = np.float32(0.14), np.float32(0.04)
"""Differences of light that are an edge: wherever they are, and between two things or two sides of one."""
_STEP = np.float32(0.06)
"""A difference of distances that makes two sides of two faces that are not one plane."""


def edge_rays(spec: CameraSpec, hits: Hits, light: F32) -> NDArray[np.intp]:
    """Return the rays of pixels that differ from one of their four neighbours, in order."""
    across, down = tile_counts(spec)
    edge = np.empty(len(light), np.bool_)

    def work(start: int, stop: int) -> None:
        mark_loop(hits.instance, hits.distance_m, hits.normal, light, across, down, edge, start, stop)

    in_stretches(len(edge), work, multiple=TILE)
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


@shading_part
def beside(ray: int, side: int, across: int, down: int) -> int:
    """Return the ray of the pixel to the left (1), to the right (2), above (3) or below (4), or itself (0).

    Beyond the picture there is none: then it is the ray itself.
    """
    tile, x, y = ray // TILE, ray % TILE_PX, ray % TILE // TILE_PX
    if side == 1:
        return ray - 1 if x > 0 else (ray - TILE + TILE_PX - 1 if tile % across > 0 else ray)
    if side == 2:
        return ray + 1 if x < TILE_PX - 1 else (ray + TILE - TILE_PX + 1 if tile % across < across - 1 else ray)
    if side == 3:
        return ray - TILE_PX if y > 0 else (ray - (across - 1) * TILE - TILE_PX if tile >= across else ray)
    if side == 4:
        return (
            ray + TILE_PX
            if y < TILE_PX - 1
            else (ray + (across - 1) * TILE + TILE_PX if tile < (down - 1) * across else ray)
        )
    return ray


@shading_part
def _differ(instance: I32, distance_m: F32, normal: F32, light: F32, ray: int, other: int) -> bool:
    """Return whether there is an edge between two neighbours."""
    here, there = light[ray, 0] + light[ray, 1] + light[ray, 2], light[other, 0] + light[other, 1] + light[other, 2]
    contrast, level = abs(here - there), here + there + 0.1
    if contrast <= _LEAST * level:
        return False
    if contrast > _CONTRAST * level or instance[ray] != instance[other]:
        return True
    if instance[ray] == NOTHING:
        return False
    step_m = abs(distance_m[ray] - distance_m[other])
    along = normal[ray, 0] * normal[other, 0] + normal[ray, 1] * normal[other, 1] + normal[ray, 2] * normal[other, 2]
    beyond: bool = step_m > _STEP * min(distance_m[ray], distance_m[other]) and along < 0.99
    return beyond


def smooth(rows: NDArray[np.intp], samples: F32, brightest: float, light: F32) -> None:
    """Give the pixels of ``rows`` (M,) the mean of their samples (SAMPLES M, 3), none of them above ``brightest``."""

    def work(start: int, stop: int) -> None:
        mean_loop(samples, narrow(brightest), rows, light, start, stop)

    in_stretches(len(rows), work, multiple=TILE_PX)


@unlocked
def split_loop(
    vectors: F32, rows: NDArray[np.intp], offsets: F32, turn: F32, place: F32, origin: F32, direction: F32,
    start: int, stop: int,
) -> None:  # fmt: skip
    """Write the samples of rows ``start`` to ``stop``."""
    for k in range(start, stop):
        row = rows[k]
        right, up = vectors[row, 1] / vectors[row, 0], vectors[row, 2] / vectors[row, 0]
        for sample in range(SAMPLES):
            at = SAMPLES * k + sample
            y, z = right + offsets[sample, 0], up - offsets[sample, 1]
            scale = np.float32(1.0) / math.sqrt(np.float32(1.0) + y * y + z * z)
            origin[at, 0], origin[at, 1], origin[at, 2] = place[0], place[1], place[2]
            direction[at, 0] = (turn[0, 0] + turn[0, 1] * y + turn[0, 2] * z) * scale
            direction[at, 1] = (turn[1, 0] + turn[1, 1] * y + turn[1, 2] * z) * scale
            direction[at, 2] = (turn[2, 0] + turn[2, 1] * y + turn[2, 2] * z) * scale


@shading
def mean_loop(samples: F32, brightest: float, rows: NDArray[np.intp], light: F32, start: int, stop: int) -> None:
    """Give the pixels of ``rows`` ``start`` to ``stop`` the mean of their samples, none brighter than ``brightest``."""
    for k in range(start, stop):
        row = rows[k]
        for channel in range(3):
            total = np.float32(0.0)
            for sample in range(SAMPLES):
                total += min(samples[SAMPLES * k + sample, channel], brightest)
            light[row, channel] = total * np.float32(1.0 / SAMPLES)


@shading
def mark_loop(
    instance: I32, distance_m: F32, normal: F32, light: F32, across: int, down: int, edge: NDArray[np.bool_],
    start: int, stop: int,
) -> None:  # fmt: skip
    """Mark the edges among rays ``start`` to ``stop``."""
    for ray in range(start, stop):
        edge[ray] = (
            _differ(instance, distance_m, normal, light, ray, beside(ray, 1, across, down))
            or _differ(instance, distance_m, normal, light, ray, beside(ray, 2, across, down))
            or _differ(instance, distance_m, normal, light, ray, beside(ray, 3, across, down))
            or _differ(instance, distance_m, normal, light, ray, beside(ray, 4, across, down))
        )
