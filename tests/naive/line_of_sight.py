"""The obvious version of the line-of-sight test: walk along each ray and look whether it is inside of a box."""

import math
from collections.abc import Sequence

STEP_M = 0.02


def is_inside(point: Sequence[float], row: Sequence[float]) -> bool:
    """Whether a point lies in a box of x, y, z, half length, half width, half height, yaw."""
    dx, dy, dz = (p - c for p, c in zip(point, row[:3], strict=True))
    cos, sin = math.cos(row[6]), math.sin(row[6])
    along, across = dx * cos + dy * sin, dy * cos - dx * sin
    return abs(along) < row[3] and abs(across) < row[4] and abs(dz) < row[5]


def blocks(sensor: Sequence[float], point: Sequence[float], row: Sequence[float]) -> bool:
    """Whether a box lies wholly between the two: neither of them is inside of it, and a step of the way is."""
    if is_inside(sensor, row) or is_inside(point, row):
        return False
    steps = max(1, int(math.dist(sensor, point) / STEP_M))
    for number in range(1, steps):
        share = number / steps
        if is_inside([s + share * (p - s) for s, p in zip(sensor, point, strict=True)], row):
            return True
    return False
