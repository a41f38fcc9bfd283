"""One tile of a map as a picture: what each cell of a grid is to a walker, and how high it lies, level over level.

A cell has up to ``LEVELS`` floors, so that a bridge and the street under it are two. Frame: CARLA's; cell (row, column)
covers y from row and x from column, in cells from the picture's corner.
"""

import math

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kernel

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]
U8 = NDArray[np.uint8]

VOID, EDGE, SIDEWALK, ROAD, CROSSWALK = range(5)
"""What a cell is. Of surfaces that overlap the higher number holds. EDGE is what lies between pavement and carriageway:
kerb, verge, median."""

LEVELS = 3
HEADROOM_M = 2.0
"""Surfaces nearer than this above one another are one floor; a walker's height is 1.8 m to the client."""
CLIMB_M = 0.5
"""What a walker steps up from one cell to the next, as physics/walker.py has it within a few cm."""


@kernel
def paint(corners_m: F64, kinds: U8, items: I32, frame: F64, kind: U8, z_m: F64) -> None:  # pragma: no cover - compiled
    """Paint the triangles ``items`` of ``corners_m`` (T, 3, 3) into ``kind`` and ``z_m`` (LEVELS, rows, columns).

    ``frame``: x and y of the picture's corner and the cell's size, in m.
    """
    rows, columns = kind.shape[1], kind.shape[2]
    cell = frame[2]
    for n in range(len(items)):
        t = corners_m[items[n]]
        x0, y0, z0 = t[0, 0], t[0, 1], t[0, 2]
        ax, ay, az = t[1, 0] - x0, t[1, 1] - y0, t[1, 2] - z0
        bx, by, bz = t[2, 0] - x0, t[2, 1] - y0, t[2, 2] - z0
        area = ax * by - ay * bx
        if abs(area) < 1e-9:
            continue
        low_column = max(0, math.ceil((min(x0, t[1, 0], t[2, 0]) - frame[0]) / cell - 0.5))
        high_column = min(columns - 1, math.floor((max(x0, t[1, 0], t[2, 0]) - frame[0]) / cell - 0.5))
        low_row = max(0, math.ceil((min(y0, t[1, 1], t[2, 1]) - frame[1]) / cell - 0.5))
        high_row = min(rows - 1, math.floor((max(y0, t[1, 1], t[2, 1]) - frame[1]) / cell - 0.5))
        for row in range(low_row, high_row + 1):
            for column in range(low_column, high_column + 1):
                dx = frame[0] + (column + 0.5) * cell - x0
                dy = frame[1] + (row + 0.5) * cell - y0
                u, v = (dx * by - dy * bx) / area, (ax * dy - ay * dx) / area
                if u >= -1e-6 and v >= -1e-6 and u + v <= 1.0 + 1e-6:
                    _lay(kind, z_m, row, column, kinds[items[n]], z0 + u * az + v * bz)


@kernel
def _lay(kind: U8, z_m: F64, row: int, column: int, new: int, new_z_m: float) -> None:  # pragma: no cover - compiled
    """Lay a surface onto the floor it belongs to, or make one of it; a crosswalk is paint and leaves the height."""
    for level in range(len(kind)):
        old = kind[level, row, column]
        if old == VOID:
            kind[level, row, column], z_m[level, row, column] = new, new_z_m
            return
        if abs(z_m[level, row, column] - new_z_m) < HEADROOM_M:
            if new == CROSSWALK:
                if old != SIDEWALK:
                    kind[level, row, column] = new
            elif new > old:
                kind[level, row, column], z_m[level, row, column] = new, new_z_m
            elif new == old:
                z_m[level, row, column] = max(new_z_m, z_m[level, row, column])
            return


@kernel
def _floor_beside(kind: U8, z_m: F64, row: int, column: int, from_z_m: float) -> int:  # pragma: no cover - compiled
    """Return the level on which a cell can be stepped onto from a height, -1 where there is none."""
    for level in range(len(kind)):
        if kind[level, row, column] != VOID and abs(z_m[level, row, column] - from_z_m) <= CLIMB_M:
            return level
    return -1


@kernel
def close_gaps(kind: U8, z_m: F64) -> None:  # pragma: no cover - compiled
    """Fill seams one cell wide: where two lanes meet, neither may cover the middle of a cell between them."""
    before = kind.copy()
    for row in range(1, kind.shape[1] - 1):
        for column in range(1, kind.shape[2] - 1):
            for level in range(len(kind)):
                if before[level, row, column] != VOID:
                    continue
                for down, right in ((0, 1), (1, 0)):
                    one = before[level, row - down, column - right]
                    other = before[level, row + down, column + right]
                    one_z = z_m[level, row - down, column - right]
                    other_z = z_m[level, row + down, column + right]
                    if VOID not in (one, other) and abs(one_z - other_z) <= CLIMB_M:
                        kind[level, row, column] = min(one, other)
                        z_m[level, row, column] = 0.5 * (one_z + other_z)


@kernel
def keep_clear(kind: U8, z_m: F64) -> None:  # pragma: no cover - compiled
    """Take away what lies within a cell of nothing, and give the pavement within a cell of the carriageway to its edge.

    The mesh holds the middle of a walker. So a walker keeps its shoulders off walls and out of the traffic.
    """
    before = kind.copy()
    for row in range(1, kind.shape[1] - 1):
        for column in range(1, kind.shape[2] - 1):
            for level in range(len(kind)):
                own = before[level, row, column]
                if own == VOID:
                    continue
                for n in range(9):
                    r, c = row + n // 3 - 1, column + n % 3 - 1
                    beside = _floor_beside(before, z_m, r, c, z_m[level, row, column])
                    if beside < 0:
                        kind[level, row, column] = VOID
                        break
                    if own == SIDEWALK and before[beside, r, c] == ROAD:
                        kind[level, row, column] = EDGE


@kernel
def block(
    centre_m: F64, half_m: F64, yaw_rad: F64, frame: F64, kind: U8, z_m: F64
) -> None:  # pragma: no cover - compiled
    """Take away the cells in which a box stands in the way of a body: (M, 3), (M, 3) and (M,)."""
    rows, columns = kind.shape[1], kind.shape[2]
    cell = frame[2]
    for n in range(len(centre_m)):
        cosine, sine = math.cos(yaw_rad[n]), math.sin(yaw_rad[n])
        reach = math.hypot(half_m[n, 0], half_m[n, 1])
        low_column = max(0, math.floor((centre_m[n, 0] - reach - frame[0]) / cell))
        high_column = min(columns - 1, math.ceil((centre_m[n, 0] + reach - frame[0]) / cell))
        low_row = max(0, math.floor((centre_m[n, 1] - reach - frame[1]) / cell))
        high_row = min(rows - 1, math.ceil((centre_m[n, 1] + reach - frame[1]) / cell))
        for row in range(low_row, high_row + 1):
            for column in range(low_column, high_column + 1):
                x = frame[0] + (column + 0.5) * cell - centre_m[n, 0]
                y = frame[1] + (row + 0.5) * cell - centre_m[n, 1]
                if abs(cosine * x + sine * y) > half_m[n, 0] or abs(cosine * y - sine * x) > half_m[n, 1]:
                    continue
                for level in range(len(kind)):
                    over_feet = centre_m[n, 2] - z_m[level, row, column]
                    if half_m[n, 2] + over_feet > 0.2 and over_feet - half_m[n, 2] < HEADROOM_M:
                        kind[level, row, column] = VOID


@kernel
def _flood(
    kind: U8, z_m: F64, seen: NDArray[np.bool_], stack: I32, first: tuple[int, int, int]
) -> int:  # pragma: no cover - compiled
    """Write into ``stack`` all cells (level, row, column) that can be reached from one; returns how many they are."""
    rows, columns = kind.shape[1], kind.shape[2]
    stack[0, 0], stack[0, 1], stack[0, 2] = first
    seen[first] = True
    count, done = 1, 0
    while done < count:
        level, row, column = stack[done, 0], stack[done, 1], stack[done, 2]
        done += 1
        for step in range(4):
            r, c = row + (0, 1, 0, -1)[step], column + (1, 0, -1, 0)[step]
            if r < 0 or r >= rows or c < 0 or c >= columns:
                continue
            beside = _floor_beside(kind, z_m, r, c, z_m[level, row, column])
            if beside >= 0 and not seen[beside, r, c]:
                seen[beside, r, c] = True
                stack[count, 0], stack[count, 1], stack[count, 2] = beside, r, c
                count += 1
    return count


@kernel
def _free_level(kind: U8, stack: I32, count: int) -> int:  # pragma: no cover - compiled
    """Return the lowest level on which the first ``count`` cells of ``stack`` are all free, -1 where there is none."""
    for level in range(len(kind)):
        fits = True
        for n in range(count):
            fits = fits and kind[level, stack[n, 1], stack[n, 2]] == VOID
        if fits:
            return level
    return -1


@kernel
def untangle(kind: U8, z_m: F64) -> None:  # pragma: no cover - compiled
    """Sort the floors so that each level holds whole ones: a floor is what can be reached from cell to cell.

    A floor for which no level is left is dropped.
    """
    levels, rows, columns = kind.shape
    old_kind, old_z = kind.copy(), z_m.copy()
    kind[:] = VOID
    seen = np.zeros((levels, rows, columns), np.bool_)
    stack = np.empty((levels * rows * columns, 3), np.int32)
    for first in range(levels * rows * columns):
        place = (first // (rows * columns), first // columns % rows, first % columns)
        if old_kind[place] == VOID or seen[place]:
            continue
        count = _flood(old_kind, old_z, seen, stack, place)
        target = _free_level(kind, stack, count)
        if target < 0:
            continue
        for n in range(count):
            level, row, column = stack[n, 0], stack[n, 1], stack[n, 2]
            kind[target, row, column] = old_kind[level, row, column]
            z_m[target, row, column] = old_z[level, row, column]
