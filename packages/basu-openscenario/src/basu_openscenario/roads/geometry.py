"""Reference lines of roads: lines, arcs, clothoids and cubic curves, evaluated in double precision."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

_ON_BOTH_SIDES = np.polynomial.legendre.leggauss(16)
_NODES, _WEIGHTS = (_ON_BOTH_SIDES[0] + 1.0) / 2.0, _ON_BOTH_SIDES[1] / 2.0  # on [0, 1]
_STRAIGHT = 1e-12  # 1/m; a curve with less is a line


class LinePoint(NamedTuple):
    """A point of a curve: m, rad and 1/m; curvature is positive to the left."""

    x_m: float
    y_m: float
    h_rad: float
    curvature_per_m: float


@dataclass(frozen=True, slots=True)
class Clothoid:
    """A curve with a curvature that is a linear function of its length; lines and arcs are special cases."""

    s_m: float
    x_m: float
    y_m: float
    h_rad: float
    length_m: float
    curvature_per_m: float = 0.0
    change_per_m2: float = 0.0

    def at(self, along_m: float) -> LinePoint:
        """Return the point ``along_m`` from the start of the curve.

        Gauss-Legendre quadrature over parts that turn by less than 1 rad: exact to 1e-12 m.
        """
        start, change = self.curvature_per_m, self.change_per_m2
        heading = self.h_rad + start * along_m + 0.5 * change * along_m * along_m
        curvature = start + change * along_m
        if abs(start) < _STRAIGHT and abs(change) < _STRAIGHT:
            x_m, y_m = along_m * math.cos(self.h_rad), along_m * math.sin(self.h_rad)
        elif abs(change) < _STRAIGHT:
            x_m = (math.sin(heading) - math.sin(self.h_rad)) / start
            y_m = (math.cos(self.h_rad) - math.cos(heading)) / start
        else:
            parts = 1 + int(max(abs(start), abs(curvature)) * abs(along_m))
            at_m = ((np.arange(parts)[:, None] + _NODES) * (along_m / parts)).ravel()
            angles = self.h_rad + start * at_m + 0.5 * change * at_m * at_m
            weights = np.tile(_WEIGHTS, parts) * (along_m / parts)
            x_m, y_m = float(weights @ np.cos(angles)), float(weights @ np.sin(angles))
        return LinePoint(self.x_m + x_m, self.y_m + y_m, heading, curvature)


Cubic = tuple[float, float, float, float]


def cubic(coefficients: Cubic, at: float) -> float:
    """Return a + b·at + c·at² + d·at³."""
    a, b, c, d = coefficients
    return a + at * (b + at * (c + at * d))


def slope(coefficients: Cubic, at: float) -> float:
    """Return the derivative of `cubic`."""
    _, b, c, d = coefficients
    return b + at * (2.0 * c + at * 3.0 * d)


def bend(coefficients: Cubic, at: float) -> float:
    """Return the second derivative of `cubic`."""
    return 2.0 * coefficients[2] + 6.0 * coefficients[3] * at


@dataclass(frozen=True, slots=True)
class CubicCurve:
    """A pair of cubic functions u(p) and v(p) in the axes of the start, with p by the length of the curve."""

    s_m: float
    x_m: float
    y_m: float
    h_rad: float
    length_m: float
    u: Cubic
    v: Cubic
    lengths_m: tuple[float, ...]
    """The arc length at equally spaced values of p."""
    last_p: float

    def at(self, along_m: float) -> LinePoint:
        """Return the point ``along_m`` from the start of the curve."""
        share = along_m / self.lengths_m[-1]
        if 0.0 <= share <= 1.0:
            p = float(np.interp(along_m, self.lengths_m, np.linspace(0.0, self.last_p, len(self.lengths_m))))
        else:
            p = share * self.last_p
        du, dv = slope(self.u, p), slope(self.v, p)
        u, v = cubic(self.u, p), cubic(self.v, p)
        cos, sin = math.cos(self.h_rad), math.sin(self.h_rad)
        curvature = (du * bend(self.v, p) - dv * bend(self.u, p)) / max((du * du + dv * dv) ** 1.5, 1e-12)
        heading = self.h_rad + math.atan2(dv, du)
        return LinePoint(self.x_m + u * cos - v * sin, self.y_m + u * sin + v * cos, heading, curvature)


def cubic_curve(
    s_m: float, start: tuple[float, float, float], length_m: float, u: Cubic, v: Cubic, last_p: float | None
) -> CubicCurve:
    """Return the curve of ``paramPoly3`` or ``poly3``.

    Args:
        s_m: where it begins along the road.
        start: x and y in m, and the heading in rad.
        length_m: of the curve.
        u: along the heading of the start.
        v: to its left.
        last_p: the parameter at the end; None: the parameter at which the arc has the length of the curve.
    """
    steps = max(64, int(length_m * 4.0))
    end = length_m if last_p is None else last_p
    if last_p is None:
        for _ in range(8):  # Newton: the end of a curve of known length
            reached = _arc_lengths(u, v, end, steps)[-1]
            speed = math.hypot(slope(u, end), slope(v, end))
            end -= (reached - length_m) / max(speed, 1e-9)
    return CubicCurve(s_m, *start, length_m, u, v, tuple(_arc_lengths(u, v, end, steps)), end)


def _arc_lengths(u: Cubic, v: Cubic, end: float, steps: int) -> list[float]:
    """Return the arc length at ``steps + 1`` equally spaced parameters from 0 to ``end``, in m."""
    edges = np.linspace(0.0, end, steps + 1)
    p = edges[:-1, None] + _NODES * (end / steps)
    du = u[1] + p * (2.0 * u[2] + p * 3.0 * u[3])
    dv = v[1] + p * (2.0 * v[2] + p * 3.0 * v[3])
    pieces = (np.hypot(du, dv) @ _WEIGHTS) * (end / steps)
    return [0.0, *np.cumsum(pieces).tolist()]


Curve = Clothoid | CubicCurve
