"""Which of the spots that a camera sees are lit by the sun."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.compiled import unlocked
from linden.sensors.camera.picture.atmosphere import Air
from linden.sensors.camera.picture.edges import SAMPLES, beside
from linden.sensors.camera.pixel_rays import tile_counts
from linden.sensors.camera.spec import CameraSpec
from linden.sensors.casting.caster import NOTHING, Caster, Hits, Rays
from linden.sensors.casting.thread_pool import in_stretches

F32 = NDArray[np.float32]

LONGEST_SHADOW_M = 250.0

_OFF_M = 2e-3
"""How far from its surface a ray to the sun begins, and"""
_OFF_SHARE = 2e-5
"""how much further for each metre that the surface is away: what a float of 32 bits may be wrong by."""

_DARK = 0.01

UNKNOWN = -1.0
"""Neither lit nor in the shadow, as far as is known."""


class Sunshine(NamedTuple):
    """Which hits (N,) look to the sun, and which of them it reaches: 1, or 0."""

    facing: NDArray[np.bool_]
    lit: F32


def sunny(caster: Caster, rays: Rays, hits: Hits, air: Air, known: F32 | None = None) -> Sunshine:
    """Return where the sun shines; ``known`` (N,) says it of what looks to the sun, where it is not UNKNOWN."""
    facing, lit = np.zeros(len(hits.instance), np.bool_), np.zeros(len(hits.instance), np.float32)
    if not shines(air):
        return Sunshine(facing, lit)
    sun = np.array([air.sun_x, air.sun_y, air.sun_z], np.float32)

    def mark(start: int, stop: int) -> None:
        facing_loop(hits.instance, hits.normal, rays.direction, sun, facing, start, stop)

    in_stretches(len(lit), mark, multiple=16)
    asked = facing
    if known is not None:
        asked = facing & (known == UNKNOWN)
        np.copyto(lit, known, where=facing & ~asked)
    rows = np.flatnonzero(asked)
    origin, direction = np.empty((len(rows), 3), np.float32), np.empty((len(rows), 3), np.float32)

    def gather(start: int, stop: int) -> None:
        gather_loop(
            rows, rays.origin_m, rays.direction, hits.distance_m, hits.normal, sun, origin, direction, start, stop
        )

    in_stretches(len(rows), gather, multiple=16)
    lit[rows] = ~caster.blocked(Rays(origin, direction), LONGEST_SHADOW_M, coherent=True)
    return Sunshine(facing, lit)


def within(spec: CameraSpec, rows: NDArray[np.intp], sun: Sunshine) -> F32:
    """Return (SAMPLES M,) whether the sun shines on what is met in the pixels of ``rows`` (M,): 1, 0 or UNKNOWN.

    It is known where all that look to the sun, of a pixel and its neighbours, are lit or none is: there no shadow ends.
    """
    known = np.empty(SAMPLES * len(rows), np.float32)
    across, down = tile_counts(spec)

    def work(start: int, stop: int) -> None:
        _agree_loop(rows, sun.facing, sun.lit, across, down, known, start, stop)

    in_stretches(len(rows), work, multiple=16)
    return known


@unlocked
def _agree_loop(
    rows: NDArray[np.intp], facing: NDArray[np.bool_], lit: F32, across: int, down: int, known: F32,
    start: int, stop: int,
) -> None:  # fmt: skip
    for k in range(start, stop):
        light, dark = False, False
        for side in range(5):
            ray = beside(rows[k], side, across, down)
            light = light or (facing[ray] and lit[ray] > 0.0)
            dark = dark or (facing[ray] and lit[ray] == 0.0)
        agreed = np.float32(UNKNOWN)
        if light != dark:
            agreed = np.float32(light)
        for sample in range(SAMPLES):
            known[SAMPLES * k + sample] = agreed


def shines(air: Air) -> bool:
    """Return whether the sun throws shadows."""
    return max(air.sun) >= _DARK and air.sun_z > 0.0


@unlocked
def facing_loop(
    instance: NDArray[np.int32], normal: F32, direction: F32, sun: F32, facing: NDArray[np.bool_], start: int, stop: int
) -> None:
    """Mark what is seen from the side that the sun shines on."""
    for i in range(start, stop):
        if instance[i] == NOTHING:
            facing[i] = False
            continue
        seen = normal[i, 0] * direction[i, 0] + normal[i, 1] * direction[i, 1] + normal[i, 2] * direction[i, 2]
        shone = normal[i, 0] * sun[0] + normal[i, 1] * sun[1] + normal[i, 2] * sun[2]
        facing[i] = seen * shone < 0.0


@unlocked
def gather_loop(
    rows: NDArray[np.intp], origin: F32, direction: F32, distance_m: F32, normal: F32, sun: F32, from_m: F32,
    towards: F32, start: int, stop: int,
) -> None:  # fmt: skip
    """Write the rays to the sun of the hits in ``rows``."""
    for k in range(start, stop):
        i = rows[k]
        side = normal[i, 0] * sun[0] + normal[i, 1] * sun[1] + normal[i, 2] * sun[2]
        off_m = _OFF_M + _OFF_SHARE * distance_m[i]
        if side < 0.0:
            off_m = -off_m
        for axis in range(3):
            from_m[k, axis] = origin[i, axis] + direction[i, axis] * distance_m[i] + normal[i, axis] * off_m
            towards[k, axis] = sun[axis]
