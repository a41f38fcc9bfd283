"""Wheels: a tyre and a rim whose spokes show that it turns; and the thin ones of two-wheelers."""

import math
from functools import lru_cache

import numpy as np

from linden.meshes.actors.looks import BLACK, RIM, RUBBER, STEEL
from linden.meshes.actors.solids import Look, faces_of, loft, ring_of, rod, tagged, turned
from linden.meshes.mesh import Mesh, join

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


def hoop(radius_m: float, thickness_m: float, look: Look) -> Mesh:
    """Return a ring about the y axis: round, of ``thickness_m`` radius itself."""
    rings = []
    for angle in np.arange(_SIDES + 1) * (math.tau / _SIDES):
        outwards = np.array([math.cos(angle), 0.0, math.sin(angle)])
        corners = np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]) * thickness_m
        rings.append(outwards * radius_m + corners[:, :1] * outwards + corners[:, 1:] * (0.0, 1.0, 0.0))
    return loft(np.array(rings), look, look, look)
