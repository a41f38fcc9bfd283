"""Lengths and places along polylines."""

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]


def lengths(line: F64) -> F64:
    """Return how far along a line each of its points (N, D) lies: (N,), from 0 on, in the unit of the points."""
    along: F64 = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    return along


def places_at(line: F64, along: F64, at: F64) -> F64:
    """Return the places (K, D) at some lengths ``at``; ``along`` (N,) are those of the line's points (N, D)."""
    return np.stack([np.interp(at, along, column) for column in line.T], axis=1)


def resampled(line: F64, count: int) -> F64:
    """Return so many places (count, D) along a line, evenly from its start to its end."""
    along = lengths(line)
    return places_at(line, along, np.linspace(0.0, along[-1], count))
