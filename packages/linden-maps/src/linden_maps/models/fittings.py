"""Wheels, lamps, grilles, bumpers and other parts mounted on a vehicle's body.

The rims of wheels have spokes, so that their turning is visible.
"""

import math
from functools import lru_cache

import numpy as np

from linden.scenery.mesh import Material, Mesh, join
from linden_maps.models.hull import F64, PROUD_M, BodyFrame, Silhouette, half_width, ring_heights, top
from linden_maps.models.solids import (
    BEACON_BLUE,
    BEACON_RED,
    BLACK,
    BLINKER_LEFT,
    BLINKER_RIGHT,
    BRAKE,
    CHROME,
    HEAD,
    PAINT,
    PLATE,
    REVERSE,
    RIM,
    RUBBER,
    STEEL,
    TAIL,
    TRIM,
    FaceLook,
    both_sides,
    box,
    faces_of,
    lathe,
    loft,
    moved,
    ring_of,
    rod,
    tagged,
    turned,
)

_SIDES = 15
ABOUT_X = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
"""Turns what stands along z so that it lies along x."""

ABOUT_Y = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""Turns what stands along z so that it lies along y."""


@lru_cache(maxsize=256)
def wheel(radius_m: float, inner_m: float, outer_m: float, tag: int) -> Mesh:
    """Return a wheel about the y axis, from ``inner_m`` to ``outer_m``: on that side its rim is seen."""
    out = 1.0 if outer_m > inner_m else -1.0
    across = [inner_m, inner_m, outer_m, outer_m, outer_m - 0.03 * out, outer_m - 0.045 * out, outer_m - 0.015 * out]
    radii = [0.9, 1.0, 1.0, 0.86, 0.66, 0.62, 0.16]
    looks = np.stack([faces_of(RUBBER, _SIDES)] * 4 + [faces_of(STEEL, _SIDES), faces_of(RIM, _SIDES)])
    looks[5, np.arange(_SIDES) % 3 == 2] = faces_of(BLACK)
    rings = np.array([ring_of(radius_m * r, at, _SIDES) for at, r in zip(across, radii, strict=True)])
    return tagged(turned(loft(rings, looks, BLACK, RIM), ABOUT_Y), tag)


@lru_cache(maxsize=32)
def spoked_wheel(radius_m: float, width_m: float, spokes: int, tag: int) -> Mesh:
    """Return a bicycle's or motorcycle's wheel about the y axis: a tyre as a ring, a hub and spokes between."""
    parts = [hoop(radius_m - 0.5 * width_m, 0.5 * width_m, RUBBER), hoop(radius_m - 1.2 * width_m, 0.3 * width_m, RIM)]
    parts.append(rod((0.0, -0.05, 0.0), (0.0, 0.05, 0.0), 0.03, STEEL))
    for spoke in range(spokes):
        angle = math.tau * spoke / spokes
        end = (math.cos(angle) * (radius_m - width_m), 0.0, math.sin(angle) * (radius_m - width_m))
        parts.append(rod((0.0, 0.0, 0.0), end, max(0.004, 0.06 * width_m), RIM, sides=3))
    return tagged(join(parts), tag)


def hoop(radius_m: float, thickness_m: float, look: FaceLook) -> Mesh:
    """Return a ring about the y axis, made of a tube of radius ``thickness_m``."""
    rings = []
    for angle in np.arange(_SIDES + 1) * (math.tau / _SIDES):
        outwards = np.array([math.cos(angle), 0.0, math.sin(angle)])
        corners = np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]) * thickness_m
        rings.append(outwards * radius_m + corners[:, :1] * outwards + corners[:, 1:] * (0.0, 1.0, 0.0))
    return loft(np.array(rings), look, look, look)


_TAXI_SIGN = FaceLook(Material.PLAIN, (240, 220, 90))
_SHORTEST_BONNET_M = 0.4
_TAIL_LAMP_M = 0.09
"""Width of an upright tail lamp."""


def plaque(x_m: float, y_m: tuple[float, float], z_m: tuple[float, float], look: FaceLook) -> Mesh:
    """Return a thin plate on a front (x > 0) or rear end at ``x_m``, standing off it a little."""
    out = PROUD_M if x_m > 0.0 else -PROUD_M
    return box((min(x_m - out, x_m + out), y_m[0], z_m[0]), (max(x_m - out, x_m + out), y_m[1], z_m[1]), look)


def pair(x_m: float, y_m: tuple[float, float], z_m: tuple[float, float], left: FaceLook, right: FaceLook) -> list[Mesh]:
    """Return two plaques, mirrored; ``y_m`` is the right one's."""
    return [plaque(x_m, y_m, z_m, right), plaque(x_m, (-y_m[1], -y_m[0]), z_m, left)]


def round_lamps(x_m: float, y_m: float, z_m: float, radius_m: float) -> list[Mesh]:
    """Return two round head lamps in rings of chrome."""
    lamp = turned(lathe([-0.03, 0.006], [radius_m, radius_m], 12, CHROME), ABOUT_X)
    glass = turned(lathe([-0.03, PROUD_M], [0.84 * radius_m, 0.84 * radius_m], 12, HEAD), ABOUT_X)
    return [moved(mesh, (x_m, side * y_m, z_m)) for side in (-1.0, 1.0) for mesh in (lamp, glass)]


def underside(frame: BodyFrame) -> Mesh:
    """Return what is dark beneath a car and keeps one from looking through its arches."""
    low, inset = 0.55 * frame.wheel_radius, 0.35
    high = 2.0 * frame.wheel_radius
    return box(
        (frame.rear + 0.3, -frame.half_width + inset, low), (frame.front - 0.3, frame.half_width - inset, high), BLACK
    )


def cockpit(shape: Silhouette, frame: BodyFrame) -> list[Mesh]:
    """Return what a camera in the driver's seat sees of the car: the dashboard and a bonnet of its own.

    Casters that let a sensor look out through the back of its carrier's faces show no bonnet but this one, which lies
    just below the body's. There is no steering wheel: it would stand in the way of what cameras are there for.
    """
    base = float(frame.x(shape.windscreen[1]))
    wide, high = 0.84 * float(half_width(shape, frame, base)), float(top(shape, frame, base)) - 0.04
    made = [box((base - 0.45, -wide, 0.4 * high), (base, wide, high), BLACK)]
    if frame.front - base < _SHORTEST_BONNET_M:
        return made
    x: F64 = np.linspace(base - 0.02, frame.front - 0.04, 8, dtype=np.float64)
    roof_m, side_m = top(shape, frame, x) - 0.025, 0.8 * half_width(shape, frame, x)
    across = [(-1.0, -0.1), (1.0, -0.1), (1.0, -0.035), (0.6, 0.0), (-0.6, 0.0), (-1.0, -0.035)]
    rings = np.stack([np.stack([x, side * side_m, roof_m + drop], 1) for side, drop in across], 1)
    return [*made, loft(rings, PAINT, PAINT, PAINT)]


def front(shape: Silhouette, frame: BodyFrame) -> list[Mesh]:
    """Return grille, plate, blinkers, and lamps where they do not reach round the corners."""
    x, wide = frame.front, float(half_width(shape, frame, frame.front))
    flank, crease, waist = ring_heights(shape, frame, x)
    low, high = (share * frame.roof for share in shape.grille)
    made = [plaque(x, (-0.22, 0.22), (flank - 0.07, flank + 0.04), PLATE)]
    if shape.wide_lamps:
        made.append(plaque(x, (-0.58 * wide, 0.58 * wide), (crease, waist), TRIM))
        made += pair(x, (0.7 * wide, 0.96 * wide), (crease - 0.05, crease - 0.015), BLINKER_LEFT, BLINKER_RIGHT)
    else:
        made += round_lamps(x, 0.72 * wide, 0.5 * (flank + crease) + 0.03, 0.11)
        made += pair(x, (0.6 * wide, 0.84 * wide), (flank - 0.12, flank - 0.07), BLINKER_LEFT, BLINKER_RIGHT)
    if high - low > 0.05:
        made.append(plaque(x, (-0.5 * wide, 0.5 * wide), (max(low, flank + 0.05), min(high, crease - 0.01)), BLACK))
        made.append(
            plaque(x + 0.5 * PROUD_M, (-0.06, 0.06), (min(high, crease) - 0.1, min(high, crease) - 0.04), CHROME)
        )
    return made


def rear(shape: Silhouette, frame: BodyFrame) -> list[Mesh]:
    """Return plate, lamps and the third brake light."""
    x, wide = frame.rear, float(half_width(shape, frame, frame.rear))
    flank, crease, waist = ring_heights(shape, frame, x)
    made = [plaque(x, (-0.26, 0.26), (flank + 0.03, flank + 0.14), PLATE)]
    if shape.wide_lamps:
        made.append(plaque(x, (-0.52 * wide, 0.52 * wide), (crease, waist), PAINT))
        made += pair(x, (0.6 * wide, 0.95 * wide), (crease - 0.045, crease), BLINKER_LEFT, BLINKER_RIGHT)
        made += pair(x, (0.4 * wide, 0.58 * wide), (crease - 0.045, crease), REVERSE, REVERSE)
    else:
        outer = 0.97 * wide
        inner, tall = outer - _TAIL_LAMP_M, crease - flank
        made += pair(x, (inner, outer), (flank + 0.35 * tall, crease), TAIL, TAIL)
        made += pair(x, (inner, outer), (flank + 0.12 * tall, flank + 0.35 * tall), BLINKER_LEFT, BLINKER_RIGHT)
        made += pair(x, (inner, outer), (flank - 0.08, flank + 0.12 * tall), REVERSE, REVERSE)
    over = float(frame.x(shape.rear_window[1] + 0.01))
    high = float(top(shape, frame, over))
    made.append(box((over - 0.03, -0.16, high - 0.03), (over + 0.03, 0.16, high + 0.006), BRAKE))
    return made


def mirrors(shape: Silhouette, frame: BodyFrame, reach_m: float) -> list[Mesh]:
    """Return two mirrors that reach ``reach_m`` from the middle."""
    x = float(frame.x(shape.side_glass[-1][1] - 0.035))
    waist = ring_heights(shape, frame, x)[2]
    inner = 0.93 * float(half_width(shape, frame, x))
    housing = box((x - 0.05, min(inner + 0.03, reach_m - 0.1), waist + 0.01), (x + 0.07, reach_m, waist + 0.14), PAINT)
    glass = box(
        (x - 0.056, min(inner + 0.05, reach_m - 0.08), waist + 0.03), (x - 0.04, reach_m - 0.02, waist + 0.12), STEEL
    )
    stem = box((x - 0.02, inner - 0.06, waist - 0.01), (x + 0.04, min(inner + 0.08, reach_m), waist + 0.04), TRIM)
    return [mesh for part in (housing, glass, stem) for mesh in both_sides(part)]


def handles(shape: Silhouette, frame: BodyFrame) -> list[Mesh]:
    """Return a handle at the rear end of each door."""
    made = []
    for low, _ in shape.side_glass[-2:]:
        x = float(frame.x(low)) + 0.1
        crease = ring_heights(shape, frame, x)[1]
        out = 0.985 * float(half_width(shape, frame, x))
        made += both_sides(box((x - 0.08, out - 0.04, crease), (x + 0.09, out + 0.015, crease + 0.03), TRIM))
    return made


def on_the_roof(shape: Silhouette, frame: BodyFrame, tall_m: float, *, taxi: bool) -> list[Mesh]:
    """Return a taxi's sign, or a bar of blue and red lights."""
    x = float(frame.x(shape.top[np.argmax(shape.top[:, 1]), 0]))
    low, high = frame.roof - 0.01, frame.roof + tall_m
    if taxi:
        return [box((x - 0.1, -0.3, low), (x + 0.1, 0.3, high), _TAXI_SIGN)]
    foot = box((x - 0.12, -0.5, low), (x + 0.12, 0.5, low + 0.04), TRIM)
    return [foot, *beacons(x, 0.6, low + 0.04, high)]


def beacons(x_m: float, half_m: float, low_m: float, high_m: float) -> list[Mesh]:
    """Return a bar of blue lights on the right and red ones on the left."""
    right = box((x_m - 0.13, 0.08, low_m), (x_m + 0.13, half_m, high_m), BEACON_BLUE)
    left = box((x_m - 0.13, -half_m, low_m), (x_m + 0.13, -0.08, high_m), BEACON_RED)
    middle = box((x_m - 0.11, -0.08, low_m), (x_m + 0.11, 0.08, high_m - 0.02), TRIM)
    return [right, left, middle]
