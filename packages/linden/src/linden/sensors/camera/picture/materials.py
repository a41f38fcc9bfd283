"""The loops that give spots of each material its pattern and turn them to the eye."""

from collections.abc import Callable

from linden.compiled import shading_stage
from linden.sensors.camera.picture.fields import (
    BLUE,
    BX,
    BY,
    BZ,
    DX,
    DY,
    DZ,
    FX,
    FY,
    FZ,
    GLOSS,
    GREEN,
    NX,
    NY,
    NZ,
    PIXEL,
    RED,
)
from linden.sensors.camera.picture.patterns import (
    ASPHALT,
    BARK,
    BRICK,
    CLOTH,
    CONCRETE,
    GRASS,
    GRAVEL,
    LEAVES,
    PAINT,
    SHINGLES,
    SIDING,
    WOOD,
    SpotLook,
    asphalt,
    bark,
    brick,
    cloth,
    concrete,
    gloss_of,
    grass,
    gravel,
    leaves,
    paint,
    shingles,
    siding,
    wood,
)  # fmt: skip
from linden.sensors.camera.picture.surface_points import Floats, facing


def _dressing(look_of: Callable[..., SpotLook]) -> Callable[[Floats, int], None]:
    """Return the loop that gives spots of one material its pattern."""

    @shading_stage
    def loop(f: Floats, count: int) -> None:
        for k in range(count):
            look = look_of(f[BX + k], f[BY + k], f[BZ + k], f[FX + k], f[FY + k], f[FZ + k], f[PIXEL + k])
            f[RED + k], f[GREEN + k], f[BLUE + k] = (
                f[RED + k] * look.red,
                f[GREEN + k] * look.green,
                f[BLUE + k] * look.blue,
            )
            f[GLOSS + k] = look.gloss
            f[NX + k], f[NY + k], f[NZ + k] = facing(
                f[NX + k], f[NY + k], f[NZ + k], f[DX + k], f[DY + k], f[DZ + k], look.bend
            )

    return loop


@shading_stage
def _even(gloss: float, f: Floats, count: int) -> None:
    """Dress spots that have no pattern."""
    for k in range(count):
        f[GLOSS + k] = gloss
        f[NX + k], f[NY + k], f[NZ + k] = facing(f[NX + k], f[NY + k], f[NZ + k], f[DX + k], f[DY + k], f[DZ + k], 0.0)


_dress_asphalt, _dress_concrete, _dress_paint, _dress_gravel, _dress_grass, _dress_leaves = map(
    _dressing, (asphalt, concrete, paint, gravel, grass, leaves)
)
_dress_bark, _dress_brick, _dress_siding, _dress_shingles, _dress_wood, _dress_cloth = map(
    _dressing, (bark, brick, siding, shingles, wood, cloth)
)


@shading_stage
def dress(  # noqa: C901, PLR0912 - one line for each material
    material: int, f: Floats, count: int
) -> None:
    """Give spots of one material its pattern."""
    if material == ASPHALT:
        _dress_asphalt(f, count)
    elif material == CONCRETE:
        _dress_concrete(f, count)
    elif material == PAINT:
        _dress_paint(f, count)
    elif material == GRAVEL:
        _dress_gravel(f, count)
    elif material == GRASS:
        _dress_grass(f, count)
    elif material == LEAVES:
        _dress_leaves(f, count)
    elif material == BARK:
        _dress_bark(f, count)
    elif material == BRICK:
        _dress_brick(f, count)
    elif material == SIDING:
        _dress_siding(f, count)
    elif material == SHINGLES:
        _dress_shingles(f, count)
    elif material == WOOD:
        _dress_wood(f, count)
    elif material == CLOTH:
        _dress_cloth(f, count)
    else:
        _even(gloss_of(material), f, count)
