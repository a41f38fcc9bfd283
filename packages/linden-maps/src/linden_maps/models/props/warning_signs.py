"""Props to be heeded, each about as large as (length, width, height) in m and standing at the origin."""

from collections.abc import Callable

from linden.scenery.mesh import LampOf, Material, Mesh
from linden_maps.models.fittings import hoop
from linden_maps.models.solids import BLACK, RUBBER, STEEL, FaceLook, ball, box, lathe, moved, prism, rod

Model = Callable[[float, float, float], list[Mesh]]
Colour = tuple[int, int, int]

_ORANGE = FaceLook(Material.PLAIN, (226, 92, 22))
_WHITE = FaceLook(Material.SIGN_FACE, (234, 234, 228))
_RED = FaceLook(Material.SIGN_FACE, (190, 24, 28))
_YELLOW = FaceLook(Material.SIGN_FACE, (240, 180, 30))
_GREEN = FaceLook(Material.SIGN_FACE, (20, 100, 70))
_WOOD = FaceLook(Material.WOOD, (126, 88, 56))
_STONE = FaceLook(Material.CONCRETE, (160, 158, 152))
_IRON = FaceLook(Material.METAL, (58, 60, 62))


def cone(length: float, width: float, height: float) -> list[Mesh]:
    """Return a traffic cone on a square foot, with two white bands."""
    foot, r = 0.05 * height, 0.36 * min(length, width)
    share, radii = (0.0, 0.3, 0.5, 0.65, 0.8, 1.0), (1.0, 0.76, 0.6, 0.48, 0.36, 0.2)
    looks = [_ORANGE, _WHITE, _ORANGE, _WHITE, _ORANGE]
    body = lathe([foot + (height - foot) * s for s in share], [r * k for k in radii], 16, looks)
    return [box((-0.5 * length, -0.5 * width, 0.0), (0.5 * length, 0.5 * width, foot), RUBBER), body]


def barrier(length: float, width: float, height: float) -> list[Mesh]:
    """Return a barrier: a striped board on two stands."""
    x, y = 0.5 * length, 0.5 * width
    made: list[Mesh] = []
    for at in (-0.75 * x, 0.75 * x):
        made.append(box((at - 0.03, -0.02, 0.0), (at + 0.03, 0.02, height), _ORANGE))
        made.append(box((at - 0.05, -y, 0.0), (at + 0.05, y, 0.05), _ORANGE))
    stripes = 8
    for low, high in ((0.66, 0.96), (0.28, 0.46)):
        for n in range(stripes):
            start = -x + n * length / stripes
            look = _RED if n % 2 else _WHITE
            made.append(box((start, -0.035, low * height), (start + length / stripes, 0.035, high * height), look))
    return made


def advertisement(length: float, width: float, height: float) -> list[Mesh]:
    """Return a poster case on a foot, a picture on either side."""
    x, y = 0.5 * length, 0.5 * width
    frame = box((-x, -0.6 * y, 0.2 * height), (x, 0.6 * y, height), _IRON)
    poster = box(
        (-0.88 * x, -0.66 * y, 0.28 * height),
        (0.88 * x, 0.66 * y, 0.94 * height),
        FaceLook(Material.SIGN_FACE, (196, 202, 190)),
    )
    picture = box(
        (-0.7 * x, -0.7 * y, 0.45 * height),
        (0.7 * x, 0.7 * y, 0.85 * height),
        FaceLook(Material.SIGN_FACE, (60, 120, 150)),
    )
    foot = [
        box((-0.5 * x, -y, 0.0), (0.5 * x, y, 0.04 * height), _STONE),
        box((-0.3 * x, -0.4 * y, 0.0), (0.3 * x, 0.4 * y, 0.22 * height), _IRON),
    ]
    return [frame, poster, picture, *foot]


def map_table(length: float, width: float, height: float) -> list[Mesh]:
    """Return a slanted board with a map on two legs."""
    x, y = 0.5 * length, 0.5 * width
    legs = [
        box((s * 0.8 * x - 0.04, -0.3 * y, 0.0), (s * 0.8 * x + 0.04, 0.3 * y, 0.8 * height), _WOOD)
        for s in (-1.0, 1.0)
    ]
    board = prism([(-y, 0.95 * height), (y, 0.68 * height), (y, 0.74 * height), (-y, height)], -x, x, _WOOD, along=0)
    paper = prism(
        [(-0.9 * y, 0.96 * height), (0.9 * y, 0.7 * height), (0.9 * y, 0.76 * height), (-0.9 * y, 1.0 * height)],
        -0.9 * x,
        0.9 * x,
        FaceLook(Material.SIGN_FACE, (200, 208, 176)),
        along=0,
    )
    return [*legs, board, paper]


def sign_board(length: float, width: float, height: float) -> list[Mesh]:
    """Return a green board on two posts."""
    x = 0.5 * length
    posts = [rod((s * 0.7 * x, 0.0, 0.0), (s * 0.7 * x, 0.0, height), 0.3 * width, STEEL, sides=8) for s in (-1.0, 1.0)]
    board = box((-x, -0.5 * width, 0.6 * height), (x, -0.1 * width, height), _GREEN)
    lines = [
        box((-0.8 * x, -0.52 * width, z * height), (end * x, -0.45 * width, (z + 0.05) * height), _WHITE)
        for z, end in ((0.86, 0.6), (0.75, 0.2), (0.66, 0.75))
    ]
    return [*posts, board, *lines]


def warning_sign(length: float, width: float, height: float) -> list[Mesh]:
    """Return a warning sign: a red and white triangle on a stand of three legs."""
    x, y = 0.5 * length, 0.5 * width
    legs = [rod((s * 0.7 * x, y - 0.02, 0.0), (0.0, 0.1 * y, 0.6 * height), 0.02, STEEL) for s in (-1.0, 1.0)]
    legs.append(rod((0.0, -y + 0.02, 0.0), (0.0, 0.1 * y, 0.6 * height), 0.02, STEEL))
    triangle = prism([(-x, 0.4 * height), (x, 0.4 * height), (0.0, height)], 0.1 * y, 0.1 * y + 0.04, _RED, along=1)
    inner = prism(
        [(-0.66 * x, 0.46 * height), (0.66 * x, 0.46 * height), (0.0, 0.88 * height)],
        0.1 * y - 0.004,
        0.1 * y + 0.044,
        _WHITE,
        along=1,
    )
    mark = [
        box((-0.05, 0.1 * y - 0.008, z0 * height), (0.05, 0.1 * y + 0.048, z1 * height), BLACK)
        for z0, z1 in ((0.5, 0.54), (0.57, 0.74))
    ]
    return [*legs, triangle, inner, *mark]


def arrow_board(length: float, width: float, height: float) -> list[Mesh]:
    """Return a trailer with a board of lamps in the shape of an arrow."""
    x, y = 0.5 * length, 0.5 * width
    lamp = FaceLook(Material.LAMP, (240, 190, 40), LampOf.BEACON)
    board = box((-x, -0.06, 0.52 * height), (x, 0.06, height), BLACK)
    dots = [(-0.8 + 0.2 * n, 0.76) for n in range(8)] + [(0.45, 0.86), (0.6, 0.81), (0.45, 0.66), (0.6, 0.71)]
    lamps = [ball((k * x, -0.06, z * height), (0.07, 0.03, 0.07), lamp, sides=6, bands=4) for k, z in dots]
    frame = [
        box((-0.6 * x, -0.7 * y, 0.4), (0.6 * x, y, 0.55), _YELLOW),
        rod((0.0, 0.0, 0.5), (0.0, 0.0, 0.6 * height), 0.07, STEEL),
    ]
    wheels = [moved(hoop(0.28, 0.08, BLACK), (s * 0.75 * x, 0.0, 0.36)) for s in (-1.0, 1.0)]
    return [board, *lamps, *frame, *wheels, rod((0.0, -y, 0.42), (0.0, -0.5 * y, 0.46), 0.05, STEEL)]
