"""Stretches of a drive: where something holds, from which frame to which; and the driven path in straight pieces."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

SPACING_M = 0.25  # between the points that a driven path is measured with: finer would add up jitter


class Chords(NamedTuple):
    """A driven path as straight pieces, each from the end of the one before."""

    length_m: NDArray[np.float64]  # (K,)
    end: NDArray[np.int64]  # (K,) the frame in which each ends


def stretches(holds: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """(first, end) of every unbroken stretch of frames in which ``holds`` (T,) is true."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], holds, [False]]).astype(np.int8)))
    return [(first, end) for first, end in edges.reshape(-1, 2).tolist()]


def chords(points_m: NDArray[np.float64]) -> Chords:
    """The path through ``points_m`` (T, 2), skipping points within ``SPACING_M`` of the last one taken.

    Equation 5.2 of the thesis by chords. The last point is always taken, so a path of two points has its full length.
    """
    x_m, y_m = points_m[:, 0].tolist(), points_m[:, 1].tolist()
    lengths: list[float] = []
    ends: list[int] = []
    last, final = 0, len(x_m) - 1
    for at in range(1, len(x_m)):
        chord_m = ((x_m[at] - x_m[last]) ** 2 + (y_m[at] - y_m[last]) ** 2) ** 0.5
        if chord_m >= SPACING_M or (at == final and chord_m > 0.0):
            lengths.append(chord_m)
            ends.append(at)
            last = at
    return Chords(np.array(lengths, dtype=np.float64), np.array(ends, dtype=np.int64))


def path_m(frames: NDArray[np.void]) -> NDArray[np.float64]:
    """(T, 2) where the vehicle's origin was, CARLA frame."""
    return np.column_stack([frames["x_m"], frames["y_m"]]).astype(np.float64)


def total_m(lengths_m: NDArray[np.float64]) -> float:
    """Their sum, added up in order: the same to the last bit on every machine."""
    return float(sum(lengths_m.tolist()))
