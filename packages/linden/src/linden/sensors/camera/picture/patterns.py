"""Patterns of surfaces seen from near: bricks, boards, grass, asphalt, by the place on the surface alone.

A pattern is seen until its parts are smaller than a pixel; ``near`` (1 at hand, 0 far off) fades it before that.
"""

import math
from typing import NamedTuple

from linden.compiled import shading_part
from linden.scenery.mesh import Material
from linden.sensors.camera.picture.texture_noise import fraction, hashed, narrow, smooth_noise, whole

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

WETTED = (ASPHALT, CONCRETE, PAINT, GRAVEL)
"""What becomes dark and smooth in the rain."""


class SpotLook(NamedTuple):
    """How a spot differs from its face's colour: factors of the colour, gloss (0 to 1), and a bend of the normal."""

    red: float
    green: float
    blue: float
    gloss: float
    bend: float


@shading_part
def gloss_of(material: int) -> float:
    """Return how smooth a dry material is."""
    if material == GLASS:
        return 0.75
    if material == CAR_PAINT:
        return 0.42
    if material in (METAL, LAMP):
        return 0.25
    if material in (SIGN_FACE, RUBBER):
        return 0.06
    return 0.02 if material == SIDING else 0.0


@shading_part
def _seen(part_m: float, pixel_m: float) -> float:
    """Return how much of a pattern with parts of a size is visible: 1, fading to 0 where a pixel is as large."""
    return min(max(1.5 - 2.0 * pixel_m / part_m, 0.0), 1.0)


@shading_part
def _fine(x: float, y: float, pixel_m: float) -> float:
    """Return patches of half a metre, 0 to 1."""
    return smooth_noise(1.4 * x, 1.4 * y, 2) if pixel_m < 1.0 else 0.5


@shading_part
def _grain(x: float, y: float, pixel_m: float) -> float:
    """Return grains of a decimetre, -0.5 to 0.5."""
    return (smooth_noise(11.0 * x, 11.0 * y, 3) - 0.5) * _seen(0.15, pixel_m)


@shading_part
def _stones(x: float, y: float, pixel_m: float) -> float:
    """Return stones of a centimetre, -0.5 to 0.5."""
    return (hashed(whole(70.0 * x), whole(70.0 * y), 4) - 0.5) * _seen(0.02, pixel_m)


@shading_part
def asphalt(x: float, y: float, _z: float, _nx: float, _ny: float, _nz: float, pixel_m: float) -> SpotLook:
    """Return the look of a road; see :func:`look_of`."""
    k = 0.80 + 0.22 * smooth_noise(0.23 * x, 0.23 * y, 1) + 0.16 * _fine(x, y, pixel_m)
    k += 0.30 * (_grain(x, y, pixel_m) + _stones(x, y, pixel_m))
    return SpotLook(k, k, 1.02 * k, 0.0, 0.0)


@shading_part
def concrete(x: float, y: float, _z: float, _nx: float, _ny: float, _nz: float, pixel_m: float) -> SpotLook:
    """Return the look of a pavement; see :func:`look_of`."""
    k = 0.86 + 0.14 * smooth_noise(0.23 * x, 0.23 * y, 1) + 0.10 * _fine(x, y, pixel_m)
    k += 0.14 * _grain(x, y, pixel_m) + 0.06 * _stones(x, y, pixel_m)
    return SpotLook(k, k, 0.985 * k, 0.0, 0.0)


@shading_part
def paint(x: float, y: float, _z: float, _nx: float, _ny: float, _nz: float, pixel_m: float) -> SpotLook:
    """Return the look of paint on a road, worn; see :func:`look_of`."""
    k = 0.92 + 0.10 * _fine(x, y, pixel_m) + 0.16 * _grain(x, y, pixel_m)
    return SpotLook(k, k, k, 0.0, 0.0)


@shading_part
def gravel(x: float, y: float, _z: float, _nx: float, _ny: float, _nz: float, pixel_m: float) -> SpotLook:
    """Return the look of gravel; see :func:`look_of`."""
    grain = _grain(x, y, pixel_m)
    k = 0.78 + 0.2 * _fine(x, y, pixel_m) + 0.5 * grain + 0.5 * _stones(x, y, pixel_m)
    return SpotLook(k, k, k, 0.0, 0.3 * grain)


@shading_part
def grass(x: float, y: float, _z: float, _nx: float, _ny: float, _nz: float, pixel_m: float) -> SpotLook:
    """Return the look of a lawn: wide patches, tufts, blades; see :func:`look_of`."""
    wide, patch = smooth_noise(0.11 * x, 0.11 * y, 11), smooth_noise(0.7 * x, 0.7 * y, 12)
    tuft = (smooth_noise(6.0 * x, 6.0 * y, 13) - 0.5) * _seen(0.3, pixel_m)
    blade = (hashed(whole(38.0 * x), whole(38.0 * y), 14) - 0.5) * _seen(0.035, pixel_m)
    k = 0.70 + 0.26 * wide + 0.26 * patch + 0.38 * tuft + 0.34 * blade
    dry = 0.10 * (wide - 0.5) + 0.08 * patch
    return SpotLook(k * (1.0 + 1.6 * dry), k, k * (0.95 - dry), 0.0, 0.12 * tuft)


@shading_part
def leaves(x: float, y: float, z: float, _nx: float, _ny: float, _nz: float, pixel_m: float) -> SpotLook:
    """Return the look of the crown of a tree or of a hedge; see :func:`look_of`."""
    clump = smooth_noise(1.7 * (x + 0.6 * z), 1.7 * (y - 0.7 * z), 15)
    leaf = (smooth_noise(8.0 * (x + 0.7 * z), 8.0 * (y - 0.8 * z), 16) - 0.5) * _seen(0.25, pixel_m)
    speck = hashed(whole(17.0 * (x + 0.3 * z)), whole(17.0 * (y + z)), 17) - 0.5
    k = 0.62 + 0.5 * clump + 0.75 * leaf + 0.35 * speck * _seen(0.06, pixel_m)
    return SpotLook(k * (0.94 + 0.16 * clump), k, 0.9 * k, 0.0, 0.9 * (clump - 0.5) + 1.1 * leaf)


@shading_part
def bark(x: float, y: float, z: float, _nx: float, _ny: float, _nz: float, pixel_m: float) -> SpotLook:
    """Return the look of a trunk; see :func:`look_of`."""
    groove = (smooth_noise(9.0 * (x + y), 1.6 * z, 18) - 0.5) * _seen(0.12, pixel_m)
    k = 0.9 + 0.5 * groove
    return SpotLook(k, k, k, 0.0, 0.3 * groove)


@shading_part
def _along(x: float, y: float, nx: float, ny: float, nz: float) -> float:
    """Return how far to the side a place on a wall or a roof is, m."""
    if abs(nz) >= 0.999:
        return x
    return (nx * y - ny * x) / max(math.sqrt(nx * nx + ny * ny), 1e-6)


@shading_part
def brick(x: float, y: float, z: float, nx: float, ny: float, nz: float, pixel_m: float) -> SpotLook:
    """Return the look of bricks, 203 x 57 mm, joints of 10 mm, each course half a brick aside; see :func:`look_of`."""
    along = _along(x, y, nx, ny, nz)
    course = z / 0.0667
    row = whole(course)
    place = along / 0.2133 + 0.5 * narrow(row & 1)
    tone = hashed(whole(place), row, 21) - 0.5
    joint = 1.0 if course - narrow(row) < 0.15 or fraction(place) < 0.047 else 0.0
    k = 1.0 + 0.34 * tone * _seen(0.2, pixel_m) + 0.12 * (smooth_noise(0.9 * along, 0.9 * z, 22) - 0.5)
    pale = joint * _seen(0.045, pixel_m)
    return SpotLook(k * (1.0 + 0.10 * pale), k * (1.0 + 0.55 * pale), k * (1.0 + 0.8 * pale), 0.0, 0.0)


@shading_part
def shingles(x: float, y: float, z: float, nx: float, ny: float, nz: float, pixel_m: float) -> SpotLook:
    """Return the look of a roof of shingles; see :func:`look_of`."""
    along = _along(x, y, nx, ny, nz)
    course = z / 0.115
    row = whole(course)
    tone = hashed(whole(along / 0.3 + hashed(row, 7, 23)), row, 24) - 0.5
    edge = 0.25 * max(0.0, 1.0 - (course - narrow(row)) / 0.18) * _seen(0.09, pixel_m)
    k = 1.0 + 0.30 * tone * _seen(0.25, pixel_m) - edge + 0.10 * (smooth_noise(along, z, 25) - 0.5)
    return SpotLook(k, k, k, 0.0, 0.0)


@shading_part
def siding(x: float, y: float, z: float, nx: float, ny: float, nz: float, pixel_m: float) -> SpotLook:
    """Return the look of painted boards that lie over one another; see :func:`look_of`."""
    along, board = _along(x, y, nx, ny, nz), z / 0.15
    number, seen = whole(board), _seen(0.15, pixel_m)
    below = board - narrow(number)
    tone = 0.05 * (hashed(number, whole(along / 3.6), 26) - 0.5)
    k = 1.0 + seen * (tone - 0.30 * max(0.0, 1.0 - below / 0.10) + 0.05 * below)
    k += 0.06 * (smooth_noise(0.8 * along, 2.0 * z, 27) - 0.5)
    return SpotLook(k, k, k, gloss_of(SIDING), 0.18 * seen * (below - 0.5))


@shading_part
def wood(x: float, y: float, z: float, nx: float, ny: float, nz: float, pixel_m: float) -> SpotLook:
    """Return the look of planks side by side; see :func:`look_of`."""
    along = _along(x, y, nx, ny, nz)
    plank = along / 0.11
    number, seen = whole(plank), _seen(0.11, pixel_m)
    below = plank - narrow(number)
    tone = 0.22 * (hashed(number, whole(along / 3.6), 26) - 0.5)
    k = 1.0 + seen * (tone - 0.30 * max(0.0, 1.0 - below / 0.10) + 0.05 * below)
    k += 0.06 * (smooth_noise(0.8 * along, 2.0 * z, 27) - 0.5)
    return SpotLook(k, k, k, 0.0, 0.0)


@shading_part
def cloth(x: float, y: float, z: float, _nx: float, _ny: float, _nz: float, pixel_m: float) -> SpotLook:
    """Return the look of cloth; see :func:`look_of`."""
    k = 0.92 + 0.16 * smooth_noise(9.0 * x + 3.0 * z, 9.0 * y + 7.0 * z, 31) * _seen(0.1, pixel_m)
    return SpotLook(k, k, k, 0.0, 0.0)


@shading_part
def look_of(  # noqa: C901, PLR0911 - one return for each material
    material: int, x: float, y: float, z: float, nx: float, ny: float, nz: float, pixel_m: float
) -> SpotLook:
    """Return the look of a spot: place in m and normal in the frame of its body, ``pixel_m`` the size of a pixel."""
    if material == ASPHALT:
        return asphalt(x, y, z, nx, ny, nz, pixel_m)
    if material == CONCRETE:
        return concrete(x, y, z, nx, ny, nz, pixel_m)
    if material == PAINT:
        return paint(x, y, z, nx, ny, nz, pixel_m)
    if material == GRAVEL:
        return gravel(x, y, z, nx, ny, nz, pixel_m)
    if material == GRASS:
        return grass(x, y, z, nx, ny, nz, pixel_m)
    if material == LEAVES:
        return leaves(x, y, z, nx, ny, nz, pixel_m)
    if material == BARK:
        return bark(x, y, z, nx, ny, nz, pixel_m)
    if material == BRICK:
        return brick(x, y, z, nx, ny, nz, pixel_m)
    if material == SIDING:
        return siding(x, y, z, nx, ny, nz, pixel_m)
    if material == SHINGLES:
        return shingles(x, y, z, nx, ny, nz, pixel_m)
    if material == WOOD:
        return wood(x, y, z, nx, ny, nz, pixel_m)
    if material == CLOTH:
        return cloth(x, y, z, nx, ny, nz, pixel_m)
    return SpotLook(1.0, 1.0, 1.0, gloss_of(material), 0.0)
