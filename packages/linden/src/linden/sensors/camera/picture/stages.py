"""Shading on the CPU: rays in blocks, sorted by what they met, each stage a loop that is done eight rays at a time.

Only what has to look things up (``_gather``, lamps, stars) goes ray after ray.
"""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from linden.compiled import fingerprint, shading, shading_stage
from linden.scenery.mesh import Material
from linden.sensors.camera.picture.atmosphere import Air
from linden.sensors.camera.picture.fields import (
    BLOCK,
    BLUE,
    BX,
    BY,
    BZ,
    DX,
    DY,
    DZ,
    END,
    FAR,
    FIRST,
    FX,
    FY,
    FZ,
    GLINT,
    GLOSS,
    GLOW,
    GREEN,
    LAMP_BLUE,
    LAMP_GREEN,
    LAMP_RED,
    MATERIAL,
    NX,
    NY,
    NZ,
    ORDER,
    PIXEL,
    RED,
    SUNNY,
    X,
    Y,
    Z,
)
from linden.sensors.camera.picture.illumination import Near, clear, dull, glossed, lamplight, mirrored, through_air
from linden.sensors.camera.picture.materials import dress
from linden.sensors.camera.picture.patterns import LEAVES, WETTED, gloss_of
from linden.sensors.camera.picture.sky import sky, starlight
from linden.sensors.camera.picture.surface_points import (
    Columns,
    Floats,
    Places,
    colour_at,
    lamp_at,
    normal_at,
    normal_in_body,
    place_in_body,
    wetted,
)
from linden.sensors.camera.picture.texture_noise import narrow
from linden.sensors.casting.caster import NOTHING

I32 = NDArray[np.int32]

SKY_M = narrow(20000.0)
"""A way through the air to where there is none left."""

_SKY = len(Material)  # where materials are numbered, of what meets nothing
_KINDS = _SKY + 1


@shading_stage
def _lamp(rays: Columns, hits: Columns, i: int, faces: Columns, places: Places, shine: Floats) -> tuple[int, float]:
    """Return the material of what a ray met, and how bright it shines by itself."""
    place = hits.instance[i] + 1
    face = places.first[place] + hits.triangle[i]
    if faces.lamp[face] == 0:
        return int(faces.material[face]), 0.0
    origin, direction, far = rays.origin_m[i], rays.direction[i], hits.distance_m[i]
    x, y, z = origin[0] + far * direction[0], origin[1] + far * direction[1], origin[2] + far * direction[2]
    _, _, bz = place_in_body(place, x, y, z, places)
    return lamp_at(place, face, bz, faces, places, shine)


@shading_stage
def _sort(
    rays: Columns, hits: Columns, faces: Columns, places: Places, shine: Floats, numbers: I32, base: int, count: int
) -> None:
    """Write the order of a block's rays by the material that they met, and where each material begins."""
    for kind in range(_KINDS + 2):
        numbers[FIRST + kind] = 0
    for k in range(count):
        kind = _SKY
        if hits.instance[base + k] != NOTHING:
            kind, _ = _lamp(rays, hits, base + k, faces, places, shine)
        numbers[MATERIAL + k] = kind
        numbers[FIRST + kind + 2] += 1
    for kind in range(_KINDS):
        numbers[FIRST + kind + 2] += numbers[FIRST + kind + 1]
    for k in range(count):
        kind = numbers[MATERIAL + k]
        numbers[ORDER + numbers[FIRST + kind + 1]] = base + k
        numbers[FIRST + kind + 1] += 1


@shading_stage
def _gather(
    rays: Columns, hits: Columns, sunny: Floats, pixel_rad: float, faces: Columns, relief: Columns, places: Places,
    shine: Floats, numbers: I32, f: Floats, count: int,
) -> None:  # fmt: skip
    """Look up what is known of each hit: place, normal, colour, light of its own."""
    for k in range(count):
        i = numbers[ORDER + k]
        dx, dy, dz = rays.direction[i, 0], rays.direction[i, 1], rays.direction[i, 2]
        far, place = hits.distance_m[i], hits.instance[i] + 1
        face = places.first[place] + hits.triangle[i]
        x, y, z = rays.origin_m[i, 0] + far * dx, rays.origin_m[i, 1] + far * dy, rays.origin_m[i, 2] + far * dz
        hx, hy, hz = hits.normal[i, 0], hits.normal[i, 1], hits.normal[i, 2]
        bx, by, bz = place_in_body(place, x, y, z, places)
        glow = 0.0
        if faces.lamp[face] > 0:
            _, glow = lamp_at(place, face, bz, faces, places, shine)
        f[FAR + k], f[SUNNY + k], f[GLOW + k] = far, sunny[i], glow
        f[PIXEL + k] = far * pixel_rad / math.sqrt(max(abs(hx * dx + hy * dy + hz * dz), 0.08))
        f[DX + k], f[DY + k], f[DZ + k] = dx, dy, dz
        f[X + k], f[Y + k], f[Z + k] = x, y, z
        f[BX + k], f[BY + k], f[BZ + k] = bx, by, bz
        f[FX + k], f[FY + k], f[FZ + k] = normal_in_body(place, hx, hy, hz, places)
        f[RED + k], f[GREEN + k], f[BLUE + k] = colour_at(place, face, glow, faces, places)
        f[NX + k], f[NY + k], f[NZ + k] = normal_at(place, face, bx, by, bz, hx, hy, hz, relief, places)


@shading_stage
def _wet(f: Floats, count: int, air: Air) -> None:
    for k in range(count):
        nx, ny, nz, gloss, dark = wetted(f[X + k], f[Y + k], f[NX + k], f[NY + k], f[NZ + k], f[GLOSS + k], air)
        f[NX + k], f[NY + k], f[NZ + k], f[GLOSS + k] = nx, ny, nz, gloss
        f[RED + k], f[GREEN + k], f[BLUE + k] = f[RED + k] * dark, f[GREEN + k] * dark, f[BLUE + k] * dark


@shading_stage
def _lamps(f: Floats, count: int, grid: Columns) -> None:
    for k in range(count):
        nx, ny, nz = f[NX + k], f[NY + k], f[NZ + k]
        rx, ry, rz = mirrored(nx, ny, nz, f[DX + k], f[DY + k], f[DZ + k])
        near = lamplight(f[X + k], f[Y + k], f[Z + k], nx, ny, nz, rx, ry, rz, grid)
        f[LAMP_RED + k], f[LAMP_GREEN + k], f[LAMP_BLUE + k], f[GLINT + k] = near


def _lighting(*, through: bool, glossy: bool) -> Callable[[Floats, int, Air], None]:
    """Return the loop that lights spots, and sends their light through the air, for spots of one sort."""

    @shading_stage
    def light(f: Floats, count: int, air: Air) -> None:
        for k in range(count):
            near = Near(f[LAMP_RED + k], f[LAMP_GREEN + k], f[LAMP_BLUE + k], f[GLINT + k])
            nx, ny, nz = f[NX + k], f[NY + k], f[NZ + k]
            red, green, blue = f[RED + k], f[GREEN + k], f[BLUE + k]
            dx, dy, dz = f[DX + k], f[DY + k], f[DZ + k]
            glow, sunny = f[GLOW + k], f[SUNNY + k]
            seen = dull(nx, ny, nz, red, green, blue, sunny, through, near, air)
            if glossy:
                seen = glossed(seen, nx, ny, nz, dx, dy, dz, f[GLOSS + k], sunny, near.glint, air)
            seen = seen[0] + glow * red, seen[1] + glow * green, seen[2] + glow * blue
            f[RED + k], f[GREEN + k], f[BLUE + k] = through_air(seen, clear(f[FAR + k], dz, air), air)

    return light


_light_leaves = _lighting(through=True, glossy=False)
_light_dull = _lighting(through=False, glossy=False)
_light_glossy = _lighting(through=False, glossy=True)


@shading_stage
def _heaven(rays: Columns, numbers: I32, f: Floats, count: int, air: Air) -> None:
    """Give light to rays that meet nothing; ``numbers`` and ``f`` begin with the first of them."""
    for k in range(count):
        i = numbers[ORDER + k]
        dx, dy, dz = rays.direction[i, 0], rays.direction[i, 1], rays.direction[i, 2]
        f[DX + k], f[DY + k], f[DZ + k] = dx, dy, dz
        f[GLOW + k] = air.stars * starlight(dx, dy, dz) if air.stars > 0.0 else 0.0
    for k in range(count):
        dx, dy, dz = f[DX + k], f[DY + k], f[DZ + k]
        seen = sky(dx, dy, dz, f[GLOW + k], air)
        f[RED + k], f[GREEN + k], f[BLUE + k] = through_air(seen, clear(SKY_M, max(dz, 0.0), air), air)


@shading_stage
def _shade(material: int, f: Floats, count: int, air: Air, grid: Columns) -> None:
    """Turn what is known of spots of one material into the light that comes from them."""
    dress(material, f, count)
    wet = air.wet > 0.0 and material in WETTED
    if wet:
        _wet(f, count, air)
    if len(grid.number) > 0:
        _lamps(f, count, grid)
    if material == LEAVES:
        _light_leaves(f, count, air)
    elif wet or gloss_of(material) > 0.0:
        _light_glossy(f, count, air)
    else:
        _light_dull(f, count, air)


def _build(built_of: int) -> Callable[..., None]:
    """Compile the kernel; ``built_of`` is in its closure, so that it is renewed with the parts it is made of."""

    @shading
    def shade_blocks(
        rays: Columns, hits: Columns, sunny: Floats, pixel_rad: float, faces: Columns, relief: Columns, places: Places,
        shine: Floats, air: Air, grid: Columns, light: Floats, floats: Floats, numbers: I32, start: int, stop: int,
    ) -> None:  # fmt: skip
        if built_of < 0:
            return
        for field in range(LAMP_RED, END):
            floats[field] = 0.0
        for base in range(start, stop, BLOCK):
            count = min(BLOCK, stop - base)
            _sort(rays, hits, faces, places, shine, numbers, base, count)
            met = numbers[FIRST + _SKY]
            _gather(rays, hits, sunny, pixel_rad, faces, relief, places, shine, numbers, floats, met)
            for material in range(_SKY):
                first = numbers[FIRST + material]
                many = numbers[FIRST + material + 1] - first
                if many > 0:
                    _shade(material, floats[first:], many, air, grid)
            _heaven(rays, numbers[met:], floats[met:], count - met, air)
            for k in range(count):
                i = numbers[ORDER + k]
                light[i, 0], light[i, 1], light[i, 2] = floats[RED + k], floats[GREEN + k], floats[BLUE + k]

    return shade_blocks


_HERE = Path(__file__).parent
_PARTS = (
    "atmosphere", "fields", "illumination", "lamps", "materials", "patterns", "sky", "smooth_normals", "stages",
    "surface_points", "texture_noise",
)  # fmt: skip
shade_blocks = _build(fingerprint(*(_HERE / f"{name}.py" for name in _PARTS)))
