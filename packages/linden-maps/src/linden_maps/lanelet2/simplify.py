"""Polylines with fewer points: all of a map at once, each within a tolerance of what it was."""

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]


def kept_points(points: F64, first: I64, tolerance_m: float) -> NDArray[np.bool_]:
    """Return which points (N, 3) of consecutive polylines stay; ``first`` are the indices of their first points.

    The method is that of Douglas and Peucker (1973), one level of all polylines in each pass. A stretch between two
    kept points with a farthest point beyond the tolerance is cut there.
    """
    count = len(points)
    kept = np.zeros(count, dtype=np.bool_)
    if not count:
        return kept
    last = np.append(first[1:], count) - 1
    kept[first] = kept[last] = True
    low, high = first, last
    while True:
        wide = high - low > 1
        low, high = low[wide], high[wide]
        if not len(low):
            return kept
        inner = high - low - 1
        begin = np.cumsum(inner) - inner
        stretch = np.repeat(np.arange(len(low)), inner)
        index = np.arange(len(stretch)) - begin[stretch] + low[stretch] + 1
        away = _distances(points[index], points[low][stretch], points[high][stretch])
        farthest = np.maximum.reduceat(away, begin)
        cut = farthest > tolerance_m
        if not cut.any():
            return kept
        hit = np.flatnonzero(away == farthest[stretch])
        at = index[hit[np.searchsorted(stretch[hit], np.arange(len(low)))]]
        low, high, at = low[cut], high[cut], at[cut]
        kept[at] = True
        low, high = np.concatenate([low, at]), np.concatenate([at, high])


def _distances(points: F64, start: F64, end: F64) -> F64:
    """Return how far points lie from their chords."""
    chord, away = end - start, points - start
    length = np.maximum((chord * chord).sum(axis=1), 1e-18)
    share = np.clip((away * chord).sum(axis=1) / length, 0.0, 1.0)
    distance: F64 = np.linalg.norm(away - share[:, None] * chord, axis=1)
    return distance
