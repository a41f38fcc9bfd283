"""Surface points at hits: place in the body, normal, colour, light of its own, and the rain on it.

Parts for one place each; ``shade`` puts them together, for a GPU number after number, for the CPU stage after stage.
"""

import math
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from linden.compiled import shading_part
from linden.scenery.mesh import LampOf, Material
from linden.sensors.camera.picture.atmosphere import Air
from linden.sensors.camera.picture.texture_noise import hashed, narrow, ramp, smooth_noise, whole

Floats: TypeAlias = NDArray[Any]
Columns: TypeAlias = Any
"""Arrays of 32 bits, and tuples of them (``Rays``, ``Hits``): what is taken out of them is no float to mypy."""

U32 = NDArray[np.uint32]
Three = tuple[float, float, float]

_GLASS, _WINDOW = int(Material.GLASS), int(LampOf.WINDOW)
_PER_STOREY = narrow(1.0 / 2.8)
_AT_HOME = narrow(0.65)
"""By night as many of all storeys are lit."""

SHINE = np.ones(32, np.float32)
"""How bright a lamp that is on looks itself, by LampOf; 1 is a white wall in half the noon's sun."""
SHINE[[LampOf.STREET, LampOf.HEAD, LampOf.TAIL, LampOf.WINDOW]] = 5.0, 5.0, 1.3, 0.5
SHINE[[LampOf.TRAFFIC_RED, LampOf.TRAFFIC_YELLOW, LampOf.TRAFFIC_GREEN]] = 1.8
SHINE[[LampOf.BLINKER_LEFT, LampOf.BLINKER_RIGHT]] = 2.0


class Places(NamedTuple):
    """What is known of each place of a hit: first what stands, then each instance; ``instance + 1`` is its row."""

    first: NDArray[np.int64]  # (1 + K,) face
    world: Floats  # (1 + K, 3, 4) from the body's frame to the world
    back: Floats  # (1 + K, 3, 4) from the world to the body's frame
    colour: Floats  # (1 + K, 3) linear, of painted faces
    lights: U32  # (1 + K,) LampOf bits
    object_lights: U32  # (O,)


@shading_part
def _through(matrix: Floats, row: int, x: float, y: float, z: float, w: float) -> Three:
    """Return a point (w 1) or a vector (w 0) through one of (K, 3, 4) matrices."""
    return (
        matrix[row, 0, 0] * x + matrix[row, 0, 1] * y + matrix[row, 0, 2] * z + matrix[row, 0, 3] * w,
        matrix[row, 1, 0] * x + matrix[row, 1, 1] * y + matrix[row, 1, 2] * z + matrix[row, 1, 3] * w,
        matrix[row, 2, 0] * x + matrix[row, 2, 1] * y + matrix[row, 2, 2] * z + matrix[row, 2, 3] * w,
    )


@shading_part
def place_in_body(place: int, x: float, y: float, z: float, places: Places) -> Three:
    """Return a place of the world in the frame of the body that was hit."""
    return _through(places.back, place, x, y, z, 1.0) if place > 0 else (x, y, z)


@shading_part
def normal_in_body(place: int, nx: float, ny: float, nz: float, places: Places) -> Three:
    """Return a normal of the world in the frame of the body that was hit; its length where that is scaled is none."""
    return _through(places.back, place, nx, ny, nz, 0.0) if place > 0 else (nx, ny, nz)


@shading_part
def normal_at(
    place: int, face: int, bx: float, by: float, bz: float, nx: float, ny: float, nz: float,
    relief: Columns, places: Places,
) -> Three:  # fmt: skip
    """Return the normal in the world at a place in the body's frame: a round face's own, or what it was hit with."""
    row = relief.row[face]
    if row < 0:
        return nx, ny, nz
    nx, ny, nz = _rounded(relief, row, bx, by, bz)
    if place > 0:
        nx, ny, nz = _through(places.world, place, nx, ny, nz, 0.0)
    scale = 1.0 / max(math.sqrt(nx * nx + ny * ny + nz * nz), 1e-9)
    return nx * scale, ny * scale, nz * scale


@shading_part
def _rounded(relief: Columns, row: int, x: float, y: float, z: float) -> Three:
    """Return the normal at a point of a rounded face, in the frame of its mesh: its corners' by their nearness."""
    c, n = relief.corner_m, relief.normal
    e1x, e1y, e1z = c[row, 1, 0] - c[row, 0, 0], c[row, 1, 1] - c[row, 0, 1], c[row, 1, 2] - c[row, 0, 2]
    e2x, e2y, e2z = c[row, 2, 0] - c[row, 0, 0], c[row, 2, 1] - c[row, 0, 1], c[row, 2, 2] - c[row, 0, 2]
    px, py, pz = x - c[row, 0, 0], y - c[row, 0, 1], z - c[row, 0, 2]
    d11, d12 = e1x * e1x + e1y * e1y + e1z * e1z, e1x * e2x + e1y * e2y + e1z * e2z
    d22 = e2x * e2x + e2y * e2y + e2z * e2z
    dp1, dp2 = px * e1x + py * e1y + pz * e1z, px * e2x + py * e2y + pz * e2z
    scale = 1.0 / max(d11 * d22 - d12 * d12, 1e-20)
    u, v = (d22 * dp1 - d12 * dp2) * scale, (d11 * dp2 - d12 * dp1) * scale
    w = 1.0 - u - v
    return (
        w * n[row, 0, 0] + u * n[row, 1, 0] + v * n[row, 2, 0],
        w * n[row, 0, 1] + u * n[row, 1, 1] + v * n[row, 2, 1],
        w * n[row, 0, 2] + u * n[row, 1, 2] + v * n[row, 2, 2],
    )


@shading_part
def lamp_at(place: int, face: int, bz: float, faces: Columns, places: Places, shine: Floats) -> tuple[int, float]:
    """Return what a lamp is made of and how bright it is: 0 where it is off; a dark window is glass."""
    lamp, thing = int(faces.lamp[face]), faces.object[face]
    bits = places.lights[place]
    if place == 0 and thing >= 0:
        bits = places.object_lights[thing]
    glow = shine[lamp] if (bits >> np.uint32(lamp)) & np.uint32(1) else 0.0
    if lamp == _WINDOW and (glow == 0.0 or hashed(thing, whole(bz * _PER_STOREY), 81) > _AT_HOME):
        return _GLASS, 0.0
    return int(faces.material[face]), glow


@shading_part
def colour_at(place: int, face: int, glow: float, faces: Columns, places: Places) -> Three:
    """Return the colour of a face, or of the actor's paint."""
    if faces.painted[face]:
        return places.colour[place, 0], places.colour[place, 1], places.colour[place, 2]
    red, green, blue = faces.colour[face, 0], faces.colour[face, 1], faces.colour[face, 2]
    if glow > 0.0 and faces.lamp[face] == _WINDOW:  # a lamp of 2700 K within
        green, blue = 0.72 * green, 0.38 * blue
    return red, green, blue


@shading_part
def facing(nx: float, ny: float, nz: float, dx: float, dy: float, dz: float, bend: float) -> Three:
    """Return a normal turned against the direction (dx, dy, dz), and bent by what there is on a surface."""
    side = -1.0 if nx * dx + ny * dy + nz * dz > 0.0 else 1.0
    nx, ny, nz = side * nx, side * ny, side * nz
    if bend != 0.0:
        nx, ny, nz = nx + 0.7 * bend, ny - 0.5 * bend, nz + 0.4 * bend
        scale = 1.0 / max(math.sqrt(nx * nx + ny * ny + nz * nz), 1e-9)
        nx, ny, nz = nx * scale, ny * scale, nz * scale
    return nx, ny, nz


@shading_part
def wetted(
    x: float, y: float, nx: float, ny: float, nz: float, gloss: float, air: Air
) -> tuple[float, float, float, float, float]:
    """Return normal, gloss and a factor of the colour of ground in the rain: darker, smoother, in hollows under water.

    Only of what looks up: a slope is as it was.
    """
    depth = 0.6 * smooth_noise(0.31 * x, 0.31 * y, 51) + 0.4 * smooth_noise(1.3 * x, 1.3 * y, 52)
    pool = ramp(1.0 - 0.62 * air.puddles, 1.1 - 0.62 * air.puddles, depth)
    tilt = 1.0 - pool
    mx, my = tilt * nx, tilt * ny
    scale = 1.0 / math.sqrt(mx * mx + my * my + nz * nz)
    if nz > 0.8:
        return (
            mx * scale, my * scale, nz * scale, max(gloss, 0.16 * air.wet + 0.65 * pool),
            1.0 - air.wet * (0.42 + 0.25 * pool),
        )  # fmt: skip
    return nx, ny, nz, gloss, 1.0
