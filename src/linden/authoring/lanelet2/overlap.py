"""Area of a polygon, and area of the intersection of two polygons, also as a share of the first one."""

import numpy as np

from linden.maps.opendrive.evaluate.pieces import F64

_SLICES = 64
"""The area is summed over so many slices: the share of lanelets is within 0.005 of the exact one."""


def overlap_share(ring: F64, other: F64, slices: int = _SLICES) -> float:
    """Return the share of a ring's area, (N, 2), that lies inside of another ring, (M, 2); both are simple."""
    area = area_m2(ring)
    return overlap_m2(ring, other, slices) / area if area > 0.0 else 0.0


def overlap_m2(ring: F64, other: F64, slices: int = _SLICES) -> float:
    """Return the area that lies inside of two rings (N, 2) and (M, 2)."""
    low, high = np.maximum(ring.min(axis=0), other.min(axis=0)), np.minimum(ring.max(axis=0), other.max(axis=0))
    if (high <= low).any():
        return 0.0
    step = (high[1] - low[1]) / slices
    at = low[1] + step * (np.arange(slices) + 0.5)
    end = max(float(ring[:, 0].max()), float(other[:, 0].max()))
    of_ring, of_other = _crossings(ring, at, end), _crossings(other, at, end)
    places = np.concatenate([of_ring, of_other], axis=1)
    order = np.argsort(places, axis=1, kind="stable")
    is_of_ring = order < of_ring.shape[1]
    in_both = (np.cumsum(is_of_ring, axis=1) % 2 == 1) & (np.cumsum(~is_of_ring, axis=1) % 2 == 1)
    widths = np.diff(np.take_along_axis(places, order, axis=1), axis=1)
    return float((widths * in_both[:, :-1]).sum() * step)


def area_m2(ring: F64) -> float:
    """Return the area of a ring (N, 2)."""
    near = ring - ring[0]  # large coordinates would cost digits
    after = np.roll(near, -1, axis=0)
    return abs(float(0.5 * (near[:, 0] * after[:, 1] - after[:, 0] * near[:, 1]).sum()))


def _crossings(ring: F64, at: F64, end: float) -> F64:
    """Return x where a ring crosses each y (S,): (S, N), ``end`` in place of edges that do not cross."""
    after = np.roll(ring, -1, axis=0)
    crosses = (ring[:, 1] > at[:, None]) != (after[:, 1] > at[:, None])
    rise = np.where(after[:, 1] == ring[:, 1], 1.0, after[:, 1] - ring[:, 1])
    x = ring[:, 0] + (at[:, None] - ring[:, 1]) * (after[:, 0] - ring[:, 0]) / rise
    found: F64 = np.where(crosses, x, end)
    return found
