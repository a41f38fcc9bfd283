"""Which bodies of a world may touch in the coming step: a hashed grid, so the cost grows with their number."""

import math

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kept_part, part
from linden.physics.contact.statics import Statics
from linden.physics.state import SOURCES, Body, Rows

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

CELL_M = 12.0
_FEW_BODIES = 12  # each is compared with all others, which is quicker than a grid
_MOST_CELLS_ACROSS = 6  # a body wider than that is compared with all others instead of filling the grid
_SPEED_GAIN_MPS2 = 20.0  # what a body's speed may grow by while the pairs hold
_SKIN_M = 0.2  # what pushing apart may move it by


@part
def is_fixed(v: Body) -> bool:
    """Tell whether no push can move the body."""
    return bool(v.immovable or not v.simulate)


@part
def reach_of(v: Body, dt_s: float) -> float:
    """Return the radius in m around the box's centre that the body stays within for ``dt_s``."""
    radius = math.hypot(v.half_extent[0], v.half_extent[1])
    if v.tumbling:  # it reaches as far as any corner does
        radius = math.hypot(radius, v.half_extent[2]) + abs(v.box_centre[2])
    if is_fixed(v):
        return radius
    speed = math.hypot(v.velocity[0], v.velocity[1])
    return radius + speed * dt_s + 0.5 * _SPEED_GAIN_MPS2 * dt_s * dt_s + _SKIN_M


@part
def box_centre(v: Body) -> tuple[float, float]:
    """Return the x and y of the box's centre in the world, m."""
    cosine, sine = math.cos(v.rotation[1]), math.sin(v.rotation[1])
    x = v.position[0] + cosine * v.box_centre[0] - sine * v.box_centre[1]
    return x, v.position[1] + sine * v.box_centre[0] + cosine * v.box_centre[1]


@part
def write_circles(rows: Rows, dt_s: float, circles: F64) -> int:
    """Write the circle that each body stays within for ``dt_s``, radius -1 for none; return how many can touch.

    ``circles`` (N, 3) are x, y and radius of the first bodies, m.
    """
    entries = 0
    for i in range(len(circles)):
        circles[i, 2] = -1.0
        if rows[i].alive and rows[i].collides:
            circles[i, 0], circles[i, 1] = box_centre(rows[i])
            circles[i, 2] = reach_of(rows[i], dt_s)
            entries += 1
    return entries


@kept_part(SOURCES)
def find_pairs(rows: Rows, count: int, statics: Statics, dt_s: float) -> I32:
    """Return (P, 2) of first body and second body, or -1 - n for the n-th static; ordered, each pair once."""
    circles = np.empty((count, 3))
    entries = write_circles(rows, dt_s, circles)
    pairs: I32 = np.empty((16 + 4 * entries, 2), np.int32)
    if entries <= _FEW_BODIES:
        found = pairs_of_few(rows, circles, statics, pairs)
        if found > len(pairs):
            pairs = np.empty((found, 2), np.int32)
            found = pairs_of_few(rows, circles, statics, pairs)
        return pairs[:found]
    head, nodes, wide = _grid(circles, entries)
    found = _pairs_of_many(rows, circles, head, nodes, wide, statics, pairs)
    if found > len(pairs):
        pairs = np.empty((found, 2), np.int32)
        found = _pairs_of_many(rows, circles, head, nodes, wide, statics, pairs)
    return pairs[:found]


@part
def pairs_of_few(rows: Rows, circles: F64, statics: Statics, pairs: I32) -> int:
    """Write the pairs with circles that meet, body by body: its statics, then the bodies after it.

    Returned: their number, or where ``pairs`` (P, 2) has too little room, a number of rows that is enough.
    """
    found = 0
    for i in range(len(circles)):
        if circles[i, 2] >= 0.0:
            found = _add_statics(rows, i, circles, statics, pairs, found)
            found = _add_all(rows, i, circles, pairs, found)
    return found


@part
def _grid(circles: F64, entries: int) -> tuple[I32, I32, I32]:
    """Return a hashed grid of ``entries`` circles: the first node of each place, body and next node, wide bodies.

    Teschner et al. 2003, "Optimized spatial hashing for collision detection of deformable objects".
    """
    size = 64
    while size < 4 * entries:
        size *= 2
    head = np.full(size, -1, np.int32)
    nodes: I32 = np.empty((64 + 4 * entries, 2), np.int32)  # body, next node
    wide = np.empty(entries, np.int32)
    wide_count, used = 0, 0
    for i in range(len(circles) - 1, -1, -1):
        if circles[i, 2] < 0.0:
            continue
        x0, x1, y0, y1 = _cells(circles[i])
        if x1 - x0 >= _MOST_CELLS_ACROSS or y1 - y0 >= _MOST_CELLS_ACROSS:
            wide[wide_count] = i
            wide_count += 1
            continue
        for cx in range(x0, x1 + 1):
            for cy in range(y0, y1 + 1):
                if used == len(nodes):
                    nodes = _twice(nodes)
                place = _hash(cx, cy, size)
                nodes[used, 0], nodes[used, 1] = i, head[place]
                head[place] = used
                used += 1
    return head, nodes, wide[:wide_count]


@part
def _pairs_of_many(rows: Rows, circles: F64, head: I32, nodes: I32, wide: I32, statics: Statics, pairs: I32) -> int:
    """Write the pairs as :func:`pairs_of_few` does, by the grid of the circles."""
    found = 0
    for i in range(len(circles)):
        if circles[i, 2] < 0.0:
            continue
        found = _add_statics(rows, i, circles, statics, pairs, found)
        x0, x1, y0, y1 = _cells(circles[i])
        if x1 - x0 >= _MOST_CELLS_ACROSS or y1 - y0 >= _MOST_CELLS_ACROSS:
            found = _add_all(rows, i, circles, pairs, found)
            continue
        first = found
        for cx in range(x0, x1 + 1):
            for cy in range(y0, y1 + 1):
                node = head[_hash(cx, cy, len(head))]
                while node >= 0:
                    j = nodes[node, 0]
                    if j > i and _may_meet(rows, i, j, circles):
                        found = _insert(pairs, first, found, i, j)
                    node = nodes[node, 1]
        for k in range(len(wide)):
            if wide[k] > i and _may_meet(rows, i, wide[k], circles):
                found = _insert(pairs, first, found, i, wide[k])
    return found


@part
def _add_all(rows: Rows, i: int, circles: F64, pairs: I32, found: int) -> int:
    """Add the pairs of a body with all bodies after it."""
    first = found
    for j in range(i + 1, len(circles)):
        if _may_meet(rows, i, j, circles):
            found = _insert(pairs, first, found, i, j)
    return found


@part
def _may_meet(rows: Rows, i: int, j: int, circles: F64) -> bool:
    """Tell whether two bodies' circles meet and one of the two can move."""
    if circles[j, 2] < 0.0 or (is_fixed(rows[i]) and is_fixed(rows[j])):
        return False
    x, y, reach = circles[i, 0] - circles[j, 0], circles[i, 1] - circles[j, 1], circles[i, 2] + circles[j, 2]
    return bool(x * x + y * y < reach * reach)


@part
def _add_statics(rows: Rows, i: int, circles: F64, statics: Statics, pairs: I32, found: int) -> int:
    """Add the pairs of a movable body with statics with circles that meet its own, in the order of their numbers."""
    frame, circle, first = statics.bin_frame, circles[i], found
    if len(statics.bin_items) == 0 or is_fixed(rows[i]):
        return found
    x0, x1 = (circle[0] - circle[2] - frame[0]) * frame[2], (circle[0] + circle[2] - frame[0]) * frame[2]
    y0, y1 = (circle[1] - circle[2] - frame[1]) * frame[2], (circle[1] + circle[2] - frame[1]) * frame[2]
    if not (x1 >= 0.0 and y1 >= 0.0 and x0 < frame[3] and y0 < frame[4]):
        return found
    for row in range(int(max(0.0, y0)), int(min(frame[4] - 1.0, y1)) + 1):
        for column in range(int(max(0.0, x0)), int(min(frame[3] - 1.0, x1)) + 1):
            b = row * int(frame[3]) + column
            for k in range(statics.bin_start[b], statics.bin_start[b + 1]):
                n = statics.bin_items[k]
                x, y = statics.centre[n, 0] - circle[0], statics.centre[n, 1] - circle[1]
                reach = circle[2] + math.hypot(statics.half[n, 0], statics.half[n, 1])
                if x * x + y * y < reach * reach:
                    found = _insert(pairs, first, found, i, -1 - n)
    return found


@part
def _insert(pairs: I32, first: int, found: int, i: int, other: int) -> int:
    """Insert a pair into the rows from ``first`` to ``found``, which are in order; return the new end.

    Without room the end grows all the same.
    """
    if found >= len(pairs):
        return found + 1
    place = found
    while place > first and abs(pairs[place - 1, 1]) > abs(other):  # bodies ascend, and so do statics: -1, -2, -3
        place -= 1
    if place > first and pairs[place - 1, 1] == other:
        return found
    for k in range(found, place, -1):
        pairs[k, 0], pairs[k, 1] = pairs[k - 1, 0], pairs[k - 1, 1]
    pairs[place, 0], pairs[place, 1] = i, other
    return found + 1


@part
def _cells(circle: F64) -> tuple[int, int, int, int]:
    """Return first and last cell in x, then in y, that the circle's square touches."""
    x, y, reach = circle[0], circle[1], circle[2]
    x0, x1 = math.floor((x - reach) / CELL_M), math.floor((x + reach) / CELL_M)
    return x0, x1, math.floor((y - reach) / CELL_M), math.floor((y + reach) / CELL_M)


@part
def _hash(cell_x: int, cell_y: int, size: int) -> int:
    """Return the place of a cell in a table with a power of two as its size. Primes: Teschner et al. 2003."""
    return ((cell_x * 73856093) ^ (cell_y * 19349663)) & (size - 1)


@part
def _twice(rows: I32) -> I32:
    """Return the (N, 2) array with room for twice as many rows."""
    larger = np.empty((2 * len(rows), 2), np.int32)
    for k in range(len(rows)):
        larger[k, 0], larger[k, 1] = rows[k, 0], rows[k, 1]
    return larger
