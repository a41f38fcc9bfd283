"""The cells of a voxel grid that hold points: a hash table in arrays, and the compiled code over it.

Sums are whole numbers, so a cell's mean does not depend on the order in which its points came.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kernel

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
U32 = NDArray[np.uint32]

EMPTY = -1
STEPS = 65_536
"""Where in its cell a point lies is kept in so many steps: a micrometre of a cell of 0.1 m."""
MOST_AVERAGED = 65_536
"""Points of a cell that count for its mean: so many sums of STEPS fit into 32 bits."""
TILE_BITS = 8
"""A tile is 2**8 cells wide and deep, and as high as there are points."""
_FARTHEST_CELL = 2.0**30
_LOW_32 = 0xFFFF_FFFF
_SPREAD = np.uint64(0x9E3779B97F4A7C15)  # 2**64 over the golden ratio: Knuth, The Art of Computer Programming, 6.4


class Cells(NamedTuple):
    """A hash table with linear probing; as many places as a power of two, EMPTY in ``key`` where nothing is."""

    key: I64  # (S,) of the cell in its tile
    steps: U32  # (S, 3) summed over the points
    points: U32  # (S,) that count
    label: U32  # (S,) of the first point that came


class Located(NamedTuple):
    """Points on the grid, (N,) each."""

    tile: I64
    key: I64
    steps: U32  # (N, 3)


def empty(places: int) -> Cells:
    """Return a table of a power of two places."""
    return Cells(
        np.full(places, EMPTY, np.int64),
        np.zeros((places, 3), np.uint32),
        np.zeros(places, np.uint32),
        np.zeros(places, np.uint32),
    )


@kernel
def locate(points_m: F64, voxel_m: float, tile: I64, key: I64, steps: U32) -> int:
    """Write the tile, the cell and the steps within it of points (N, 3); return the first that is too far, or -1."""
    cell = np.empty(3, np.int64)
    for row in range(len(points_m)):
        for axis in range(3):
            at = points_m[row, axis] / voxel_m
            whole = np.floor(at)
            if not abs(whole) < _FARTHEST_CELL:
                return row
            cell[axis] = np.int64(whole)
            steps[row, axis] = np.uint32(min(STEPS - 1.0, np.floor((at - whole) * STEPS)))
        tile[row] = ((cell[0] >> TILE_BITS) << 32) | ((cell[1] >> TILE_BITS) & _LOW_32)
        inside = (1 << TILE_BITS) - 1
        height = cell[2] + (1 << 30)
        key[row] = (height << (2 * TILE_BITS)) | ((cell[1] & inside) << TILE_BITS) | (cell[0] & inside)
    return -1


@kernel
def _place_of(keys: I64, key: int) -> int:
    """Return the place of a cell, or the empty one where it belongs."""
    mask = np.uint64(len(keys) - 1)
    place = (np.uint64(key) * _SPREAD >> np.uint64(32)) & mask
    while keys[place] != EMPTY and keys[place] != key:
        place = (place + np.uint64(1)) & mask
    return int(place)


@kernel
def insert(cells: Cells, rows: I64, key: I64, steps: U32, label: U32) -> int:
    """Add the points of these rows; the table has room. Return how many cells are new."""
    new = 0
    for row in rows:
        place = _place_of(cells.key, key[row])
        if cells.key[place] == EMPTY:
            cells.key[place] = key[row]
            cells.label[place] = label[row]
            new += 1
        if cells.points[place] < MOST_AVERAGED:
            cells.points[place] += np.uint32(1)
            for axis in range(3):
                cells.steps[place, axis] += steps[row, axis]
    return new


@kernel
def refill(cells: Cells, bigger: Cells) -> None:
    """Put every cell of a table into an empty one that has room."""
    for old in range(len(cells.key)):
        if cells.key[old] != EMPTY:
            place = _place_of(bigger.key, cells.key[old])
            bigger.key[place] = cells.key[old]
            bigger.points[place] = cells.points[old]
            bigger.label[place] = cells.label[old]
            for axis in range(3):
                bigger.steps[place, axis] = cells.steps[old, axis]


def packed(cells: Cells) -> Cells:
    """Return the cells alone, by height, then y, then x."""
    used = np.flatnonzero(cells.key != EMPTY)
    used = used[np.argsort(cells.key[used])]
    return Cells(cells.key[used], cells.steps[used], cells.points[used], cells.label[used])


def middles(cells: Cells, tile: int, voxel_m: float) -> F64:
    """Return the means (N, 3) of the points of packed cells, m."""
    inside = (1 << TILE_BITS) - 1
    x, y = tile >> 32, (tile & _LOW_32) - ((tile & 0x8000_0000) << 1)  # the lower half has a sign of its own
    cell = np.stack(
        [
            (x << TILE_BITS) + (cells.key & inside),
            (y << TILE_BITS) + (cells.key >> TILE_BITS & inside),
            (cells.key >> 2 * TILE_BITS) - (1 << 30),
        ],
        axis=1,
    )
    means: F64 = (cell + (cells.steps / cells.points[:, None] + 0.5) / STEPS) * voxel_m
    return means
