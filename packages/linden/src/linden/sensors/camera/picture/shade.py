"""The light that comes to a camera along each of its rays.

``shade_loop`` does it ray after ray, as a GPU does. For the CPU there is ``stages``, eight rays at a time; both are
made of the same parts (``spots``, ``patterns``, ``lit``, ``sky``).
"""

import math
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from linden.compiled import fingerprint, shading
from linden.scenery.mesh import Material
from linden.sensors.camera.picture.atmosphere import Air
from linden.sensors.camera.picture.fields import BLOCK, FLOATS, WHOLE_NUMBERS
from linden.sensors.camera.picture.illumination import Near, clear, dull, glossed, lamplight, mirrored, through_air
from linden.sensors.camera.picture.lamps import LampGrid
from linden.sensors.camera.picture.patterns import WETTED, look_of
from linden.sensors.camera.picture.sky import sky, starlight
from linden.sensors.camera.picture.smooth_normals import Relief
from linden.sensors.camera.picture.stages import SKY_M, shade_blocks
from linden.sensors.camera.picture.surface_points import (
    SHINE,
    Columns,
    Floats,
    Places,
    colour_at,
    facing,
    lamp_at,
    normal_at,
    normal_in_body,
    place_in_body,
    wetted,
)
from linden.sensors.casting.caster import NOTHING, Hits, Rays
from linden.sensors.casting.thread_pool import in_stretches
from linden.sensors.view import Faces

_HERE = Path(__file__).parent
_LEAVES = int(Material.LEAVES)

Narrow = TypeVar("Narrow", Air, LampGrid)
Shade = Callable[[Rays, Hits, Floats, float, Faces, Relief, Places, Floats, Air, LampGrid, Floats, int, int], None]


def single(values: Narrow) -> Narrow:
    """Return a tuple with floats of 32 bits, as kernels want them."""
    fields: Iterable[Any] = values
    return values._replace(**dict(zip(values._fields, map(_single, fields), strict=True)))


def _single(value: Any) -> Any:  # noqa: ANN401 - a float, a tuple of them, or something else, that stays as it is
    if isinstance(value, tuple):
        return tuple(map(np.float32, value))
    return np.float32(value) if isinstance(value, float) else value


def _build(built_of: int) -> Shade:
    """Compile the kernel; ``built_of`` is in its closure, so that it is renewed with the parts it is made of."""

    @shading
    def shade(
        rays: Columns, hits: Columns, sunny: Floats, pixel_rad: float, faces: Columns, relief: Columns, places: Places,
        shine: Floats, air: Air, grid: Columns, light: Floats, start: int, stop: int,
    ) -> None:  # fmt: skip
        if built_of < 0:
            return
        for i in range(start, stop):
            dx, dy, dz = rays.direction[i, 0], rays.direction[i, 1], rays.direction[i, 2]
            if hits.instance[i] == NOTHING:
                star = air.stars * starlight(dx, dy, dz) if air.stars > 0.0 else 0.0
                seen = sky(dx, dy, dz, star, air)
                kept = clear(SKY_M, max(dz, 0.0), air)
            else:
                far, place = hits.distance_m[i], hits.instance[i] + 1
                face = places.first[place] + hits.triangle[i]
                x, y, z = (
                    rays.origin_m[i, 0] + far * dx,
                    rays.origin_m[i, 1] + far * dy,
                    rays.origin_m[i, 2] + far * dz,
                )
                hx, hy, hz = hits.normal[i, 0], hits.normal[i, 1], hits.normal[i, 2]
                pixel_m = far * pixel_rad / math.sqrt(max(abs(hx * dx + hy * dy + hz * dz), 0.08))
                bx, by, bz = place_in_body(place, x, y, z, places)
                fx, fy, fz = normal_in_body(place, hx, hy, hz, places)
                material, glow = int(faces.material[face]), 0.0
                if faces.lamp[face] > 0:
                    material, glow = lamp_at(place, face, bz, faces, places, shine)
                red, green, blue = colour_at(place, face, glow, faces, places)
                look = look_of(material, bx, by, bz, fx, fy, fz, pixel_m)
                red, green, blue = red * look.red, green * look.green, blue * look.blue
                nx, ny, nz = normal_at(place, face, bx, by, bz, hx, hy, hz, relief, places)
                nx, ny, nz = facing(nx, ny, nz, dx, dy, dz, look.bend)
                gloss = look.gloss
                if air.wet > 0.0 and material in WETTED:
                    nx, ny, nz, gloss, dark = wetted(x, y, nx, ny, nz, gloss, air)
                    red, green, blue = red * dark, green * dark, blue * dark
                near = Near(0.0, 0.0, 0.0, 0.0)
                if len(grid.number) > 0:
                    rx, ry, rz = mirrored(nx, ny, nz, dx, dy, dz)
                    near = lamplight(x, y, z, nx, ny, nz, rx, ry, rz, grid)
                seen = dull(nx, ny, nz, red, green, blue, sunny[i], material == _LEAVES, near, air)
                if gloss > 0.0:
                    seen = glossed(seen, nx, ny, nz, dx, dy, dz, gloss, sunny[i], near.glint, air)
                seen = seen[0] + glow * red, seen[1] + glow * green, seen[2] + glow * blue
                kept = clear(far, dz, air)
            light[i, 0], light[i, 1], light[i, 2] = through_air(seen, kept, air)

    return shade


_PARTS = (
    "atmosphere", "illumination", "lamps", "patterns", "shade", "sky", "smooth_normals", "surface_points",
    "texture_noise",
)  # fmt: skip
shade_loop = _build(fingerprint(*(_HERE / f"{name}.py" for name in _PARTS)))


def shaded(
    rays: Rays, hits: Hits, sunny: Floats, pixel_rad: float, faces: Faces, relief: Relief, places: Places, air: Air,
    grid: LampGrid,
) -> Floats:  # fmt: skip
    """Return the light (N, 3) that comes along each ray; ``sunny`` (N,) is the share of the sun that each hit sees."""
    light = np.empty((len(sunny), 3), np.float32)
    given = np.float32(pixel_rad), faces, relief, places, SHINE, single(air), single(grid)

    def work(start: int, stop: int) -> None:
        floats, numbers = np.empty(FLOATS, np.float32), np.empty(WHOLE_NUMBERS, np.int32)
        shade_blocks(rays, hits, sunny, *given, light, floats, numbers, start, stop)

    in_stretches(len(light), work, multiple=BLOCK)
    return light
