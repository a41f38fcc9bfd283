"""Spatial index of the plane: bins of things around a point, and near neighbours of many points.

The bins are arrays that kernels can walk.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

BIN_M = 16.0
_MOST_BINS = 1_000_000


class Bins(NamedTuple):
    """Square bins in rows; a thing is in every bin that the square around its circle touches."""

    start: I32  # (bins + 1,): where the things of a bin begin in ``items``
    items: I32  # numbers of things, ascending within a bin
    frame: F64  # (5,): x0, y0, bins per metre, bins in x, bins in y


def bins_of(centre_m: F64, radius_m: F64) -> Bins:
    """Return the bins of circles with centres (M, 2) and radii (M,)."""
    if len(centre_m) == 0:
        return Bins(np.zeros(2, np.int32), np.empty(0, np.int32), np.array([0.0, 0.0, 1.0 / BIN_M, 1.0, 1.0]))
    low = (centre_m - radius_m[:, None]).min(axis=0)
    size = (centre_m + radius_m[:, None]).max(axis=0) - low
    bin_m = max(BIN_M, math.sqrt(float(size[0] * size[1]) / _MOST_BINS))
    counts = (np.floor(size / bin_m) + 1.0).astype(np.int64)
    first = np.floor((centre_m - radius_m[:, None] - low) / bin_m).astype(np.int64)
    last = np.minimum(np.floor((centre_m + radius_m[:, None] - low) / bin_m).astype(np.int64), counts - 1)
    wide, tall = (last - first + 1).T
    item = np.repeat(np.arange(len(centre_m)), wide * tall)
    nth = np.arange(len(item)) - np.repeat(np.cumsum(wide * tall) - wide * tall, wide * tall)
    number = (first[item, 1] + nth // wide[item]) * counts[0] + first[item, 0] + nth % wide[item]
    order = np.argsort(number, kind="stable")  # things stay ascending within a bin
    start = np.concatenate([[0], np.cumsum(np.bincount(number, minlength=int(counts[0] * counts[1])))])
    frame = np.array([low[0], low[1], 1.0 / bin_m, float(counts[0]), float(counts[1])])
    return Bins(start.astype(np.int32), item[order].astype(np.int32), frame)


def items_near(bins: Bins, x_m: float, y_m: float, reach_m: float) -> NDArray[np.int64]:
    """Return all things, ascending, with bins that a square of half size ``reach_m`` around a point touches."""
    x0, y0, per_m, columns, rows = bins.frame.tolist()
    first_column, last_column = (math.floor((x_m + side - x0) * per_m) for side in (-reach_m, reach_m))
    first_row, last_row = (math.floor((y_m + side - y0) * per_m) for side in (-reach_m, reach_m))
    found: list[NDArray[np.int32]] = []
    for row in range(max(0, first_row), min(int(rows) - 1, last_row) + 1):
        left = row * int(columns) + max(0, first_column)
        right = row * int(columns) + min(int(columns) - 1, last_column)
        if right >= left:
            found.append(bins.items[bins.start[left] : bins.start[right + 1]])
    return np.unique(np.concatenate(found)).astype(np.int64) if found else np.empty(0, np.int64)


def nearby(places_m: F64, things_m: F64, reach_m: ArrayLike) -> NDArray[np.bool_]:
    """Return which places (N, 2) have one of the things (M, 2) nearer than its reach, a number or (M,).

    Things are sorted from west to east, so that each place is compared with those of a strip alone.
    """
    order = np.argsort(things_m[:, 0], kind="stable")
    things, reach = things_m[order], np.broadcast_to(np.asarray(reach_m, np.float64), len(things_m))[order]
    widest = reach.max(initial=0.0)
    first = np.searchsorted(things[:, 0], places_m[:, 0] - widest)
    count = np.searchsorted(things[:, 0], places_m[:, 0] + widest) - first
    place = np.repeat(np.arange(len(places_m)), count)
    thing = np.arange(len(place)) + np.repeat(first - np.cumsum(count) + count, count)
    away = places_m[place] - things[thing]
    near = np.zeros(len(places_m), bool)
    near[place[away[:, 0] ** 2 + away[:, 1] ** 2 < reach[thing] ** 2]] = True
    return near
