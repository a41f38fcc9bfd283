"""The light that goes from a spot to the eye: of the sun, the sky and lamps, and what the air between leaves of it.

Parts for one place each, see ``spots``.
"""

import math
from typing import NamedTuple

from linden.compiled import shading_part
from linden.sensors.camera.picture.atmosphere import Air
from linden.sensors.camera.picture.lamps import CELL_M, CELLS
from linden.sensors.camera.picture.sky import clear_sky
from linden.sensors.camera.picture.surface_points import Columns, Three
from linden.sensors.camera.picture.texture_noise import fading, narrow, ramp

_PER_CELL = narrow(1.0 / CELL_M)


class Near(NamedTuple):
    """The light of lamps on a spot, and what of it goes on to the eye where the spot is smooth."""

    red: float
    green: float
    blue: float
    glint: float


@shading_part
def mirrored(nx: float, ny: float, nz: float, dx: float, dy: float, dz: float) -> Three:
    """Return where a ray along (dx, dy, dz) goes on to from a mirror."""
    twice = 2.0 * (nx * dx + ny * dy + nz * dz)
    return dx - twice * nx, dy - twice * ny, dz - twice * nz


@shading_part
def lamplight(
    x: float, y: float, z: float, nx: float, ny: float, nz: float, rx: float, ry: float, rz: float, grid: Columns
) -> Near:
    """Return the light that lamps give to a spot that mirrors towards (rx, ry, rz)."""
    red, green, blue, glint = 0.0, 0.0, 0.0, 0.0
    column, row = int((x - grid.west_m) * _PER_CELL), int((y - grid.north_m) * _PER_CELL)
    if column < 0 or row < 0 or column >= CELLS or row >= CELLS:
        return Near(red, green, blue, glint)
    cell = row * CELLS + column
    for entry in range(grid.first[cell], grid.first[cell + 1]):
        lamp = grid.lamps[grid.number[entry]]
        lx, ly, lz = lamp.place[0] - x, lamp.place[1] - y, lamp.place[2] - z
        far2 = lx * lx + ly * ly + lz * lz
        if far2 > lamp.reach * lamp.reach:
            continue
        near = 1.0 / (math.sqrt(far2) + 1e-6)
        lx, ly, lz = lx * near, ly * near, lz * near
        along = -(lx * lamp.towards[0] + ly * lamp.towards[1] + lz * lamp.towards[2])
        if along <= lamp.low:
            continue
        beam = ramp(lamp.low, lamp.high, along)
        strength = beam * beam * (1.0 - far2 / (lamp.reach * lamp.reach)) / max(far2, 0.3)
        if lamp.cut:  # it throws most of its light far ahead: R112 of UN ECE asks for little before the car
            strength *= (0.12 + 0.88 * ramp(-0.03, 0.01, lz)) * min(1.0, far2 / 90.0)
        lit = max(nx * lx + ny * ly + nz * lz, 0.0) * strength
        red += lit * lamp.light[0]
        green += lit * lamp.light[1]
        blue += lit * lamp.light[2]
        towards = rx * lx + ry * ly + rz * lz
        if towards > 0.0:
            glint += towards**40 * strength * lamp.light[1]
    return Near(red, green, blue, glint)


@shading_part
def dull(
    nx: float, ny: float, nz: float, red: float, green: float, blue: float, sunny: float, leaves: bool,  # noqa: FBT001 - numba knows no keywords
    near: Near, air: Air,
) -> Three:  # fmt: skip
    """Return the light of a spot of a colour that mirrors nothing."""
    straight = nx * air.sun_x + ny * air.sun_y + nz * air.sun_z
    direct = max(straight, 0.0)
    if leaves:  # light comes through leaves, and they shade one another
        direct = 0.75 * direct + 0.25 * (0.5 - 0.5 * straight)
    direct *= sunny
    up = 0.5 + 0.5 * nz
    return (
        red * (direct * air.sun[0] + air.below[0] + up * (air.above[0] - air.below[0]) + near.red),
        green * (direct * air.sun[1] + air.below[1] + up * (air.above[1] - air.below[1]) + near.green),
        blue * (direct * air.sun[2] + air.below[2] + up * (air.above[2] - air.below[2]) + near.blue),
    )


@shading_part
def glossed(
    light: Three, nx: float, ny: float, nz: float, dx: float, dy: float, dz: float, gloss: float, sunny: float,
    glint: float, air: Air,
) -> Three:  # fmt: skip
    """Return the light of a smooth spot: with ``gloss`` it mirrors the sky, the sun and lamps."""
    across = nx * dx + ny * dy + nz * dz
    rx, ry, rz = mirrored(nx, ny, nz, dx, dy, dz)
    grazing = max(1.0 + across, 0.0)
    share = gloss * (0.10 + 0.90 * grazing**5)  # Schlick 1994, "An Inexpensive BRDF Model", eq. 15
    sr, sg, sb = clear_sky(rx, ry, rz, air)
    low = 0.45 + 0.55 * ramp(0.0, 0.25, rz)  # near the horizon stand houses and trees
    sr, sg, sb = low * sr, low * sg, low * sb
    if rz <= 0.0:
        sr, sg, sb = 1.6 * air.below[0], 1.6 * air.below[1], 1.6 * air.below[2]
    sr, sg, sb = min(sr, 3.0), min(sg, 3.0), min(sb, 3.0)
    flash = 1.6 * max(rx * air.sun_x + ry * air.sun_y + rz * air.sun_z, 0.0) ** 200 * sunny
    return (
        light[0] + (sr - light[0]) * share + gloss * (flash * air.sun[0] + glint),
        light[1] + (sg - light[1]) * share + gloss * (flash * air.sun[1] + 0.95 * glint),
        light[2] + (sb - light[2]) * share + gloss * (flash * air.sun[2] + 0.85 * glint),
    )


@shading_part
def clear(distance_m: float, rise: float, air: Air) -> float:
    """Return how much light comes through the air on a way that rises by ``rise`` a metre; fog thins with height."""
    way = max(distance_m - air.fog_from_m, 0.0)
    climb = air.fog_falls_per_m * rise * way
    if abs(climb) > 1e-3:
        way *= (1.0 - fading(-climb)) / climb
    return fading(-air.fog_per_m * way)


@shading_part
def through_air(light: Three, kept: float, air: Air) -> Three:
    """Return what comes of light, ``kept`` of which comes through, and of the fog."""
    return (
        air.fog[0] + (light[0] - air.fog[0]) * kept,
        air.fog[1] + (light[1] - air.fog[1]) * kept,
        air.fog[2] + (light[2] - air.fog[2]) * kept,
    )
