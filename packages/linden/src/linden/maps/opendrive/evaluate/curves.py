"""Reference lines in plan: lines, arcs, spirals and parametric cubics, many at once."""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.maps.opendrive.evaluate.pieces import F64, I64, bases_of
from linden.maps.opendrive.model import Arc, Geometry, ParamPoly3, Spiral

_LINE, _ARC, _SPIRAL, _PARAMETRIC = range(4)

# Gauss-Legendre nodes on [0, 1]; a spiral is walked in panels, so that none turns far enough to lose a digit.
_NODES = (np.polynomial.legendre.leggauss(8)[0] + 1.0) / 2.0
_WEIGHTS = np.polynomial.legendre.leggauss(8)[1] / 2.0
_SPIRAL_PANELS = 4
# A parametric cubic's arc length is tabulated at this many steps of its parameter, then refined by Newton's method.
_PARAMETER_STEPS = 16
_NEWTON_STEPS = 3


class Pose(NamedTuple):
    """Points of a curve in OpenDRIVE's frame: m, m, rad; all (N,)."""

    x_m: F64
    y_m: F64
    heading_rad: F64


class Curves(NamedTuple):
    """All geometries of a map, sorted by road and s; shape parameters in ``u``, ``v`` (curvatures in ``u``)."""

    base_m: F64  # (roads,)
    first: I64  # (roads,)
    key_m: F64  # (geometries,)
    start_m: F64
    x_m: F64
    y_m: F64
    heading_rad: F64
    length_m: F64
    kind: NDArray[np.int8]
    u: F64  # (geometries, 4)
    v: F64  # (geometries, 4)
    p_end: F64
    arc_length_m: F64  # (geometries, _PARAMETER_STEPS + 1), cumulative; zeros where not parametric

    def find(self, road: I64, s_m: F64) -> I64:
        """Return the geometry that holds for each road index at each s."""
        return np.maximum(np.searchsorted(self.key_m, self.base_m[road] + s_m, side="right") - 1, self.first[road])

    def pose(self, road: I64, s_m: F64, probe_m: F64 | None = None) -> Pose:
        """Return the reference line at s; ``probe_m`` chooses the geometry instead of s."""
        return self.pose_on(self.find(road, s_m if probe_m is None else probe_m), s_m)

    def pose_on(self, geometry: I64, s_m: F64) -> Pose:
        """Return points of given geometries; beyond a geometry's ends it is carried on."""
        along = s_m - self.start_m[geometry]
        local = np.empty((3, len(along)))  # x, y, heading in the frame of the geometry's start
        kind = self.kind[geometry]
        for value, local_of in ((_LINE, _line), (_ARC, _arc), (_SPIRAL, _spiral), (_PARAMETRIC, _parametric)):
            chosen = np.flatnonzero(kind == value)
            if len(chosen):
                local[:, chosen] = local_of(self, geometry[chosen], along[chosen])
        heading = self.heading_rad[geometry]
        cos, sin = np.cos(heading), np.sin(heading)
        return Pose(
            self.x_m[geometry] + cos * local[0] - sin * local[1],
            self.y_m[geometry] + sin * local[0] + cos * local[1],
            heading + local[2],
        )

    def sharpest_per_m(self) -> F64:
        """Return the greatest curvature of each geometry in 1/m (of a parametric one, as sampled)."""
        sharpest: F64 = np.abs(self.u[:, :2]).max(axis=1)
        sharpest[self.kind == _LINE] = 0.0
        parametric = np.flatnonzero(self.kind == _PARAMETRIC)
        if len(parametric):
            p = np.linspace(0.0, 1.0, 2 * _PARAMETER_STEPS + 1) * self.p_end[parametric, None]
            du, dv = _derivative(self.u[parametric], p), _derivative(self.v[parametric], p)
            ddu, ddv = _second_derivative(self.u[parametric], p), _second_derivative(self.v[parametric], p)
            speed = np.maximum(np.hypot(du, dv), 1e-9)
            sharpest[parametric] = np.abs((du * ddv - dv * ddu) / speed**3).max(axis=1)
        return sharpest


def curves_of(reference_lines: Sequence[Sequence[Geometry]], lengths_m: Sequence[float]) -> Curves:
    """Flatten the reference lines of all roads."""
    rows: list[tuple[float, ...]] = []
    first: list[int] = []
    for line in reference_lines:
        first.append(len(rows))
        rows.extend(_row(geometry) for geometry in sorted(line, key=lambda geometry: geometry.s_m))
    table = np.asarray(rows, dtype=np.float64).reshape(-1, 15)
    base_m = bases_of(lengths_m) if first else np.empty(0)
    first_index = np.asarray(first, dtype=np.int64)
    counts = np.diff(np.append(first_index, len(rows)))
    kind = table[:, 5].astype(np.int8)
    u, v, p_end = table[:, 6:10], table[:, 10:14], table[:, 14]
    return Curves(
        base_m=base_m,
        first=first_index,
        key_m=np.repeat(base_m, counts) + table[:, 0],
        start_m=table[:, 0],
        x_m=table[:, 1],
        y_m=table[:, 2],
        heading_rad=table[:, 3],
        length_m=table[:, 4],
        kind=kind,
        u=u,
        v=v,
        p_end=p_end,
        arc_length_m=_arc_lengths(kind, u, v, p_end),
    )


def _row(geometry: Geometry) -> tuple[float, ...]:
    shape = geometry.shape
    if isinstance(shape, Arc):
        kind, u, v, p_end = _ARC, (shape.curvature, 0.0, 0.0, 0.0), _ZEROS, 0.0
    elif isinstance(shape, Spiral):
        kind, u, v, p_end = _SPIRAL, (shape.curvature_start, shape.curvature_end, 0.0, 0.0), _ZEROS, 0.0
    elif isinstance(shape, ParamPoly3):
        kind, u, v, p_end = _PARAMETRIC, shape.u, shape.v, shape.p_end
    else:
        kind, u, v, p_end = _LINE, _ZEROS, _ZEROS, 0.0
    return (*geometry[:5], kind, *u, *v, p_end)


_ZEROS = (0.0, 0.0, 0.0, 0.0)


def _line(_curves: Curves, _geometry: I64, along: F64) -> F64:
    return np.stack([along, np.zeros_like(along), np.zeros_like(along)])


def _arc(curves: Curves, geometry: I64, along: F64) -> F64:
    turn = curves.u[geometry, 0] * along
    # chord of length along * sinc(turn / 2), in the direction of half the turn: exact also where the curvature is tiny
    chord = along * np.sinc(turn / (2.0 * np.pi))
    return np.stack([chord * np.cos(turn / 2.0), chord * np.sin(turn / 2.0), turn])


def _spiral(curves: Curves, geometry: I64, along: F64) -> F64:
    """Integrate the unit tangent; the heading of a clothoid is a square of the way (no Fresnel tables needed)."""
    start = curves.u[geometry, 0]
    change = (curves.u[geometry, 1] - start) / curves.length_m[geometry]
    fractions = ((np.arange(_SPIRAL_PANELS)[:, None] + _NODES) / _SPIRAL_PANELS).ravel()
    weights = np.tile(_WEIGHTS / _SPIRAL_PANELS, _SPIRAL_PANELS)
    way = along[:, None] * fractions
    heading = way * (start[:, None] + 0.5 * change[:, None] * way)
    return np.stack(
        [
            along * (np.cos(heading) @ weights),
            along * (np.sin(heading) @ weights),
            along * (start + 0.5 * change * along),
        ]
    )


def _parametric(curves: Curves, geometry: I64, along: F64) -> F64:
    """Find the parameter at the arc length ``along``, as LibCarla does with its table of chords (Geometry.cpp)."""
    u, v = curves.u[geometry], curves.v[geometry]
    table = curves.arc_length_m[geometry]
    step = curves.p_end[geometry] / _PARAMETER_STEPS
    cell = np.clip((table <= along[:, None]).sum(axis=1) - 1, 0, _PARAMETER_STEPS - 1)
    row = np.arange(len(along))
    low_m, high_m = table[row, cell], table[row, cell + 1]
    low_p = cell * step
    p = low_p + step * (along - low_m) / np.maximum(high_m - low_m, 1e-12)
    for _ in range(_NEWTON_STEPS):
        speed = np.hypot(_derivative(u, p[:, None])[:, 0], _derivative(v, p[:, None])[:, 0])
        p = p - (low_m + _arc_length(u, v, low_p, p) - along) / np.maximum(speed, 1e-9)
    at = p[:, None]
    heading = np.arctan2(_derivative(v, at)[:, 0], _derivative(u, at)[:, 0])
    return np.stack([_polynomial(u, at)[:, 0], _polynomial(v, at)[:, 0], heading])


def _arc_lengths(kind: NDArray[np.int8], u: F64, v: F64, p_end: F64) -> F64:
    table = np.zeros((len(kind), _PARAMETER_STEPS + 1))
    chosen = np.flatnonzero(kind == _PARAMETRIC)
    edges = np.linspace(0.0, 1.0, _PARAMETER_STEPS + 1)
    steps = [
        _arc_length(u[chosen], v[chosen], p_end[chosen] * low, p_end[chosen] * high) for low, high in pairwise(edges)
    ]
    table[chosen, 1:] = np.cumsum(np.stack(steps, axis=1), axis=1) if len(chosen) else 0.0
    return table


def _arc_length(u: F64, v: F64, low: F64, high: F64) -> F64:
    p = low[:, None] + (high - low)[:, None] * _NODES
    lengths: F64 = (high - low) * (np.hypot(_derivative(u, p), _derivative(v, p)) @ _WEIGHTS)
    return lengths


def _polynomial(coefficients: F64, p: F64) -> F64:
    a, b, c, d = coefficients.T[:, :, None]
    result: F64 = a + p * (b + p * (c + p * d))
    return result


def _derivative(coefficients: F64, p: F64) -> F64:
    _, b, c, d = coefficients.T[:, :, None]
    result: F64 = b + p * (2.0 * c + p * 3.0 * d)
    return result


def _second_derivative(coefficients: F64, p: F64) -> F64:
    _, _, c, d = coefficients.T[:, :, None]
    result: F64 = 2.0 * c + p * 6.0 * d
    return result
