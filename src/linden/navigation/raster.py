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
    for level in range(LEVELS):
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
    for level in range(LEVELS):
        if kind[level, row, column] != VOID and abs(z_m[level, row, column] - from_z_m) <= CLIMB_M:
            return level
    return -1


@kernel
def close_gaps(kind: U8, z_m: F64) -> None:  # pragma: no cover - compiled
    """Fill seams one cell wide: where two lanes meet, neither may cover the middle of a cell between them."""
    before = kind.copy()
    for row in range(1, kind.shape[1] - 1):
        for column in range(1, kind.shape[2] - 1):
            for level in range(LEVELS):
                if before[level, row, column] != VOID:
                    continue
                for down, right in ((0, 1), (1, 0)):
                    one = before[level, row - down, column - right]
                    other = before[level, row + down, column + right]
                    one_z = z_m[level, row - down, column - right]
                    other_z = z_m[level, row + down, column + right]
                    if one != VOID and other != VOID and abs(one_z - other_z) <= CLIMB_M:
                        kind[level, row, column] = min(one, other)
                        z_m[level, row, column] = 0.5 * (one_z + other_z)


@kernel
def keep_clear(kind: U8, z_m: F64) -> None:  # pragma: no cover - compiled
    """Take away what lies within a cell of nothing, and give the pavement within a cell of the carriageway to its edge.

    So a walker, whose middle the mesh holds, keeps its shoulders off walls and out of the traffic.
    """
    before = kind.copy()
    for row in range(1, kind.shape[1] - 1):
        for column in range(1, kind.shape[2] - 1):
            for level in range(LEVELS):
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
                for level in range(LEVELS):
                    over_feet = centre_m[n, 2] - z_m[level, row, column]
                    if half_m[n, 2] + over_feet > 0.2 and over_feet - half_m[n, 2] < HEADROOM_M:
                        kind[level, row, column] = VOID


@kernel
def untangle(kind: U8, z_m: F64) -> int:  # pragma: no cover - compiled
    """Sort the floors so that each level holds whole floors, unbroken; returns how many levels are in use.

    A floor is what can be reached from cell to cell. Larger numbers of levels than LEVELS are dropped with their cells.
    """
    rows, columns = kind.shape[1], kind.shape[2]
    if not (kind[1] != VOID).any():
        return 1
    old_kind, old_z = kind.copy(), z_m.copy()
    kind[:] = VOID
    taken = np.zeros((LEVELS, rows, columns), np.bool_)
    seen = np.zeros((LEVELS, rows, columns), np.bool_)
    stack = np.empty((LEVELS * rows * columns, 3), np.int32)
    used = 1
    for first in range(LEVELS * rows * columns):
        level, row, column = first // (rows * columns), first // columns % rows, first % columns
        if old_kind[level, row, column] == VOID or seen[level, row, column]:
            continue
        stack[0, 0], stack[0, 1], stack[0, 2] = level, row, column
        seen[level, row, column] = True
        count, done = 1, 0
        while done < count:
            k, r, c = stack[done, 0], stack[done, 1], stack[done, 2]
            done += 1
            for step in range(4):
                r2, c2 = r + (0, 1, 0, -1)[step], c + (1, 0, -1, 0)[step]
                if r2 < 0 or r2 >= rows or c2 < 0 or c2 >= columns:
                    continue
                k2 = _floor_beside(old_kind, old_z, r2, c2, old_z[k, r, c])
                if k2 >= 0 and not seen[k2, r2, c2]:
                    seen[k2, r2, c2] = True
                    stack[count, 0], stack[count, 1], stack[count, 2] = k2, r2, c2
                    count += 1
        for target in range(LEVELS):
            fits = True
            for n in range(count):
                if taken[target, stack[n, 1], stack[n, 2]]:
                    fits = False
                    break
            if fits:
                for n in range(count):
                    k, r, c = stack[n, 0], stack[n, 1], stack[n, 2]
                    taken[target, r, c] = True
                    kind[target, r, c], z_m[target, r, c] = old_kind[k, r, c], old_z[k, r, c]
                used = max(used, target + 1)
                break
    return used
