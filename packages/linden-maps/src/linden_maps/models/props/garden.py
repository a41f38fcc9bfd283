"""Props of gardens and parks: tables, chairs, swings, fountains; each (length, width, height) in m at the origin."""

import math

from linden.scenery.mesh import Material, Mesh
from linden_maps.models.solids import (
    BLACK,
    RUBBER,
    STEEL,
    FaceLook,
    ball,
    box,
    lathe,
    prism,
    rod,
    stretched,
    tube,
    wedge,
)

_LEAVES = FaceLook(Material.LEAVES, (70, 112, 48))
_WOOD = FaceLook(Material.WOOD, (140, 100, 64))
_STONE = FaceLook(Material.CONCRETE, (172, 168, 158))
_WATER = FaceLook(Material.GLASS, (90, 130, 150))
_WHITE = FaceLook(Material.PLAIN, (232, 232, 228))
_RED = FaceLook(Material.PLAIN, (186, 40, 36))
_BLUE = FaceLook(Material.CLOTH, (50, 86, 150))


def barbecue(length: float, width: float, height: float) -> list[Mesh]:
    """Return a kettle on legs with a side table."""
    y, z = 0.45 * width, 0.72 * height
    kettle = ball((-0.15 * length, 0.0, z), (0.32 * length, y, 0.28 * height), BLACK, sides=10)
    legs = [
        rod((k * 0.3 * length - 0.15 * length, t * 0.8 * y, 0.0), (-0.15 * length, 0.0, z), 0.018, STEEL)
        for k in (-1.0, 1.0)
        for t in (-1.0, 1.0)
    ]
    return [kettle, *legs, box((0.15 * length, -0.5 * width, z - 0.04), (0.5 * length, 0.5 * width, z), _WOOD)]


def clothes_line(length: float, width: float, height: float) -> list[Mesh]:
    """Return lines between two posts, with washing."""
    x, y = 0.5 * length, 0.5 * width
    made: list[Mesh] = []
    for s in (-1.0, 1.0):
        made.append(box((s * x - 0.05 - 0.05 * s, -0.05, 0.0), (s * x + 0.05 - 0.05 * s, 0.05, height), _WOOD))
        made.append(box((s * x - 0.04 - 0.05 * s, -y, height - 0.08), (s * x + 0.04 - 0.05 * s, y, height), _WOOD))
    made += [
        rod((-x, t * y, height - 0.05), (x, t * y, height - 0.05), 0.006, _WHITE, sides=3) for t in (-0.9, 0.0, 0.9)
    ]
    sheets = ((-0.7, -0.2, -0.9, _WHITE), (-0.05, 0.3, 0.0, _BLUE), (0.4, 0.75, 0.9, _RED))
    return made + [
        box((a * x, t * y - 0.01, 0.4 * height), (b * x, t * y + 0.01, height - 0.05), look) for a, b, t, look in sheets
    ]


def dog_house(length: float, width: float, height: float) -> list[Mesh]:
    """Return a kennel with a gabled roof and a dark entrance."""
    x, y, wall = 0.46 * length, 0.42 * width, 0.6 * height
    house = box((-x, -y, 0.0), (x, y, wall), _WOOD)
    gable = prism([(-y, wall), (y, wall), (0.0, 0.96 * height)], -x, x, _WOOD, along=0)
    roof = [
        prism(
            [(s * 0.5 * width, wall - 0.06), (s * 0.5 * width, wall), (0.0, height), (0.0, height - 0.06)],
            -0.5 * length,
            0.5 * length,
            _RED,
            along=0,
        )
        for s in (-1.0, 1.0)
    ]
    return [house, gable, *roof, box((x - 0.02, -0.5 * y, 0.0), (x + 0.01, 0.5 * y, 0.8 * wall), BLACK)]


def fountain(length: float, width: float, height: float) -> list[Mesh]:
    """Return a fountain of two bowls over a basin."""
    basin = lathe(
        [0.0, 0.1 * height, 0.1 * height, 0.07 * height, 0.07 * height],
        [1.0, 1.0, 0.92, 0.9, 0.01],
        20,
        [_STONE, _STONE, _STONE, _WATER],
    )
    share, radii = (
        (0.05, 0.35, 0.4, 0.45, 0.45, 0.7, 0.74, 0.78, 0.78, 0.95, 1.0),
        (0.14, 0.08, 0.3, 0.45, 0.08, 0.06, 0.16, 0.25, 0.05, 0.04, 0.01),
    )
    tower = lathe([height * s for s in share], list(radii), 16, _STONE)
    return [stretched(mesh, (0.5 * length, 0.5 * width, 1.0)) for mesh in (basin, tower)]


def lamp(length: float, width: float, height: float) -> list[Mesh]:
    """Return a low lantern."""
    post = lathe([0.0, 0.05 * height, 0.1 * height, 0.6 * height], [0.8, 0.8, 0.25, 0.25], 8, BLACK)
    glass = lathe([0.6 * height, 0.65 * height, 0.9 * height], [0.4, 0.7, 0.8], 8, _WHITE)
    cap = lathe([0.9 * height, 0.92 * height, height], [1.0, 1.0, 0.1], 8, BLACK)
    return [stretched(mesh, (0.5 * length, 0.5 * width, 1.0)) for mesh in (post, glass, cap)]


def gnome(length: float, width: float, height: float) -> list[Mesh]:
    """Return a garden gnome: a coat, a beard, a pointed hat."""
    x, y = 0.5 * length, 0.5 * width
    coat = lathe([0.0, 0.1 * height, 0.5 * height, 0.55 * height], [0.8, 1.0, 0.7, 0.4], 10, _BLUE)
    hat = lathe([0.66 * height, 0.7 * height, height], [0.62, 0.58, 0.03], 10, _RED)
    face = ball((0.0, 0.0, 0.62 * height), (0.5 * x, 0.5 * y, 0.11 * height), FaceLook(Material.SKIN, (224, 172, 140)))
    beard = ball((0.3 * x, 0.0, 0.52 * height), (0.4 * x, 0.42 * y, 0.13 * height), _WHITE)
    return [stretched(coat, (x, y, 1.0)), stretched(hat, (x, y, 1.0)), face, beard]


def pergola(length: float, width: float, height: float) -> list[Mesh]:
    """Return posts with beams over them and leaves on top."""
    x, y = 0.5 * length, 0.5 * width
    made = [
        box(
            (s * 0.85 * x - 0.09, t * 0.85 * y - 0.09, 0.0),
            (s * 0.85 * x + 0.09, t * 0.85 * y + 0.09, 0.86 * height),
            _WOOD,
        )
        for s in (-1.0, 1.0)
        for t in (-1.0, 1.0)
    ]
    made += [
        box((-x, t * 0.85 * y - 0.06, 0.82 * height), (x, t * 0.85 * y + 0.06, 0.88 * height), _WOOD)
        for t in (-1.0, 1.0)
    ]
    made += [
        box(
            (-0.9 * x + 0.3 * x * n - 0.04, -y, 0.88 * height), (-0.9 * x + 0.3 * x * n + 0.04, y, 0.92 * height), _WOOD
        )
        for n in range(7)
    ]
    return [
        *made,
        ball((-0.4 * x, 0.3 * y, 0.94 * height), (0.4 * x, 0.5 * y, 0.06 * height), _LEAVES),
        ball((0.4 * x, -0.2 * y, 0.94 * height), (0.45 * x, 0.5 * y, 0.05 * height), _LEAVES),
    ]


def chair(length: float, width: float, height: float) -> list[Mesh]:
    """Return a plastic garden chair."""
    x, y, seat = 0.5 * length, 0.5 * width, 0.42 * height
    legs = [
        rod((s * 0.9 * x, t * 0.9 * y, 0.0), (s * 0.75 * x, t * 0.75 * y, seat), 0.025, _WHITE)
        for s in (-1.0, 1.0)
        for t in (-1.0, 1.0)
    ]
    back = wedge((-0.85 * x, -0.75 * y, seat), (-0.75 * x, 0.75 * y, height), _WHITE, top_x=(-x, -0.9 * x))
    arms = [
        box((-0.8 * x, t * 0.85 * y - 0.03, 0.66 * height), (0.8 * x, t * 0.85 * y + 0.03, 0.69 * height), _WHITE)
        for t in (-1.0, 1.0)
    ]
    posts = [
        rod((0.75 * x, t * 0.8 * y, seat), (0.75 * x, t * 0.85 * y, 0.67 * height), 0.02, _WHITE) for t in (-1.0, 1.0)
    ]
    return [*legs, back, *arms, *posts, box((-0.85 * x, -0.8 * y, seat - 0.03), (x, 0.8 * y, seat), _WHITE)]


def parasol_table(length: float, width: float, height: float) -> list[Mesh]:
    """Return a round table under a parasol."""
    top = lathe([0.28 * height, 0.3 * height], [0.45, 0.45], 16, _WHITE)
    pole = rod((0.0, 0.0, 0.0), (0.0, 0.0, 0.98 * height), 0.025, STEEL)
    cover = lathe([0.74 * height, 0.76 * height, height], [0.5 * length, 0.5 * length, 0.03], 12, [_BLUE, _RED])
    foot = lathe([0.0, 0.06], [0.25, 0.22], 12, _STONE)
    return [top, pole, stretched(cover, (1.0, width / length, 1.0)), foot]


def table(length: float, width: float, height: float) -> list[Mesh]:
    """Return a picnic table with two benches."""
    x, y, seat = 0.5 * length, 0.5 * width, 0.58 * height
    made = [
        box((-x, -0.42 * y + 0.17 * y * n, 0.94 * height), (x, -0.27 * y + 0.17 * y * n, height), _WOOD)
        for n in range(5)
    ]
    made += [
        box((-x, t * 0.86 * y - 0.14 * y, seat - 0.05), (x, t * 0.86 * y + 0.14 * y, seat), _WOOD) for t in (-1.0, 1.0)
    ]
    for s in (-0.7, 0.7):
        made.append(box((s * x - 0.04, -0.9 * y, seat - 0.13), (s * x + 0.04, 0.9 * y, seat - 0.05), _WOOD))
        made += [
            rod((s * x, t * 0.75 * y, 0.0), (s * x, t * 0.25 * y, 0.94 * height), 0.05, _WOOD, sides=4)
            for t in (-1.0, 1.0)
        ]
    return made


def slide(length: float, width: float, height: float) -> list[Mesh]:
    """Return a playground slide with its ladder."""
    x, y, top = 0.5 * length, 0.5 * width, 0.7 * height
    chute = prism(
        [(y, 0.12 * height), (-0.55 * y, top), (-0.55 * y, top - 0.06), (y, 0.06 * height)],
        -0.6 * x,
        0.6 * x,
        _RED,
        along=0,
    )
    rails = [
        prism(
            [(y, 0.26 * height), (-0.55 * y, top + 0.15), (-0.55 * y, top - 0.06), (y, 0.06 * height)],
            s * 0.7 * x - 0.03,
            s * 0.7 * x + 0.03,
            _BLUE,
            along=0,
        )
        for s in (-1.0, 1.0)
    ]
    ladder = [rod((s * 0.7 * x, -y, 0.0), (s * 0.7 * x, -0.6 * y, height), 0.03, STEEL) for s in (-1.0, 1.0)]
    steps = [
        rod((-0.7 * x, -y + 0.4 * y * k, height * k), (0.7 * x, -y + 0.4 * y * k, height * k), 0.025, STEEL)
        for k in (0.12, 0.26, 0.4, 0.54, 0.68)
    ]
    deck = box((-0.7 * x, -0.75 * y, top - 0.06), (0.7 * x, -0.5 * y, top), _RED)
    legs = [rod((s * x, 0.6 * y, 0.0), (s * 0.7 * x, 0.6 * y, 0.25 * height), 0.03, STEEL) for s in (-1.0, 1.0)]
    return [chute, *rails, *ladder, *steps, deck, *legs]


def swing(length: float, width: float, height: float) -> list[Mesh]:
    """Return a frame with two swings."""
    x, y = 0.5 * length, 0.5 * width
    made = [
        rod((s * x, t * y, 0.0), (s * 0.85 * x, 0.0, height - 0.04), 0.045, _RED)
        for s in (-1.0, 1.0)
        for t in (-1.0, 1.0)
    ]
    made.append(rod((-0.87 * x, 0.0, height - 0.05), (0.87 * x, 0.0, height - 0.05), 0.05, _RED))
    for at in (-0.4 * x, 0.4 * x):
        made.append(box((at - 0.25, -0.1, 0.45), (at + 0.25, 0.1, 0.49), RUBBER))
        made += [
            rod((at + s * 0.22, 0.0, 0.47), (at + s * 0.22, 0.0, height - 0.05), 0.01, STEEL, sides=4)
            for s in (-1.0, 1.0)
        ]
    return made


def swing_couch(length: float, width: float, height: float) -> list[Mesh]:
    """Return a couch that hangs in a frame under a canopy."""
    x, y = 0.5 * length, 0.5 * width
    made = [
        rod((s * x, t * 0.95 * y, 0.0), (0.0, t * 0.95 * y, 0.95 * height), 0.03, STEEL)
        for s in (-1.0, 1.0)
        for t in (-1.0, 1.0)
    ]
    made.append(box((-0.9 * x, -y, 0.94 * height), (0.9 * x, y, height), _BLUE))
    made.append(box((-0.4 * x, -0.75 * y, 0.24 * height), (0.5 * x, 0.75 * y, 0.32 * height), _BLUE))
    made.append(
        wedge(
            (-0.45 * x, -0.75 * y, 0.3 * height),
            (-0.3 * x, 0.75 * y, 0.62 * height),
            _BLUE,
            top_x=(-0.65 * x, -0.5 * x),
        )
    )
    return made + [
        rod((k * x, t * 0.78 * y, 0.3 * height), (0.0, t * 0.85 * y, 0.93 * height), 0.012, STEEL, sides=4)
        for k in (-0.35, 0.45)
        for t in (-1.0, 1.0)
    ]


def trampoline(length: float, width: float, height: float) -> list[Mesh]:
    """Return a trampoline with posts and a ring for its net."""
    bed = 0.3 * height
    mat = lathe([bed - 0.05, bed], [0.97, 0.97], 24, BLACK)
    pad = lathe([bed - 0.08, bed + 0.03, bed + 0.03, bed - 0.02], [1.0, 1.0, 0.84, 0.82], 24, _BLUE)
    made = [stretched(mesh, (0.5 * length, 0.5 * width, 1.0)) for mesh in (mat, pad)]
    tops = []
    for n in range(8):
        angle = math.tau * n / 8.0
        x, y = 0.485 * length * math.cos(angle), 0.485 * width * math.sin(angle)
        made.append(rod((x, y, 0.0), (x, y, height), 0.03, STEEL))
        tops.append((x, y, height - 0.03))
    return [*made, *(rod(a, b, 0.02, STEEL, sides=4) for a, b in zip(tops, [*tops[1:], tops[0]], strict=True))]


def watering_can(length: float, width: float, height: float) -> list[Mesh]:
    """Return a watering can."""
    green = FaceLook(Material.PLAIN, (50, 120, 70))
    body = stretched(lathe([0.0, 0.7 * height], [1.0, 0.9], 10, green), (0.5 * length, 0.28 * width, 1.0))
    spout = tube(
        [(0.0, 0.2 * width, 0.15 * height), (0.0, 0.42 * width, 0.6 * height), (0.0, 0.5 * width, 0.7 * height)],
        [0.012, 0.01, 0.02],
        6,
        green,
    )
    handle = tube(
        [
            (0.0, -0.25 * width, 0.2 * height),
            (0.0, -0.48 * width, 0.6 * height),
            (0.0, -0.2 * width, height),
            (0.0, 0.1 * width, 0.7 * height),
        ],
        [0.008] * 4,
        5,
        green,
    )
    return [body, spout, handle]
