"""Overlap of two boxes, seen from above: along which direction, how deep, at which point."""

import math

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kernel, part

F64 = NDArray[np.float64]

X, Y, COS, SIN, HALF_X, HALF_Y, LOW, HIGH = range(8)
"""A box as eight numbers: centre, cosine and sine of its yaw, half sizes, lowest and highest z; m."""


@kernel
def overlap(a: F64, b: F64) -> tuple[float, float, float, float, float]:
    """Return depth (0 where apart), unit normal from ``b`` to ``a`` (x, y) and contact point (x, y); m.

    Separating axes of two rectangles: Ericson, Real-Time Collision Detection, section 4.4.1; the normal is the axis of
    least overlap, the point the mean of the corners that lie in the other box.
    """
    apart_x, apart_y = a[X] - b[X], a[Y] - b[Y]
    depth, normal_x, normal_y = math.inf, 1.0, 0.0
    if a[LOW] >= b[HIGH] or b[LOW] >= a[HIGH]:
        return 0.0, 1.0, 0.0, 0.0, 0.0
    cosine = abs(a[COS] * b[COS] + a[SIN] * b[SIN])
    sine = abs(a[COS] * b[SIN] - a[SIN] * b[COS])
    for axis in range(4):
        if axis < 2:
            box, reach = a, b[HALF_X] * (cosine if axis == 0 else sine) + b[HALF_Y] * (sine if axis == 0 else cosine)
        else:
            box, reach = b, a[HALF_X] * (cosine if axis == 2 else sine) + a[HALF_Y] * (sine if axis == 2 else cosine)
        along = axis % 2 == 0
        axis_x, axis_y = (box[COS], box[SIN]) if along else (-box[SIN], box[COS])
        distance = apart_x * axis_x + apart_y * axis_y
        shared = reach + (box[HALF_X] if along else box[HALF_Y]) - abs(distance)
        if shared <= 0.0:
            return 0.0, 1.0, 0.0, 0.0, 0.0
        if shared < depth - 1e-9:
            sign = 1.0 if distance >= 0.0 else -1.0
            depth, normal_x, normal_y = shared, sign * axis_x, sign * axis_y
    point_x, point_y = _meeting_point(a, b)
    return depth, normal_x, normal_y, point_x, point_y


@part
def _meeting_point(a: F64, b: F64) -> tuple[float, float]:
    """Return the mean of the corners within the other box; midway between the centres where boxes cross."""
    sum_x, sum_y, count = 0.0, 0.0, 0
    for side in range(2):
        own, other = (a, b) if side == 0 else (b, a)
        for corner in range(4):
            local_x = own[HALF_X] if corner & 1 else -own[HALF_X]
            local_y = own[HALF_Y] if corner & 2 else -own[HALF_Y]
            x = own[X] + own[COS] * local_x - own[SIN] * local_y
            y = own[Y] + own[SIN] * local_x + own[COS] * local_y
            away_x, away_y = x - other[X], y - other[Y]
            inside_x = abs(away_x * other[COS] + away_y * other[SIN]) <= other[HALF_X] + 1e-9
            if inside_x and abs(away_y * other[COS] - away_x * other[SIN]) <= other[HALF_Y] + 1e-9:
                sum_x, sum_y, count = sum_x + x, sum_y + y, count + 1
    if count == 0:
        return 0.5 * (a[X] + b[X]), 0.5 * (a[Y] + b[Y])
    return sum_x / count, sum_y / count
