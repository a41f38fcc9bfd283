"""What surfaces look like from near: bricks, boards, grass, asphalt, by the place on the surface alone.

A pattern is seen until its parts are smaller than a pixel; ``near`` (1 at hand, 0 far off) fades it before that.
"""

import math
from typing import NamedTuple

from linden.compiled import shading_part
from linden.meshes.mesh import Material
from linden.sensors.camera.picture.noise import fraction, hashed, smooth_noise

ASPHALT, CONCRETE, PAINT, GRASS = (
    int(Material.ASPHALT),
    int(Material.CONCRETE),
    int(Material.PAINT),
    int(Material.GRASS),
)
LEAVES, BARK, BRICK, SIDING = int(Material.LEAVES), int(Material.BARK), int(Material.BRICK), int(Material.SIDING)
SHINGLES, GLASS, CAR_PAINT, METAL = (
    int(Material.SHINGLES), int(Material.GLASS), int(Material.CAR_PAINT), int(Material.METAL),
)  # fmt: skip
GRAVEL, WOOD, SIGN_FACE, LAMP = int(Material.GRAVEL), int(Material.WOOD), int(Material.SIGN_FACE), int(Material.LAMP)
CLOTH, RUBBER = int(Material.CLOTH), int(Material.RUBBER)


class Look(NamedTuple):
    """How a spot differs from its face's colour: factors of the colour, gloss (0 to 1), and a bend of the normal."""

    red: float
    green: float
    blue: float
    gloss: float
    bend: float


@shading_part
def look_of(material: int, x: float, y: float, z: float, nx: float, ny: float, nz: float, pixel_m: float) -> Look:
    """Return the look of a spot: place in m and normal in the frame of its body, ``pixel_m`` the size of a pixel."""
    if material in (ASPHALT, CONCRETE, PAINT, GRAVEL):
        return _ground(material, x, y, pixel_m)
    if material in (GRASS, LEAVES, BARK):
        return _grown(material, x, y, z, pixel_m)
    if material in (BRICK, SIDING, SHINGLES, WOOD):
        along = (nx * y - ny * x) / max(math.sqrt(nx * nx + ny * ny), 1e-6) if abs(nz) < 0.999 else x
        return _built(material, along, z, pixel_m)
    gloss = 0.0
    if material == GLASS:
        gloss = 0.75
    elif material == CAR_PAINT:
        gloss = 0.42
    elif material in (METAL, LAMP):
        gloss = 0.25
    elif material in (SIGN_FACE, RUBBER):
        gloss = 0.06
    elif material == CLOTH:
        k = 0.92 + 0.16 * smooth_noise(9.0 * x + 3.0 * z, 9.0 * y + 7.0 * z, 31) * _seen(0.1, pixel_m)
        return Look(k, k, k, 0.0, 0.0)
    return Look(1.0, 1.0, 1.0, gloss, 0.0)


@shading_part
def _seen(part_m: float, pixel_m: float) -> float:
    """Return how much of a pattern is seen whose parts have a size: 1, fading to 0 where a pixel is as large."""
    return min(max(1.5 - 2.0 * pixel_m / part_m, 0.0), 1.0)


@shading_part
def _ground(material: int, x: float, y: float, pixel_m: float) -> Look:
    fine = smooth_noise(1.4 * x, 1.4 * y, 2) if pixel_m < 1.0 else 0.5
    grain = (smooth_noise(11.0 * x, 11.0 * y, 3) - 0.5) * _seen(0.15, pixel_m) if pixel_m < 0.11 else 0.0
    stones = 0.0
    if pixel_m < 0.015:
        stones = (hashed(math.floor(70.0 * x), math.floor(70.0 * y), 4) - 0.5) * _seen(0.02, pixel_m)
    if material == PAINT:
        worn = 0.92 + 0.10 * fine + 0.16 * grain
        return Look(worn, worn, worn, 0.0, 0.0)
    if material == GRAVEL:
        k = 0.78 + 0.2 * fine + 0.5 * grain + 0.5 * stones
        return Look(k, k, k, 0.0, 0.3 * grain)
    wide = smooth_noise(0.23 * x, 0.23 * y, 1)
    if material == CONCRETE:
        k = 0.86 + 0.14 * wide + 0.10 * fine + 0.14 * grain + 0.06 * stones
        return Look(k, k, 0.985 * k, 0.0, 0.0)
    k = 0.80 + 0.22 * wide + 0.16 * fine + 0.30 * grain + 0.30 * stones
    return Look(k, k, 1.02 * k, 0.0, 0.0)


@shading_part
def _grown(material: int, x: float, y: float, z: float, pixel_m: float) -> Look:
    if material == GRASS:
        wide, patch = smooth_noise(0.11 * x, 0.11 * y, 11), smooth_noise(0.7 * x, 0.7 * y, 12)
        tuft = (smooth_noise(6.0 * x, 6.0 * y, 13) - 0.5) * _seen(0.3, pixel_m) if pixel_m < 0.22 else 0.0
        blade = 0.0
        if pixel_m < 0.026:
            blade = (hashed(math.floor(38.0 * x), math.floor(38.0 * y), 14) - 0.5) * _seen(0.035, pixel_m)
        k = 0.70 + 0.26 * wide + 0.26 * patch + 0.38 * tuft + 0.34 * blade
        dry = 0.10 * (wide - 0.5) + 0.08 * patch
        return Look(k * (1.0 + 1.6 * dry), k, k * (0.95 - dry), 0.0, 0.12 * tuft)
    if material == LEAVES:
        clump = smooth_noise(1.7 * (x + 0.6 * z), 1.7 * (y - 0.7 * z), 15)
        leaf, speck = 0.0, 0.0
        if pixel_m < 0.18:
            leaf = (smooth_noise(8.0 * (x + 0.7 * z), 8.0 * (y - 0.8 * z), 16) - 0.5) * _seen(0.25, pixel_m)
        if pixel_m < 0.045:
            speck = hashed(math.floor(17.0 * (x + 0.3 * z)), math.floor(17.0 * (y + z)), 17) - 0.5
            speck *= _seen(0.06, pixel_m)
        k = 0.62 + 0.5 * clump + 0.75 * leaf + 0.35 * speck
        return Look(k * (0.94 + 0.16 * clump), k, 0.9 * k, 0.0, 0.9 * (clump - 0.5) + 1.1 * leaf)
    groove = (smooth_noise(9.0 * (x + y), 1.6 * z, 18) - 0.5) * _seen(0.12, pixel_m)
    k = 0.9 + 0.5 * groove
    return Look(k, k, k, 0.0, 0.3 * groove)


@shading_part
def _built(material: int, along: float, z: float, pixel_m: float) -> Look:
    if material == BRICK:  # 203 x 57 mm with joints of 10 mm, each course half a brick aside
        row = math.floor(z / 0.0667)
        place = along / 0.2133 + 0.5 * (row % 2.0)
        tone = hashed(math.floor(place), int(row), 21) - 0.5
        joint = fraction(z / 0.0667) < 0.15 or fraction(place) < 0.047
        seen, detail = _seen(0.2, pixel_m), _seen(0.045, pixel_m)
        wide = smooth_noise(0.9 * along, 0.9 * z, 22) - 0.5
        k = 1.0 + 0.34 * tone * seen + 0.12 * wide
        if joint:
            pale = 1.0 + detail * 0.55
            return Look(k * (1.0 + 0.10 * detail), k * pale, k * (1.0 + detail * 0.8), 0.0, 0.0)
        return Look(k, k, k, 0.0, 0.0)
    if material == SHINGLES:
        row = math.floor(z / 0.115)
        place = along / 0.3 + hashed(int(row), 7, 23)
        tone = hashed(math.floor(place), int(row), 24) - 0.5
        edge = 0.25 * max(0.0, 1.0 - fraction(z / 0.115) / 0.18) * _seen(0.09, pixel_m)
        k = 1.0 + 0.30 * tone * _seen(0.25, pixel_m) - edge + 0.10 * (smooth_noise(along, z, 25) - 0.5)
        return Look(k, k, k, 0.0, 0.0)
    board_m = 0.15 if material == SIDING else 0.11
    below = fraction(z / board_m if material == SIDING else along / board_m)
    number = math.floor(z / board_m if material == SIDING else along / board_m)
    seen = _seen(board_m, pixel_m)
    tone = (hashed(int(number), math.floor(along / 3.6), 26) - 0.5) * (0.05 if material == SIDING else 0.22)
    k = 1.0 + seen * (tone - 0.30 * max(0.0, 1.0 - below / 0.10) + 0.05 * below)
    k += 0.06 * (smooth_noise(0.8 * along, 2.0 * z, 27) - 0.5)
    return Look(k, k, k, 0.02, 0.18 * seen * (below - 0.5) if material == SIDING else 0.0)
