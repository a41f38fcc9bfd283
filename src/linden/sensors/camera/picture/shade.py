"""The light that comes to a camera along each of its rays: one kernel over what the rays met."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.casting.crew import in_stretches
from linden.casting.rays import NOTHING, Hits, Rays
from linden.compiled import fingerprint, shading, shading_part
from linden.meshes.mesh import LampOf, Material
from linden.sensors.camera.picture.atmosphere import Air
from linden.sensors.camera.picture.lamps import CELL_M, LampGrid
from linden.sensors.camera.picture.noise import hashed, ramp, smooth_noise
from linden.sensors.camera.picture.patterns import look_of
from linden.sensors.camera.picture.relief import Relief
from linden.sensors.camera.picture.sky import clear_sky, sky
from linden.sensors.seen import Faces

F32 = NDArray[np.float32]
I32 = NDArray[np.int32]
U32 = NDArray[np.uint32]

_HERE = Path(__file__).parent
_LAMP, _LEAVES, _GLASS = int(Material.LAMP), int(Material.LEAVES), int(Material.GLASS)
_WETTED = (int(Material.ASPHALT), int(Material.CONCRETE), int(Material.PAINT), int(Material.GRAVEL))
_WINDOW = int(LampOf.WINDOW)
_CELLS = 40
_STOREY_M, _AT_HOME = 2.8, 0.65
"""By night as many of all storeys are lit."""

SHINE = np.ones(32, np.float32)
"""How bright a lamp that is on looks itself, by LampOf; 1 is a white wall in half the noon's sun."""
SHINE[[LampOf.STREET, LampOf.HEAD, LampOf.TAIL, LampOf.WINDOW]] = 5.0, 5.0, 1.3, 0.5
SHINE[[LampOf.TRAFFIC_RED, LampOf.TRAFFIC_YELLOW, LampOf.TRAFFIC_GREEN]] = 1.8
SHINE[[LampOf.BLINKER_LEFT, LampOf.BLINKER_RIGHT]] = 2.0


class Places(NamedTuple):
    """What is known of each place of a hit: first what stands, then each instance; ``instance + 1`` is its row."""

    first: NDArray[np.int64]  # (1 + K,) face
    world: F32  # (1 + K, 3, 4) from the body's frame to the world
    back: F32  # (1 + K, 3, 4) from the world to the body's frame
    colour: F32  # (1 + K, 3) linear, of painted faces
    lights: U32  # (1 + K,) LampOf bits
    object_lights: U32  # (O,)


class Spot(NamedTuple):
    """A point that is seen: place and normal in the world, colour, gloss, and what it shines by itself."""

    x: float
    y: float
    z: float
    nx: float
    ny: float
    nz: float
    red: float
    green: float
    blue: float
    gloss: float
    shine: float


@shading_part
def _through(matrix: F32, x: float, y: float, z: float, w: float) -> tuple[float, float, float]:
    """Return a point (w 1) or a vector (w 0) through a (3, 4) matrix."""
    return (
        matrix[0, 0] * x + matrix[0, 1] * y + matrix[0, 2] * z + matrix[0, 3] * w,
        matrix[1, 0] * x + matrix[1, 1] * y + matrix[1, 2] * z + matrix[1, 3] * w,
        matrix[2, 0] * x + matrix[2, 1] * y + matrix[2, 2] * z + matrix[2, 3] * w,
    )


@shading_part
def _rounded(relief: Relief, row: int, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return the normal at a point of a rounded face, in the frame of its mesh: its corners' by their nearness."""
    corner, normal = relief.corner_m[row], relief.normal[row]
    e1x, e1y, e1z = corner[1, 0] - corner[0, 0], corner[1, 1] - corner[0, 1], corner[1, 2] - corner[0, 2]
    e2x, e2y, e2z = corner[2, 0] - corner[0, 0], corner[2, 1] - corner[0, 1], corner[2, 2] - corner[0, 2]
    px, py, pz = x - corner[0, 0], y - corner[0, 1], z - corner[0, 2]
    d11, d12, d22 = e1x * e1x + e1y * e1y + e1z * e1z, e1x * e2x + e1y * e2y + e1z * e2z, e2x**2 + e2y**2 + e2z**2
    dp1, dp2 = px * e1x + py * e1y + pz * e1z, px * e2x + py * e2y + pz * e2z
    area = max(d11 * d22 - d12 * d12, 1e-20)
    u, v = (d22 * dp1 - d12 * dp2) / area, (d11 * dp2 - d12 * dp1) / area
    w = 1.0 - u - v
    return (
        w * normal[0, 0] + u * normal[1, 0] + v * normal[2, 0],
        w * normal[0, 1] + u * normal[1, 1] + v * normal[2, 1],
        w * normal[0, 2] + u * normal[1, 2] + v * normal[2, 2],
    )


@shading_part
def _glow(lamp: int, place: int, of_object: int, places: Places, shine: F32) -> float:
    """Return how bright a lamp is: 0 where it is off."""
    bits = places.lights[place]
    if place == 0 and of_object >= 0:
        bits = places.object_lights[of_object]
    return shine[lamp] if bits >> np.uint32(lamp) & np.uint32(1) else 0.0


@shading_part
def _wetted(spot: Spot, air: Air) -> Spot:
    """Return a spot of the ground in the rain: darker, smoother, and under water where the ground is low."""
    depth = 0.6 * smooth_noise(0.31 * spot.x, 0.31 * spot.y, 51) + 0.4 * smooth_noise(1.3 * spot.x, 1.3 * spot.y, 52)
    pool = ramp(1.0 - 0.62 * air.puddles, 1.1 - 0.62 * air.puddles, depth)
    dark = 1.0 - air.wet * (0.42 + 0.25 * pool)
    tilt = 1.0 - pool
    nx, ny = tilt * spot.nx, tilt * spot.ny
    length = math.sqrt(nx * nx + ny * ny + spot.nz * spot.nz)
    return Spot(
        spot.x, spot.y, spot.z, nx / length, ny / length, spot.nz / length,
        spot.red * dark, spot.green * dark, spot.blue * dark, max(spot.gloss, 0.16 * air.wet + 0.65 * pool), spot.shine,
    )  # fmt: skip


@shading_part
def _spot(
    x: float, y: float, z: float, dx: float, dy: float, dz: float, nx: float, ny: float, nz: float,
    pixel_m: float, place: int, face: int, faces: Faces, relief: Relief, places: Places, shine: F32, air: Air,
) -> Spot:  # fmt: skip
    """Return what there is at a hit: colour with its pattern, the normal bent, wet where it rained."""
    bx, by, bz, fx, fy, fz = x, y, z, nx, ny, nz
    if place > 0:
        bx, by, bz = _through(places.back[place], x, y, z, 1.0)
        fx, fy, fz = _through(places.back[place], nx, ny, nz, 0.0)
    if relief.row[face] >= 0:
        rx, ry, rz = _rounded(relief, relief.row[face], bx, by, bz)
        nx, ny, nz = _through(places.world[place], rx, ry, rz, 0.0) if place > 0 else (rx, ry, rz)
        length = max(math.sqrt(nx * nx + ny * ny + nz * nz), 1e-9)
        nx, ny, nz = nx / length, ny / length, nz / length
    material, lamp = int(faces.material[face]), int(faces.lamp[face])
    red, green, blue = faces.colour[face, 0], faces.colour[face, 1], faces.colour[face, 2]
    if faces.painted[face]:
        red, green, blue = places.colour[place, 0], places.colour[place, 1], places.colour[place, 2]
    glow = _glow(lamp, place, faces.object[face], places, shine) if lamp > 0 else 0.0
    if lamp == _WINDOW:
        if hashed(faces.object[face], math.floor(bz / _STOREY_M), 81) > _AT_HOME:
            glow = 0.0
        if glow == 0.0:
            material = _GLASS
        else:  # a lamp of 2700 K within
            green, blue = 0.72 * green, 0.38 * blue
    look = look_of(material, bx, by, bz, fx, fy, fz, pixel_m)
    gloss = look.gloss
    red, green, blue = red * look.red, green * look.green, blue * look.blue
    if nx * dx + ny * dy + nz * dz > 0.0:
        nx, ny, nz = -nx, -ny, -nz
    if look.bend != 0.0:
        nx, ny, nz = nx + 0.7 * look.bend, ny - 0.5 * look.bend, nz + 0.4 * look.bend
        length = max(math.sqrt(nx * nx + ny * ny + nz * nz), 1e-9)
        nx, ny, nz = nx / length, ny / length, nz / length
    spot = Spot(x, y, z, nx, ny, nz, red, green, blue, gloss, glow)
    return _wetted(spot, air) if air.wet > 0.0 and nz > 0.8 and material in _WETTED else spot


@shading_part
def _lamplight(spot: Spot, rx: float, ry: float, rz: float, grid: LampGrid) -> tuple[float, float, float, float]:
    """Return the light that lamps give to a spot, and what of it goes on along (rx, ry, rz) where it is smooth."""
    red, green, blue, glint = 0.0, 0.0, 0.0, 0.0
    if not len(grid.number):
        return red, green, blue, glint
    column, row = int((spot.x - grid.west_m) / CELL_M), int((spot.y - grid.north_m) / CELL_M)
    if column < 0 or row < 0 or column >= _CELLS or row >= _CELLS:
        return red, green, blue, glint
    cell = row * _CELLS + column
    for entry in range(grid.first[cell], grid.first[cell + 1]):
        lamp = grid.lamps[grid.number[entry]]
        lx, ly, lz = lamp.place[0] - spot.x, lamp.place[1] - spot.y, lamp.place[2] - spot.z
        far2 = lx * lx + ly * ly + lz * lz
        if far2 > lamp.reach * lamp.reach:
            continue
        far = math.sqrt(far2) + 1e-6
        lx, ly, lz = lx / far, ly / far, lz / far
        along = -(lx * lamp.towards[0] + ly * lamp.towards[1] + lz * lamp.towards[2])
        facing = max(spot.nx * lx + spot.ny * ly + spot.nz * lz, 0.0)
        if along <= lamp.low:
            continue
        beam = ramp(lamp.low, lamp.high, along)
        strength = beam * beam * (1.0 - far2 / (lamp.reach * lamp.reach)) / max(far2, 0.3)
        if lamp.cut:  # it throws most of its light far ahead: R112 of UN ECE asks for little before the car
            strength *= (0.12 + 0.88 * ramp(-0.03, 0.01, lz)) * min(1.0, far2 / 90.0)
        red += facing * strength * lamp.light[0]
        green += facing * strength * lamp.light[1]
        blue += facing * strength * lamp.light[2]
        mirrored = rx * lx + ry * ly + rz * lz
        if mirrored > 0.0:
            glint += mirrored**40 * strength * lamp.light[1]
    return red, green, blue, glint


@shading_part
def _lit(
    spot: Spot, dx: float, dy: float, dz: float, sunny: float, material: int, air: Air, grid: LampGrid
) -> tuple[float, float, float]:
    """Return the light that goes from a spot to the eye, before the air between."""
    nx, ny, nz = spot.nx, spot.ny, spot.nz
    facing = nx * air.sun_x + ny * air.sun_y + nz * air.sun_z
    direct = max(facing, 0.0) * sunny
    if material == _LEAVES:  # light comes through leaves, and they shade one another
        direct = (0.75 * max(facing, 0.0) + 0.25 * (0.5 - 0.5 * facing)) * sunny
    upward = 0.5 + 0.5 * nz
    across = nx * dx + ny * dy + nz * dz
    rx, ry, rz = dx - 2.0 * across * nx, dy - 2.0 * across * ny, dz - 2.0 * across * nz
    near_r, near_g, near_b, glint = _lamplight(spot, rx, ry, rz, grid)
    red = spot.red * (direct * air.sun[0] + air.below[0] + upward * (air.above[0] - air.below[0]) + near_r)
    green = spot.green * (direct * air.sun[1] + air.below[1] + upward * (air.above[1] - air.below[1]) + near_g)
    blue = spot.blue * (direct * air.sun[2] + air.below[2] + upward * (air.above[2] - air.below[2]) + near_b)
    if spot.gloss > 0.0:  # Schlick 1994, "An Inexpensive BRDF Model", eq. 15
        share = spot.gloss * (0.10 + 0.90 * max(1.0 + across, 0.0) ** 5)
        if rz > 0.0:
            sr, sg, sb = clear_sky(rx, ry, rz, air)
            low = ramp(0.0, 0.25, rz)  # near the horizon stand houses and trees
            sr, sg, sb = (
                sr * (0.45 + 0.55 * low),
                sg * (0.45 + 0.55 * low),
                sb * (0.45 + 0.55 * low),
            )
        else:
            sr, sg, sb = air.below[0] * 1.6, air.below[1] * 1.6, air.below[2] * 1.6
        sr, sg, sb = min(sr, 3.0), min(sg, 3.0), min(sb, 3.0)
        red, green, blue = red + (sr - red) * share, green + (sg - green) * share, blue + (sb - blue) * share
        mirrored = rx * air.sun_x + ry * air.sun_y + rz * air.sun_z
        flash = spot.gloss * (1.6 * max(mirrored, 0.0) ** 200 * sunny)
        red, green, blue = (
            red + flash * air.sun[0] + spot.gloss * glint,
            green + flash * air.sun[1] + 0.95 * spot.gloss * glint,
            blue + flash * air.sun[2] + 0.85 * spot.gloss * glint,
        )
    return red + spot.shine * spot.red, green + spot.shine * spot.green, blue + spot.shine * spot.blue


@shading_part
def _clear(distance_m: float, rise: float, air: Air) -> float:
    """Return how much light comes through the air on a way that rises by ``rise`` a metre; fog thins with height."""
    way = max(distance_m - air.fog_from_m, 0.0)
    climb = air.fog_falls_per_m * rise * way
    if abs(climb) > 1e-4:
        way *= (1.0 - math.exp(-min(max(climb, -30.0), 30.0))) / climb
    return math.exp(-air.fog_per_m * way)


_SKY_M = 20000.0
"""A way through the air to where there is none left."""

Shade = Callable[[Rays, Hits, F32, float, Faces, Relief, Places, F32, Air, LampGrid, F32, int, int], None]


def _build(built_of: int) -> Shade:
    """Compile the kernel; ``built_of`` is in its closure, so that it is renewed with the parts it is made of."""

    @shading
    def shade(
        rays: Rays, hits: Hits, sunny: F32, pixel_rad: float, faces: Faces, relief: Relief, places: Places, shine: F32,
        air: Air, grid: LampGrid, light: F32, start: int, stop: int,
    ) -> None:  # fmt: skip
        if built_of < 0:
            return
        for i in range(start, stop):
            dx, dy, dz = (
                np.float64(rays.direction[i, 0]),
                np.float64(rays.direction[i, 1]),
                np.float64(rays.direction[i, 2]),
            )
            instance = hits.instance[i]
            if instance == NOTHING:
                red, green, blue = sky(dx, dy, dz, air)
                kept = _clear(_SKY_M, max(dz, 0.0), air)
            else:
                far = np.float64(hits.distance_m[i])
                x, y, z = (
                    rays.origin_m[i, 0] + far * dx,
                    rays.origin_m[i, 1] + far * dy,
                    rays.origin_m[i, 2] + far * dz,
                )
                nx, ny, nz = (
                    np.float64(hits.normal[i, 0]),
                    np.float64(hits.normal[i, 1]),
                    np.float64(hits.normal[i, 2]),
                )
                face = places.first[instance + 1] + hits.triangle[i]
                slant = max(abs(nx * dx + ny * dy + nz * dz), 0.08)
                pixel_m = far * pixel_rad / math.sqrt(slant)
                spot = _spot(
                    x, y, z, dx, dy, dz, nx, ny, nz, pixel_m, instance + 1, face, faces, relief, places, shine, air
                )
                red, green, blue = _lit(spot, dx, dy, dz, np.float64(sunny[i]), faces.material[face], air, grid)
                kept = _clear(far, dz, air)
            light[i, 0] = air.fog[0] + (red - air.fog[0]) * kept
            light[i, 1] = air.fog[1] + (green - air.fog[1]) * kept
            light[i, 2] = air.fog[2] + (blue - air.fog[2]) * kept

    return shade


_PARTS = ("atmosphere", "lamps", "noise", "patterns", "relief", "shade", "sky")
_shade = _build(fingerprint(*(_HERE / f"{name}.py" for name in _PARTS)))


def shaded(
    rays: Rays, hits: Hits, sunny: F32, pixel_rad: float, faces: Faces, relief: Relief, places: Places, air: Air,
    grid: LampGrid,
) -> F32:  # fmt: skip
    """Return the light (N, 3) that comes along each ray; ``sunny`` (N,) is the share of the sun that each hit sees."""
    light = np.empty((len(sunny), 3), np.float32)

    def work(start: int, stop: int) -> None:
        _shade(rays, hits, sunny, pixel_rad, faces, relief, places, SHINE, air, grid, light, start, stop)

    in_stretches(len(light), work, multiple=16)
    return light
