"""Props that grow, each about as large as (length, width, height) in m and standing at the origin."""

import math

from linden.scenery.mesh import Material, Mesh
from linden_maps.models.solids import FaceLook, ball, box, lathe, rod, stretched, tube

_BARK = FaceLook(Material.BARK, (92, 72, 54))
_LEAVES = FaceLook(Material.LEAVES, (70, 112, 48))
_DARK_LEAVES = FaceLook(Material.LEAVES, (44, 82, 50))
_POT = FaceLook(Material.BRICK, (168, 92, 62))
_EARTH = FaceLook(Material.GRAVEL, (70, 52, 40))


def broad_tree(length: float, width: float, height: float) -> list[Mesh]:
    """Return a tree with a broad crown."""
    trunk = lathe([0.0, 0.06 * height, 0.5 * height], [0.035 * height, 0.022 * height, 0.014 * height], 8, _BARK)
    crown = [ball((0.0, 0.0, 0.62 * height), (0.36 * length, 0.36 * width, 0.32 * height), _LEAVES, sides=12, bands=8)]
    for n in range(7):
        angle = math.tau * n / 7.0
        place = (0.3 * length * math.cos(angle), 0.3 * width * math.sin(angle), height * (0.55 + 0.08 * (n % 3)))
        crown.append(ball(place, (0.2 * length, 0.2 * width, 0.2 * height), _LEAVES, sides=9, bands=6))
    return [trunk, *crown, ball((0.0, 0.0, 0.85 * height), (0.2 * length, 0.2 * width, 0.15 * height), _LEAVES)]


def cypress(length: float, width: float, height: float) -> list[Mesh]:
    """Return a slender evergreen."""
    share, radii = (0.04, 0.1, 0.3, 0.55, 0.8, 1.0), (0.5, 0.9, 1.0, 0.8, 0.42, 0.03)
    crown = lathe([height * s for s in share], list(radii), 12, _DARK_LEAVES)
    return [
        rod((0.0, 0.0, 0.0), (0.0, 0.0, 0.1 * height), 0.15, _BARK),
        stretched(crown, (0.5 * length, 0.5 * width, 1.0)),
    ]


def palm(length: float, width: float, height: float) -> list[Mesh]:
    """Return a palm: a thin trunk and a crown of long leaves."""
    bend = [(0.03 * height * s * s, 0.0, 0.88 * height * s) for s in (0.0, 0.25, 0.5, 0.75, 1.0)]
    made = [tube(bend, [0.28, 0.22, 0.2, 0.18, 0.16], 8, _BARK)]
    x, _, top = bend[-1]
    for n in range(12):
        angle, rise = math.tau * n / 12.0, 0.12 * height if n % 2 else 0.06 * height
        c, s = math.cos(angle), math.sin(angle)
        line = [(x, 0.0, top)]
        line += [
            (x + 0.5 * length * k * c, 0.5 * width * k * s, top + rise * (1.9 * k - 2.4 * k * k))
            for k in (0.4, 0.75, 1.0)
        ]
        made.append(tube(line, [0.12, 0.28, 0.22, 0.03], 4, _LEAVES))
    return made


def planter(length: float, width: float, height: float) -> list[Mesh]:
    """Return a long box with plants."""
    x, y, rim = 0.5 * length, 0.5 * width, 0.5 * height
    made = [
        box((-x, -y, 0.0), (x, y, rim), _POT),
        box((-0.92 * x, -0.85 * y, rim - 0.02), (0.92 * x, 0.85 * y, rim + 0.01), _EARTH),
    ]
    count = max(3, round(length / 0.35))
    for n in range(count):
        at = -0.8 * x + 1.6 * x * n / (count - 1)
        made.append(ball((at, 0.0, 0.72 * height), (0.16, 0.8 * y, 0.28 * height), _LEAVES, sides=7, bands=5))
    return made


def round_pot(length: float, width: float, height: float) -> list[Mesh]:
    """Return a round pot with a plant."""
    pot = lathe([0.0, 0.5 * height, 0.52 * height], [0.7, 1.0, 0.9], 12, [_POT, _EARTH])
    plant = ball((0.0, 0.0, 0.72 * height), (0.42 * length, 0.42 * width, 0.28 * height), _LEAVES, sides=8, bands=6)
    return [stretched(pot, (0.5 * length, 0.5 * width, 1.0)), plant]
