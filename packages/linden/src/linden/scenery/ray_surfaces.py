"""Intersection of a ray with a box, a triangle or a parabola. Places count from 0 at its start to 1 at its end.

A ray is its start and its step (3,), in m; what is missed is met at infinity.
"""

import math

import numpy as np
from numpy.typing import NDArray

from linden.compiled import part

F64 = NDArray[np.float64]

_EDGE_TOLERANCE = 1e-4  # in barycentric units: a ray through a shared edge meets both triangles rather than none


@part
def cut_to_slab(start: float, step: float, half: float, span: F64) -> None:
    """Cut ``span`` (2,), from and to, down to where start + t step lies within +-half."""
    if step == 0.0:
        if abs(start) > half:
            span[1] = -math.inf
        return
    first, second = (-half - start) / step, (half - start) / step
    span[0] = max(span[0], min(first, second))
    span[1] = min(span[1], max(first, second))


@part
def enters(start: F64, step: F64, centre: F64, half: F64, cosine: float, sine: float) -> float:
    """Return where a ray enters an upright box, 0 where it begins inside, inf where it misses (Kay and Kajiya 1986)."""
    span = np.array([0.0, 1.0])
    x, y = start[0] - centre[0], start[1] - centre[1]
    cut_to_slab(cosine * x + sine * y, cosine * step[0] + sine * step[1], half[0], span)
    cut_to_slab(cosine * y - sine * x, cosine * step[1] - sine * step[0], half[1], span)
    cut_to_slab(start[2] - centre[2], step[2], half[2], span)
    return span[0] if span[0] <= span[1] else math.inf


@part
def enters_turned(start: F64, step: F64, centre: F64, half: F64, axes: F64) -> float:
    """Do the same for a box turned in any way."""
    span = np.array([0.0, 1.0])
    for axis in range(3):
        at, ahead = 0.0, 0.0
        for k in range(3):
            at += (start[k] - centre[k]) * axes[k, axis]
            ahead += step[k] * axes[k, axis]
        cut_to_slab(at, ahead, half[axis], span)
    return span[0] if span[0] <= span[1] else math.inf


@part
def meets_triangle(start: F64, step: F64, plane: F64) -> float:
    """Return where a ray meets a triangle of the ground (a row of ``Ground.planes``), inf where it does not."""
    x, y = start[0] - plane[0], start[1] - plane[1]
    above = start[2] - plane[6] - plane[7] * x - plane[8] * y
    closing = step[2] - plane[7] * step[0] - plane[8] * step[1]
    if closing == 0.0:
        return math.inf
    at = -above / closing
    if not 0.0 <= at <= 1.0:
        return math.inf
    x, y = x + at * step[0], y + at * step[1]
    first, second = plane[2] * x + plane[3] * y, plane[4] * x + plane[5] * y
    inside = first >= -_EDGE_TOLERANCE and second >= -_EDGE_TOLERANCE and first + second <= 1.0 + _EDGE_TOLERANCE
    return at if inside else math.inf


@part
def parabola_roots(begin: float, middle: float, end: float) -> tuple[float, float]:
    """Return where the parabola with these values at 0, 1/2 and 1 changes its sign between, inf for a root too few.

    Zero counts as above, so that what ends one piece of a ray begins the next: nothing is found twice or lost.
    """
    curve = 2.0 * (begin + end) - 4.0 * middle
    slope = end - begin - curve
    crosses = (begin < 0.0) != (end < 0.0)
    dips = False
    if not crosses and curve != 0.0:
        turn = -0.5 * slope / curve
        dips = 0.0 < turn < 1.0 and (begin + turn * (slope + turn * curve) < 0.0) != (begin < 0.0)
    if not (crosses or dips):
        return math.inf, math.inf
    root = math.sqrt(max(0.0, slope * slope - 4.0 * curve * begin))
    q = -0.5 * (slope + (root if slope >= 0.0 else -root))  # Press et al., Numerical Recipes, section 5.6
    first = q / curve if curve != 0.0 else math.inf
    second = begin / q if q != 0.0 else math.inf
    if dips:
        return min(first, second), max(first, second)
    nearest = first if abs(first - 0.5) <= abs(second - 0.5) else second  # the other one lies outside
    return min(max(nearest, 0.0), 1.0), math.inf
