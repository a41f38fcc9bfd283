"""The slow and obvious version of each physics kernel: loops over everything, matrices, bisection. For tests only."""

import itertools
import math
from collections.abc import Callable, Sequence

import numpy as np

Point = tuple[float, float]


def surface(vertices: np.ndarray, triangles: np.ndarray, x: float, y: float, highest: float) -> float | None:
    """The highest triangle over (x, y) that is not above ``highest``: all are tried, by solving for the weights."""
    best = None
    for a, b, c in vertices[triangles]:
        edges = np.array([b - a, c - a])[:, :2].T
        if abs(np.linalg.det(edges)) < 1e-9:
            continue
        u, v = np.linalg.solve(edges, np.array([x, y]) - a[:2])
        if min(u, v, 1.0 - u - v) >= -1e-4:
            z = float(a[2] + u * (b - a)[2] + v * (c - a)[2])
            if z <= highest and (best is None or z > best):
                best = z
    return best


def corners(box: Sequence[float]) -> list[Point]:
    """The corners, in order, of a box given as x, y, cosine, sine, half x, half y (and low, high)."""
    x, y, cosine, sine, half_x, half_y = box[:6]
    signs = ((1, 1), (-1, 1), (-1, -1), (1, -1))
    return [
        (x + cosine * sx * half_x - sine * sy * half_y, y + sine * sx * half_x + cosine * sy * half_y)
        for sx, sy in signs
    ]


def clip(polygon: list[Point], edge_from: Point, edge_to: Point) -> list[Point]:
    """What of a polygon lies left of a line (Sutherland and Hodgman 1974)."""

    def side(p: Point) -> float:
        return (edge_to[0] - edge_from[0]) * (p[1] - edge_from[1]) - (edge_to[1] - edge_from[1]) * (p[0] - edge_from[0])

    kept = []
    for p, q in zip(polygon, polygon[1:] + polygon[:1], strict=True):
        if side(p) >= 0.0:
            kept.append(p)
        if side(p) * side(q) < 0.0:
            t = side(p) / (side(p) - side(q))
            kept.append((p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])))
    return kept


def shared_area(a: Sequence[float], b: Sequence[float]) -> float:
    """The area in which two boxes overlap, seen from above."""
    polygon, frame = corners(a), corners(b)
    for edge_from, edge_to in zip(frame, frame[1:] + frame[:1], strict=True):
        polygon = clip(polygon, edge_from, edge_to)
        if not polygon:
            return 0.0
    pairs = zip(polygon, polygon[1:] + polygon[:1], strict=True)
    return 0.5 * abs(sum(p[0] * q[1] - q[0] * p[1] for p, q in pairs))


def near_pairs(circles: Sequence[tuple[float, float, float]], fixed: Sequence[bool]) -> list[tuple[int, int]]:
    """All pairs whose circles (x, y, radius) meet and of which one can move."""
    return [
        (i, j)
        for i, j in itertools.combinations(range(len(circles)), 2)
        if math.dist(circles[i][:2], circles[j][:2]) < circles[i][2] + circles[j][2] and not (fixed[i] and fixed[j])
    ]


def brush(use: float) -> float:
    """The force of a brush tyre over its limit, by adding up bristles under a parabola of pressure.

    A bristle at s in 0..1 of the contact from its front has stretched in proportion to s; it holds while that needs
    less than friction times the pressure 6 s (1 - s) (of mean 1). ``use`` is the force with all bristles holding.
    """
    places = (np.arange(20_000) + 0.5) / 20_000
    return float(np.minimum(2.0 * use * places, 6.0 * places * (1.0 - places)).mean())


def on_curve(x: float, points: Sequence[Point]) -> float:
    return float(np.interp(x, [p[0] for p in points], [p[1] for p in points]))


def bisect(function: Callable[[float], float], low: float, high: float) -> float:
    """Where a falling function passes zero."""
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if function(middle) > 0.0 else (low, middle)
    return 0.5 * (low + high)
