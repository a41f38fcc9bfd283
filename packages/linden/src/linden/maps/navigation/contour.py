"""The faces of a picture: round each patch of one kind a line through few corners, the same line for both neighbours.

After Recast's contours: a line between two patches is simplified once, from one fixed corner to the next, so what was
shared stays shared and a mesh of the faces has no cracks. Corners are whole numbers of cells; x to the right, y down.
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kernel

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]
U8 = NDArray[np.uint8]

OUTSIDE = 255
"""Kind of what lies outside of the picture."""

Corner = tuple[int, int]
Loop = list[Corner]


class Face(NamedTuple):
    """A patch: its outer line, then holes. Winding: the outer one has a negative area (x to the right, y down)."""

    kind: int
    outer: Loop
    holes: list[Loop]


def faces_of(kind: U8, z_m: F64, *, cell_m: float, tolerance_m: float, tolerance_z_m: float) -> list[Face]:
    """Return the patches of every kind but 0 of a picture (rows, columns) with heights at its corners (+1, +1)."""
    framed = np.full((kind.shape[0] + 2, kind.shape[1] + 2), OUTSIDE, np.uint8)
    framed[1:-1, 1:-1] = kind
    patch = _patches(framed)
    corners, starts = _trace(framed)
    fixed = _fixed(framed)
    outers: dict[int, Loop] = {}
    holes: dict[int, list[Loop]] = {}
    kinds: dict[int, int] = {}
    for first, end in zip(starts[:-1].tolist(), starts[1:].tolist(), strict=True):
        line = corners[first:end]
        place = (int(line[0, 3]), int(line[0, 2]))
        kept = _simplified(line[:, :2], fixed, z_m, cell_m, tolerance_m, tolerance_z_m)
        number = int(patch[place])
        kinds[number] = int(framed[place])
        area = twice_area(line[:, :2])
        if len(kept) < 3:
            continue
        if area < 0:
            outers[number] = kept
        else:
            holes.setdefault(number, []).append(kept)
    return [Face(kinds[number], outer, holes.get(number, [])) for number, outer in outers.items()]


def twice_area(line: NDArray[np.integer]) -> int:
    """Return twice the signed area of a closed line (N, 2)."""
    x, y = line[:, 0].astype(np.int64), line[:, 1].astype(np.int64)
    return int((x * np.roll(y, -1) - np.roll(x, -1) * y).sum())


@kernel
def _patches(framed: U8) -> I32:  # pragma: no cover - compiled
    """Number the patches: cells of one kind that touch along a side."""
    rows, columns = framed.shape
    number = np.zeros((rows, columns), np.int32)
    stack = np.empty((rows * columns, 2), np.int32)
    found = 0
    for row in range(rows):
        for column in range(columns):
            if number[row, column] != 0 or framed[row, column] in (0, OUTSIDE):
                continue
            found += 1
            number[row, column] = found
            stack[0, 0], stack[0, 1] = row, column
            count = 1
            while count > 0:
                count -= 1
                r, c = stack[count, 0], stack[count, 1]
                for step in range(4):
                    r2, c2 = r + (0, 1, 0, -1)[step], c + (1, 0, -1, 0)[step]
                    if r2 < 0 or r2 >= rows or c2 < 0 or c2 >= columns or number[r2, c2] != 0:
                        continue
                    if framed[r2, c2] == framed[r, c]:
                        number[r2, c2] = found
                        stack[count, 0], stack[count, 1] = r2, c2
                        count += 1
    return number


@kernel
def _fixed(framed: U8) -> NDArray[np.bool_]:  # pragma: no cover - compiled
    """Return which corners of the picture every simplification keeps: where more than two lines meet, and its four."""
    rows, columns = framed.shape[0] - 2, framed.shape[1] - 2
    fixed = np.zeros((rows + 1, columns + 1), np.bool_)
    for y in range(rows + 1):
        for x in range(columns + 1):
            a, b = framed[y, x], framed[y, x + 1]
            c, d = framed[y + 1, x], framed[y + 1, x + 1]
            lines = (a != b) + (c != d) + (a != c) + (b != d)
            fixed[y, x] = lines > 2 or (y in (0, rows) and x in (0, columns))
    return fixed


@kernel
def _trace(framed: U8) -> tuple[I32, I32]:  # pragma: no cover - compiled
    """Walk round every patch, its cells on one hand: corners (N, 4) of x, y and the framed cell beside, loop starts.

    Directions: 0 to +x, 1 to +y, 2 to -x, 3 to -y. The own cell lies at -y of direction 0, +x of 1, +y of 2, -x of 3.
    """
    rows, columns = framed.shape[0] - 2, framed.shape[1] - 2
    seen = np.zeros((rows + 1, columns + 1, 4), np.bool_)
    corners = np.empty((4 * (rows + 1) * (columns + 1), 4), np.int32)
    starts = np.empty((rows + 1) * (columns + 1) + 1, np.int32)
    count, loops = 0, 0
    step_x, step_y = (1, 0, -1, 0), (0, 1, 0, -1)
    # of the four cells round a corner, in framed places from it: own cell behind, and other cell behind, by direction
    own_x, own_y = (1, 1, 0, 0), (0, 1, 1, 0)
    other_x, other_y = (1, 0, 0, 1), (1, 1, 0, 0)
    for first_y in range(rows + 1):
        for first_x in range(columns + 1):
            corner = framed[first_y, first_x]
            if (
                framed[first_y, first_x + 1] == corner
                and framed[first_y + 1, first_x] == corner
                and framed[first_y + 1, first_x + 1] == corner
            ):
                continue
            for first in range(4):
                own = framed[first_y + own_y[first], first_x + own_x[first]]
                other = framed[first_y + other_y[first], first_x + other_x[first]]
                if own in (0, OUTSIDE) or own == other or seen[first_y, first_x, first]:
                    continue
                starts[loops] = count
                loops += 1
                x, y, d = first_x, first_y, first
                while not seen[y, x, d]:
                    seen[y, x, d] = True
                    corners[count, 0], corners[count, 1] = x, y
                    corners[count, 2], corners[count, 3] = x + own_x[d], y + own_y[d]
                    count += 1
                    x, y = x + step_x[d], y + step_y[d]
                    if framed[y + own_y[d], x + own_x[d]] != own:
                        d = (d + 3) % 4
                    elif framed[y + other_y[d], x + other_x[d]] == own:
                        d = (d + 1) % 4
    starts[loops] = count
    return corners[:count], starts[: loops + 1]


def _simplified(
    line: I32, fixed: NDArray[np.bool_], z_m: F64, cell_m: float, tolerance_m: float, tolerance_z_m: float
) -> Loop:
    """Return a closed line with few corners, whichever way round it was walked."""
    pinned = np.flatnonzero(fixed[line[:, 1], line[:, 0]])
    if not len(pinned):
        pinned = np.array([np.lexsort((line[:, 1], line[:, 0]))[0]])
    turned = np.roll(line, -int(pinned[0]), axis=0)
    ends = [*(pinned - pinned[0]).tolist(), len(line)]
    points = np.column_stack([turned * cell_m, z_m[turned[:, 1], turned[:, 0]]])
    points = np.concatenate([points, points[:1]])
    keep = np.zeros(len(line) + 1, np.bool_)
    for first, last in pairwise(ends):
        _thin(points[first : last + 1], tolerance_m, tolerance_z_m, keep[first : last + 1])
    return [(x, y) for x, y in turned[keep[:-1]].tolist()]


@kernel
def _thin(
    points: F64, tolerance_m: float, tolerance_z_m: float, keep: NDArray[np.bool_]
) -> None:  # pragma: no cover - compiled
    """Mark which corners of an open line (N, 3) to keep: Douglas and Peucker 1973, the same from either end.

    Of equally far corners the one that comes first from the end that is smaller is taken; the ends are kept.
    """
    last = len(points) - 1
    forward = True
    for n in range(1, last):  # compare the line with itself reversed, from the ends inwards
        if points[n, 0] != points[last - n, 0]:
            forward = points[n, 0] < points[last - n, 0]
            break
        if points[n, 1] != points[last - n, 1]:
            forward = points[n, 1] < points[last - n, 1]
            break
    if points[0, 0] != points[last, 0]:
        forward = points[0, 0] < points[last, 0]
    elif points[0, 1] != points[last, 1]:
        forward = points[0, 1] < points[last, 1]
    keep[0] = keep[last] = True
    stack = np.empty((last + 2, 2), np.int64)
    stack[0, 0], stack[0, 1] = 0, last
    count = 1
    while count > 0:
        count -= 1
        low, high = stack[count, 0], stack[count, 1]
        ax, ay, az = points[low, 0], points[low, 1], points[low, 2]
        bx, by, bz = points[high, 0] - ax, points[high, 1] - ay, points[high, 2] - az
        length_2 = bx * bx + by * by
        worst, at = 1.0, -1
        for k in range(low + 1, high):
            n = k if forward else high + low - k
            dx, dy = points[n, 0] - ax, points[n, 1] - ay
            share = min(1.0, max(0.0, (dx * bx + dy * by) / length_2)) if length_2 > 0.0 else 0.0
            off_x, off_y = dx - share * bx, dy - share * by
            off = (off_x * off_x + off_y * off_y) / (tolerance_m * tolerance_m)
            off_z = abs(points[n, 2] - az - share * bz) / tolerance_z_m
            off = max(off, off_z * off_z) if length_2 > 0.0 else off + 2.0
            if off > worst * (1.0 + 1e-9):
                worst, at = off, n
        if at >= 0:
            keep[at] = True
            stack[count, 0], stack[count, 1] = low, at
            stack[count + 1, 0], stack[count + 1, 1] = at, high
            count += 2
