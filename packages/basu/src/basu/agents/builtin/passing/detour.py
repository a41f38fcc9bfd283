"""A path that leaves the middle of the lane for a while: aside over a stretch, along, and back."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.agents.builtin.driving.path import SPACING_M, SampledPath
from basu.agents.builtin.driving.speed_profile import bend_limit_mps

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.agents.builtin.driving.manner import Manner

STEEPEST = 10.0 / math.sqrt(3.0)  # the greatest second derivative of the step below, at (3 - √3) / 6 of its way
TIGHTEST_1PM = 0.16  # curvature that any road vehicle steers at walking pace: a radius of 6.3 m
JERK_SHARE = 3.0  # a detour may be felt this much more than a bend, for it is soon over


class Extent(NamedTuple):
    """Where a detour leaves the lane, is all the way aside, begins to come back, and is back; arc lengths in m."""

    from_s_m: float
    aside_s_m: float
    until_s_m: float
    to_s_m: float


class Detour(NamedTuple):
    """A shifted path; outside of its extent it is the path it was made from."""

    path: SampledPath
    extent: Extent
    offset_m: float  # when all the way aside, positive to the right
    speed_mps: float  # how fast it may be driven


def swing_m(offset_m: float, speed_mps: float, lateral_accel_mps2: float) -> float:
    """The length on which one gets ``offset_m`` aside at a speed with no more than that sideways."""
    return speed_mps * math.sqrt(STEEPEST * abs(offset_m) / lateral_accel_mps2)


def tightest_swing_m(offset_m: float) -> float:
    """The shortest length on which a vehicle gets aside at all."""
    return math.sqrt(STEEPEST * abs(offset_m) / TIGHTEST_1PM)


def make_detour(
    path: SampledPath, extent: Extent, offset_m: float, manner: Manner, top_mps: float, begin_m: float = 0.0
) -> Detour:
    """Shift a path to the right by ``offset_m`` (negative: to the left), beginning ``begin_m`` beside it.

    The shift is the polynomial step of least jerk, 10 t³ - 15 t⁴ + 6 t⁵ (Flash and Hogan 1985, appendix A): position,
    heading and curvature are continuous. Heading and arc are those of a curve parallel to another at distance d(s):
    the tangent is (1 - k d, d').
    """
    first, end = path.index_at(extent.from_s_m - 1.0), path.index_at(extent.to_s_m + 1.0) + 1
    s_m = np.asarray(path.s_m[first:end])
    shift_m = begin_m + (offset_m - begin_m) * _step(s_m, extent.from_s_m, extent.aside_s_m)
    shift_m -= offset_m * _step(s_m, extent.until_s_m, extent.to_s_m)
    heading_rad = np.asarray(path.heading_rad[first:end])
    curvature_1pm = np.asarray(path.curvature_1pm[first:end])
    forward = 1.0 - curvature_1pm * shift_m
    sideways = np.gradient(shift_m, SPACING_M)
    arc_m = np.maximum(SPACING_M * np.hypot(forward, sideways), SPACING_M / 4.0)
    turned_rad = heading_rad + np.arctan2(sideways, forward)
    bent_1pm = np.gradient(turned_rad) / arc_m
    points_m = path.points_m.copy()
    points_m[first:end, 0] -= shift_m * np.sin(heading_rad)
    points_m[first:end, 1] += shift_m * np.cos(heading_rad)
    slow_mps = bend_limit_mps(
        bent_1pm, SPACING_M, manner.lateral_accel_mps2, JERK_SHARE * manner.lateral_jerk_mps3
    ).min()
    shifted = SampledPath(
        points_m=points_m,
        x_m=_replaced(path.x_m, first, points_m[first:end, 0]),
        y_m=_replaced(path.y_m, first, points_m[first:end, 1]),
        s_m=path.s_m,
        heading_rad=_replaced(path.heading_rad, first, turned_rad),
        curvature_1pm=_replaced(path.curvature_1pm, first, bent_1pm),
    )
    return Detour(shifted, extent, offset_m, min(top_mps, float(slow_mps)))


def _step(s_m: NDArray[np.float64], from_s_m: float, to_s_m: float) -> NDArray[np.float64]:
    """0 before a stretch, 1 behind it, smoothly between."""
    t = np.clip((s_m - from_s_m) / max(to_s_m - from_s_m, 1e-6), 0.0, 1.0)
    return np.asarray(t * t * t * (10.0 + t * (6.0 * t - 15.0)))


def _replaced(values: list[float], first: int, new: NDArray[np.float64]) -> list[float]:
    """A copy with some of the values others."""
    return [*values[:first], *new.tolist(), *values[first + len(new) :]]
