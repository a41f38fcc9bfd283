"""The parts of a human body, each in its bone's frame and as large as the body's stature asks.

Lengths follow ``world.skeleton``; girths are drawn by eye, in statures. Legs and arms are a little nearer to the middle
than their bones: the distances of bones (Drillis and Contini) are those of a body's outline.
"""

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import NamedTuple, TypeVar, cast

import numpy as np

from linden.protocol.values.enums import SemanticTag
from linden.scenery.mesh import Material, Mesh, join
from linden_maps.models.solids import FaceLook, ball, both_sides, box, loft, ring_of, stretched, tagged, tube

Colour = tuple[int, int, int]
Make = TypeVar("Make", bound=Callable[..., Mesh])

CLOTH = FaceLook(Material.CLOTH, (120, 120, 125), painted=True)
"""Clothes; what colour, the part says that the mesh belongs to."""

_DARK = FaceLook(Material.PLAIN, (30, 26, 24))
_LEGS_IN = 0.032
ARMS_IN = 0.026
"""How much nearer to the middle than their bones the limbs are, in statures."""

_SIDES = 8


class Build(NamedTuple):
    """How a body is made, apart from the colours of its clothes."""

    stature_m: float
    female: bool
    child: bool
    skin: Colour
    hair: Colour
    shoes: Colour
    bare_legs: Colour | None  # their skin, under a skirt
    long_sleeves: bool
    helmet: Colour | None = None


_BLACK = (0, 0, 0)
_NOBODY = Build(
    1.0, female=False, child=False, skin=_BLACK, hair=_BLACK, shoes=_BLACK, bare_legs=None, long_sleeves=False
)


def _limb(*matters: str) -> Callable[[Make], Make]:
    """Let a function give the same mesh to all bodies that are alike in what ``matters``, tagged as a pedestrian's."""

    def remember(make: Make) -> Make:
        @lru_cache(maxsize=256)
        def made(build: Build, *side: float) -> Mesh:
            return tagged(make(build, *side), SemanticTag.PEDESTRIANS)

        def recall(build: Build, *side: float) -> Mesh:
            return made(_NOBODY._replace(**{name: getattr(build, name) for name in matters}), *side)

        return cast("Make", recall)

    return remember


def _skin(build: Build) -> FaceLook:
    return FaceLook(Material.SKIN, build.skin)


def _leg(build: Build) -> FaceLook:
    return CLOTH if build.bare_legs is None else FaceLook(Material.SKIN, build.bare_legs)


def _ovals(rows: Sequence[tuple[float, float, float, float]], size_m: float, look: FaceLook) -> Mesh:
    """Return a solid of ovals one over the other, each (height, half depth, half width, how far ahead)."""
    rings = []
    for height, depth, width, ahead in rows:
        rings.append(ring_of(1.0, 0.0, _SIDES) * (depth, width, 0.0) + (ahead, 0.0, height))
    return loft(np.array(rings) * size_m, look, look, look)


@_limb("stature_m", "female", "bare_legs")
def hips(build: Build) -> Mesh:
    """Return the pelvis, or the skirt over it."""
    wide = 0.093 if build.female else 0.087
    rows = [
        (-0.045, 0.045, 0.06, 0.0),
        (-0.01, 0.064, wide + 0.01, -0.004),
        (0.04, 0.06, wide, 0.0),
        (0.085, 0.05, 0.074, 0.0),
    ]
    if build.bare_legs is not None:
        rows = [(-0.23, 0.082, 0.122, 0.005), (-0.03, 0.068, 0.116, 0.0), (0.02, 0.062, 0.1, 0.0), rows[-1]]
    return _ovals(rows, build.stature_m, CLOTH)


@_limb("stature_m", "female", "child", "skin")
def chest(build: Build) -> Mesh:
    """Return what is between waist and neck, with the neck."""
    wide = 0.084 if build.female else 0.094
    front = 0.012 if build.female and not build.child else 0.0
    shirt = [
        (-0.125, 0.051, 0.075, 0.0),
        (-0.06, 0.056, 0.078, 0.0),
        (0.02, 0.062 + front, wide, front),
        (0.07, 0.056 + 0.5 * front, wide + 0.006, 0.3 * front),
        (0.098, 0.046, 0.088, -0.006),
        (0.115, 0.034, 0.036, -0.004),
    ]
    neck = _ovals([(0.1, 0.027, 0.026, -0.002), (0.19, 0.026, 0.025, 0.004)], build.stature_m, _skin(build))
    return join([_ovals(shirt, build.stature_m, CLOTH), neck])


@_limb("stature_m", "female", "child", "skin", "hair", "helmet")
def head(build: Build) -> Mesh:
    """Return the head; its crown is a whole stature above the ground when the body stands."""
    size, crown = build.stature_m, 0.115
    tall, deep, wide = (0.074, 0.066, 0.06) if build.child else (0.062, 0.052, 0.042)
    centre = crown - tall - 0.004
    parts = [ball((0.006, 0.0, centre), (deep, wide, tall), _skin(build), sides=10, bands=8)]
    parts.append(box((deep - 0.002, -0.006, centre - 0.02), (deep + 0.016, 0.006, centre + 0.002), _skin(build)))
    parts += both_sides(
        box(
            (0.85 * deep, 0.4 * wide - 0.006, centre + 0.004), (0.975 * deep, 0.4 * wide + 0.006, centre + 0.012), _DARK
        )
    )
    if build.helmet is not None:
        cover = FaceLook(Material.PLAIN, build.helmet)
        parts.append(
            ball((-0.004, 0.0, centre + 0.016), (deep + 0.014, wide + 0.014, crown - centre - 0.016), cover, sides=10)
        )
        return stretched(join(parts), (size, size, size))
    hair = FaceLook(Material.CLOTH, build.hair)
    top = crown - centre - 0.022
    parts.append(ball((-0.006, 0.0, centre + 0.022), (deep - 0.001, wide + 0.005, top), hair, sides=10, bands=6))
    parts.append(ball((-0.016, 0.0, centre + 0.004), (deep - 0.008, wide + 0.004, 0.8 * tall), hair, sides=8, bands=6))
    if build.female:
        parts.append(
            _ovals(
                [
                    (centre - 0.09, 0.012, 0.03, -0.045),
                    (centre - 0.02, 0.026, wide, -0.035),
                    (centre + 0.03, 0.02, wide, -0.03),
                ],
                1.0,
                hair,
            )
        )
    return stretched(join(parts), (size, size, size))


@_limb("stature_m")
def arm(build: Build, side: float) -> Mesh:
    """Return the upper arm of the right (1) or left (-1) side, with the shoulder."""
    y, size = -side * ARMS_IN, build.stature_m
    path = [(0.0, 1.9 * y, -0.002), (0.0, 1.3 * y, -0.01), (0.0, y, -0.035), (0.0, y, -0.09), (0.0, y, -0.19)]
    return _scaled_tube(path, [0.008, 0.022, 0.028, 0.026, 0.021], size, CLOTH)


@_limb("stature_m", "skin", "long_sleeves")
def forearm(build: Build, side: float) -> Mesh:
    """Return the forearm with the hand."""
    y, size = -side * ARMS_IN, build.stature_m
    lower = _scaled_tube(
        [(0.0, y, 0.012), (0.0, y, -0.05), (0.0, y, -0.15)],
        [0.02, 0.02, 0.014],
        size,
        CLOTH if build.long_sleeves else _skin(build),
    )
    hand = ball((0.004, y, -0.19), (0.02, 0.011, 0.044), _skin(build), sides=6, bands=4)
    return join([lower, stretched(hand, (size, size, size))])


@_limb("stature_m", "bare_legs")
def thigh(build: Build, side: float) -> Mesh:
    """Return the thigh."""
    y, size = -side * _LEGS_IN, build.stature_m
    path = [(0.0, 1.6 * y, 0.04), (0.0, 1.3 * y, 0.015), (0.0, 1.05 * y, -0.06), (0.002, y, -0.16), (0.002, y, -0.25)]
    return _scaled_tube(path, [0.018, 0.038, 0.048, 0.042, 0.033], size, _leg(build))


@_limb("stature_m", "bare_legs")
def shin(build: Build, side: float) -> Mesh:
    """Return what is between knee and ankle."""
    y, size = -side * _LEGS_IN, build.stature_m
    path = [(0.004, y, 0.015), (-0.002, y, -0.07), (0.0, y, -0.16), (0.0, y, -0.235)]
    return _scaled_tube(path, [0.031, 0.033, 0.026, 0.022], size, _leg(build))


@_limb("stature_m", "shoes")
def foot(build: Build, side: float) -> Mesh:
    """Return a shoe; its sole is as low as the skeleton's feet stand over the ground."""
    y, look = -side * _LEGS_IN, FaceLook(Material.CLOTH, build.shoes)
    rings = [
        [(x, y - wide, -0.039), (x, y + wide, -0.039), (x, y + 0.8 * wide, high), (x, y - 0.8 * wide, high)]
        for x, wide, high in (
            (-0.034, 0.018, 0.0),
            (0.012, 0.024, 0.004),
            (0.05, 0.026, -0.012),
            (0.092, 0.026, -0.022),
            (0.112, 0.016, -0.028),
        )
    ]
    return loft(np.array(rings) * build.stature_m, look, look, look)


def _scaled_tube(path: list[tuple[float, float, float]], radii: list[float], size_m: float, look: FaceLook) -> Mesh:
    return tube((np.array(path) * size_m).tolist(), [size_m * radius for radius in radii], _SIDES, look)
