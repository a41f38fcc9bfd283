"""Fewer points for the same picture, in linear time: curves keep their extremes, paths stay within a tolerance."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

BUCKETS = 700  # about one for each pixel column of a chart


def curve(values: NDArray[np.float64], buckets: int = BUCKETS) -> list[NDArray[np.int64]]:
    """Which of ``values`` (T,) to draw: one array of indices for each stretch without nan.

    A stretch keeps its ends, and of each bucket the least and the greatest value, so no extreme is lost.
    """
    finite = np.concatenate([[False], np.isfinite(values), [False]])
    edges = np.flatnonzero(np.diff(finite.astype(np.int8))).reshape(-1, 2)
    width = max(1, math.ceil(len(values) / buckets))
    return [first + _stretch(values[first:end], width) for first, end in edges.tolist()]


def _stretch(values: NDArray[np.float64], width: int) -> NDArray[np.int64]:
    """Indices into a stretch of finite values: its ends and the extremes of each ``width`` of them."""
    count = len(values)
    if width > 1:
        rows = math.ceil(count / width)
        padded = np.concatenate([values, np.full(rows * width - count, values[-1])]).reshape(rows, width)
        begin = np.arange(rows) * width
        extremes = np.concatenate([begin + padded.argmin(axis=1), begin + padded.argmax(axis=1)])
        kept = np.unique(np.concatenate([[0], np.minimum(extremes, count - 1), [count - 1]]))
    else:
        kept = np.arange(count)
    level = values[kept]
    inner = np.ones(len(kept), dtype=np.bool_)
    inner[1:-1] = (level[1:-1] != level[:-2]) | (level[1:-1] != level[2:])  # the middle of a level line is not needed
    thinned: NDArray[np.int64] = kept[inner]
    return thinned


def path(points_m: NDArray[np.float64], tolerance_m: float) -> list[tuple[float, float]]:
    """The polyline through ``points_m`` (N, 2) with fewer points, within the tolerance of all those given.

    Sleeve fitting, Zhao and Saalfeld 1997, "Linear-time sleeve-fitting polyline simplification algorithms": from an
    anchor on, each point leaves a sector of directions that pass it within the tolerance; where a point lies outside
    of all sectors before it, or comes back towards the anchor, the point before it becomes the next anchor.
    """
    points = [(float(x_m), float(y_m)) for x_m, y_m in points_m[:, :2].tolist()]
    if len(points) <= 2:
        return points
    kept = [points[0]]
    anchor = before = points[0]
    sleeve = _Sleeve(anchor, tolerance_m)
    for point in points[1:]:
        if not sleeve.takes(point):
            kept.append(before)
            anchor = before
            sleeve = _Sleeve(anchor, tolerance_m)
            sleeve.takes(point)
        before = point
    kept.append(before)
    return kept


class _Sleeve:
    """The directions in which a straight line from the anchor passes all points until now."""

    def __init__(self, anchor_m: tuple[float, float], tolerance_m: float) -> None:
        self._x_m, self._y_m = anchor_m
        self._tolerance_m = tolerance_m
        self._middle_rad: float | None = None  # the first direction; the bounds are relative to it
        self._low_rad, self._high_rad = -math.inf, math.inf
        self._reach_m = 0.0

    def takes(self, point_m: tuple[float, float]) -> bool:
        """Narrow the sleeve to ``point_m``; False where it does not fit in."""
        east_m, south_m = point_m[0] - self._x_m, point_m[1] - self._y_m
        distance_m = math.hypot(east_m, south_m)
        if distance_m <= self._tolerance_m:
            return self._reach_m == 0.0  # it has come back: what was farther away must not be lost
        heading_rad = math.atan2(south_m, east_m)
        if self._middle_rad is None:
            self._middle_rad = heading_rad
        turn_rad = math.remainder(heading_rad - self._middle_rad, math.tau)
        if distance_m < self._reach_m - self._tolerance_m or not self._low_rad <= turn_rad <= self._high_rad:
            return False
        half_rad = math.asin(self._tolerance_m / distance_m)
        self._low_rad = max(self._low_rad, turn_rad - half_rad)
        self._high_rad = min(self._high_rad, turn_rad + half_rad)
        self._reach_m = max(self._reach_m, distance_m)
        return True
