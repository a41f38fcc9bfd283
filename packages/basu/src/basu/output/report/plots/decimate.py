"""Fewer points for the same picture: curves keep their extremes, paths stay within a tolerance."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from shapely import LineString, get_coordinates

if TYPE_CHECKING:
    from numpy.typing import NDArray

BUCKETS = 700  # about one for each pixel column of a chart


def curve(values: NDArray[np.float64], buckets: int = BUCKETS) -> list[NDArray[np.int64]]:
    """Return which of ``values`` (T,) to draw: one array of indices for each stretch without nan.

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
    """Return the polyline through ``points_m`` (N, 2) with fewer points, within the tolerance of all those given."""
    points = points_m[:, :2]
    if len(points) > 2:
        points = get_coordinates(LineString(points).simplify(tolerance_m, preserve_topology=False))
    return [(x_m, y_m) for x_m, y_m in points.tolist()]
