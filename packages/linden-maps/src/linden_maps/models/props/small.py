"""Small props, each about as large as (length, width, height) in m and standing at the origin."""

import math
from collections.abc import Callable

from linden.scenery.mesh import Material, Mesh
from linden_maps.models.fittings import ABOUT_Y, hoop
from linden_maps.models.solids import (
    BLACK,
    GLASS,
    STEEL,
    FaceLook,
    ball,
    both_sides,
    box,
    lathe,
    moved,
    rod,
    stretched,
    tube,
    turned,
    wedge,
)

Model = Callable[[float, float, float], list[Mesh]]
Colour = tuple[int, int, int]

_CARDBOARD = FaceLook(Material.PLAIN, (170, 132, 88))
_TAPE = FaceLook(Material.PLAIN, (200, 176, 132))
_HAY = FaceLook(Material.GRASS, (196, 168, 88))
_BOARD = FaceLook(Material.WOOD, (120, 110, 100))
_ORANGE = FaceLook(Material.PLAIN, (220, 96, 28))
_WHITE = FaceLook(Material.SIGN_FACE, (232, 232, 226))


def cube(length: float, width: float, height: float) -> list[Mesh]:
    """Return a plain box: the stand-in for a mesh of Unreal's that is not available."""
    return [
        box(
            (-0.5 * length, -0.5 * width, 0.0),
            (0.5 * length, 0.5 * width, height),
            FaceLook(Material.PLAIN, (150, 150, 150)),
        )
    ]


def boards(length: float, width: float, height: float) -> list[Mesh]:
    """Return flat boards, one over the other."""
    return [
        box((-0.5 * length, -0.5 * width, 0.0), (0.5 * length, 0.35 * width, 0.6 * height), _BOARD),
        box((-0.4 * length, -0.1 * width, 0.4 * height), (0.45 * length, 0.5 * width, height), _BOARD),
    ]


def cardboard(*, open_lid: bool) -> Model:
    """Return the model of a cardboard box, its flaps up where it is open."""

    def make(length: float, width: float, height: float) -> list[Mesh]:
        x, y, top = 0.5 * length, 0.5 * width, height * (0.72 if open_lid else 1.0)
        body = box((-x, -y, 0.0), (x, y, top), _CARDBOARD)
        if not open_lid:
            return [body, box((-0.06 * length, -y, top - 0.01), (0.06 * length, y, top + 0.002), _TAPE)]
        flaps = [
            wedge(
                (-x, -0.9 * y, top),
                (-x + 0.02, 0.9 * y, height),
                _CARDBOARD,
                top_x=(-x - 0.1 * length, -x - 0.08 * length),
            )
        ]
        flaps.append(
            wedge(
                (x - 0.02, -0.9 * y, top), (x, 0.9 * y, height), _CARDBOARD, top_x=(x + 0.08 * length, x + 0.1 * length)
            )
        )
        inside = box((-0.94 * x, -0.94 * y, top - 0.01), (0.94 * x, 0.94 * y, top + 0.003), BLACK)
        return [body, inside, *flaps]

    return make


def barrel(length: float, width: float, height: float) -> list[Mesh]:
    """Return a traffic barrel: orange with white bands."""
    radius, share = 0.5 * max(length, width), (0.0, 0.08, 0.28, 0.42, 0.62, 0.76, 0.97, 1.0)
    looks = [BLACK, _ORANGE, _WHITE, _ORANGE, _WHITE, _ORANGE, _ORANGE]
    widths = (1.0, 0.96, 0.94, 0.92, 0.9, 0.88, 0.86, 0.7)
    return [lathe([height * s for s in share], [radius * w for w in widths], 16, looks)]


def can(colour: Colour) -> Model:
    """Return the model of a drink's can."""

    def make(length: float, width: float, height: float) -> list[Mesh]:
        radius, paint = 0.25 * (length + width), FaceLook(Material.METAL, colour)
        heights = [0.0, 0.06 * height, 0.94 * height, height]
        return [lathe(heights, [0.85 * radius, radius, radius, 0.8 * radius], 12, [STEEL, paint, STEEL])]

    return make


def helmet(colour: Colour) -> Model:
    """Return the model of a helmet with a visor."""

    def make(length: float, width: float, height: float) -> list[Mesh]:
        shell = ball(
            (0.0, 0.0, 0.5 * height),
            (0.5 * length, 0.5 * width, 0.5 * height),
            FaceLook(Material.CAR_PAINT, colour),
            sides=12,
        )
        visor = ball((0.04 * length, 0.0, 0.5 * height), (0.48 * length, 0.42 * width, 0.22 * height), GLASS, sides=12)
        return [shell, visor]

    return make


def case(colour: Colour) -> Model:
    """Return the model of a case that stands on its long side."""

    def make(length: float, width: float, height: float) -> list[Mesh]:
        x, y = 0.5 * length, 0.5 * width
        handle = tube(
            [
                (-0.12 * length, 0.0, 0.9 * height),
                (-0.1 * length, 0.0, height),
                (0.1 * length, 0.0, height),
                (0.12 * length, 0.0, 0.9 * height),
            ],
            [0.02 * length] * 4,
            5,
            BLACK,
        )
        return [
            box((-x, -y, 0.0), (x, y, 0.92 * height), FaceLook(Material.CLOTH, colour)),
            box((-x - 0.002, -0.06 * width, 0.02), (x + 0.002, 0.06 * width, 0.9 * height), STEEL),
            handle,
        ]

    return make


def bag(colour: Colour, *, handles: bool) -> Model:
    """Return the model of a soft bag, with handles or tied up."""

    def make(length: float, width: float, height: float) -> list[Mesh]:
        look, full = FaceLook(Material.CLOTH, colour), height * (0.7 if handles else 0.82)
        heights = [0.0, 0.06 * full, 0.4 * full, 0.8 * full, full]
        unit = lathe(heights, [0.7, 0.95, 1.0, 0.85, 0.6 if handles else 0.18], 10, look)
        body = stretched(unit, (0.5 * length, 0.5 * width, 1.0))
        if not handles:
            return [body, lathe([full - 0.02, height], [0.05 * length, 0.14 * length], 6, look)]
        x = 0.3 * length
        loops = [
            [(-x, y, 0.95 * full), (-0.6 * x, y, height), (0.6 * x, y, height), (x, y, 0.95 * full)]
            for y in (-0.2 * width, 0.2 * width)
        ]
        return [body, *(tube(loop, [0.018 * height] * 4, 5, look) for loop in loops)]

    return make


def heap(colour: Colour) -> Model:
    """Return the model of a low heap of lumps and scraps."""

    def make(length: float, width: float, height: float) -> list[Mesh]:
        look, scrap = FaceLook(Material.GRAVEL, colour), FaceLook(Material.PLAIN, (90, 84, 78))
        unit = lathe([0.0, 0.35 * height, 0.8 * height], [1.0, 0.7, 0.25], 9, look)
        lumps = [stretched(unit, (0.5 * length, 0.5 * width, 1.0))]
        for n in range(5):
            angle, size = 2.4 * n, 0.12 + 0.03 * (n % 3)
            place = (0.28 * length * math.cos(angle), 0.28 * width * math.sin(angle), 0.5 * height)
            lumps.append(
                ball(place, (size * length, size * width, 0.5 * height), scrap if n % 2 else look, sides=6, bands=4)
            )
        return lumps

    return make


def hay(length: float, width: float, height: float) -> list[Mesh]:
    """Return a round bale."""
    drum = lathe([-0.5 * width, 0.5 * width], [0.5 * height, 0.5 * height], 18, _HAY)
    lying = stretched(drum, (length / height, 1.0, 1.0))
    return [moved(turned(lying, ABOUT_Y), (0.0, 0.0, 0.5 * height))]


def shopping_cart(length: float, width: float, height: float) -> list[Mesh]:
    """Return a cart of wire with four wheels, its handle behind."""
    x, y, floor = 0.5 * length, 0.5 * width, 0.42 * height
    wires = [
        rod((s * x, -0.9 * y, z), (s * x, 0.95 * y, z), 0.012, STEEL, sides=4)
        for s in (-1.0, 1.0)
        for z in (floor, 0.6 * height, 0.85 * height)
    ]
    for n in range(7):
        at = y * (-0.9 + 0.3 * n)
        wires += [rod((s * x, at, floor), (s * x, at, 0.85 * height), 0.006, STEEL, sides=3) for s in (-1.0, 1.0)]
        wires.append(rod((-x, at, floor), (x, at, floor), 0.006, STEEL, sides=3))
    wires += [rod((s * x, -0.8 * y, 0.1), (s * x, -y, height), 0.014, STEEL, sides=4) for s in (-1.0, 1.0)]
    wires.append(rod((-x, -y, height - 0.015), (x, -y, height - 0.015), 0.018, BLACK))
    wires.append(box((-x, -0.8 * y, 0.12), (x, 0.9 * y, 0.15), STEEL))
    wheel = hoop(0.05, 0.018, BLACK)
    return [*wires, *(moved(wheel, (s * 0.85 * x, t * 0.75 * y, 0.07)) for s in (-1.0, 1.0) for t in (-1.0, 1.0))]


def trolley(colour: Colour) -> Model:
    """Return the model of a case on two wheels with a handle pulled out."""

    def make(length: float, width: float, height: float) -> list[Mesh]:
        x, y, top = 0.5 * length, 0.5 * width, 0.7 * height
        body = box((-x, -y, 0.06), (x, 0.9 * y, top), FaceLook(Material.CLOTH, colour))
        ribs = [box((s * x - 0.02, -y, 0.1), (s * x + 0.02, y, 0.95 * top), BLACK) for s in (-0.5, 0.0, 0.5)]
        bars = both_sides(rod((0.5 * x, 0.8 * y, 0.9 * top), (0.5 * x, 0.8 * y, height), 0.01, STEEL, sides=4))
        grip = rod((0.5 * x, -0.85 * y, height - 0.012), (0.5 * x, 0.85 * y, height - 0.012), 0.015, BLACK)
        wheels = [moved(hoop(0.04, 0.018, BLACK), (0.8 * x, s * 0.8 * y, 0.055)) for s in (-1.0, 1.0)]
        return [body, *ribs, *bars, grip, *wheels]

    return make
