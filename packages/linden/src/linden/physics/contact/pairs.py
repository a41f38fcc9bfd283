"""Which bodies may touch in the coming step: a hashed grid over the plane, so the cost grows with their number."""

import math

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kept_part, part
from linden.physics.contact.statics import Statics
from linden.physics.state import SOURCES, Body, Rows

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

CELL_M = 12.0
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


@kept_part(SOURCES)
def find_pairs(rows: Rows, count: int, statics: Statics, dt_s: float) -> I32:
    """Return (P, 2) of first body and second body, or -1 - n for the n-th static; ordered, each pair once.

    Teschner et al. 2003, "Optimized spatial hashing for collision detection of deformable objects".
    """
    circles = np.zeros((count, 3))
    entries = 0
    for i in range(count):
        circles[i, 2] = -1.0
        if rows[i].alive and rows[i].collides:
            circles[i, 0], circles[i, 1] = box_centre(rows[i])
            circles[i, 2] = reach_of(rows[i], dt_s)
            entries += 1
    size = 64
    while size < 4 * entries:
        size *= 2
    head = np.full(size, -1, np.int32)
    nodes: I32 = np.empty((64 + 4 * entries, 2), np.int32)  # body, next node
    wide = np.empty(entries, np.int32)
    wide_count, used = 0, 0
    for i in range(count - 1, -1, -1):
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
    return _collect(rows, circles, head, nodes, wide[:wide_count], statics)


@part
def _collect(rows: Rows, circles: F64, head: I32, nodes: I32, wide: I32, statics: Statics) -> I32:
    """Return the pairs with circles that meet, body by body: its statics, then the bodies after it."""
    pairs: I32 = np.empty((64, 2), np.int32)
    found = 0
    near: I32 = np.empty(64, np.int32)
    for i in range(len(circles)):
        if circles[i, 2] < 0.0:
            continue
        near, near_count = _near_statics(circles[i], statics, near) if not is_fixed(rows[i]) else (near, 0)
        for sign in (-1, 1):
            if sign > 0:
                near, near_count = _near_bodies(rows, i, circles, head, nodes, wide, near)
            for k in range(near_count):
                if found == len(pairs):
                    pairs = _twice(pairs)
                pairs[found, 0] = i
                pairs[found, 1] = near[k] if sign > 0 else -1 - near[k]
                found += 1
    return pairs[:found]


@part
def _near_bodies(rows: Rows, i: int, circles: F64, head: I32, nodes: I32, wide: I32, near: I32) -> tuple[I32, int]:
    """Return the bodies after ``i`` with a circle that meets its own, ascending, in ``near`` (grown where needed)."""
    found = 0
    x0, x1, y0, y1 = _cells(circles[i])
    if x1 - x0 >= _MOST_CELLS_ACROSS or y1 - y0 >= _MOST_CELLS_ACROSS:
        for j in range(i + 1, len(circles)):
            if _may_meet(rows, i, j, circles):
                near, found = _insert(near, found, j)
        return near, found
    for cx in range(x0, x1 + 1):
        for cy in range(y0, y1 + 1):
            node = head[_hash(cx, cy, len(head))]
            while node >= 0:
                j = nodes[node, 0]
                if j > i and _may_meet(rows, i, j, circles):
                    near, found = _insert(near, found, j)
                node = nodes[node, 1]
    for k in range(len(wide)):
        if wide[k] > i and _may_meet(rows, i, wide[k], circles):
            near, found = _insert(near, found, wide[k])
    return near, found


@part
def _may_meet(rows: Rows, i: int, j: int, circles: F64) -> bool:
    """Tell whether two bodies' circles meet and one of the two can move."""
    if circles[j, 2] < 0.0 or (is_fixed(rows[i]) and is_fixed(rows[j])):
        return False
    x, y, reach = circles[i, 0] - circles[j, 0], circles[i, 1] - circles[j, 1], circles[i, 2] + circles[j, 2]
    return bool(x * x + y * y < reach * reach)


@part
def _near_statics(circle: F64, statics: Statics, near: I32) -> tuple[I32, int]:
    """Return the statics with a circle that meets the given one, ascending, in ``near`` (grown where needed)."""
    frame = statics.bin_frame
    found = 0
    if len(statics.bin_items) == 0:
        return near, 0
    x0, x1 = (circle[0] - circle[2] - frame[0]) * frame[2], (circle[0] + circle[2] - frame[0]) * frame[2]
    y0, y1 = (circle[1] - circle[2] - frame[1]) * frame[2], (circle[1] + circle[2] - frame[1]) * frame[2]
    if not (x1 >= 0.0 and y1 >= 0.0 and x0 < frame[3] and y0 < frame[4]):
        return near, 0
    for row in range(int(max(0.0, y0)), int(min(frame[4] - 1.0, y1)) + 1):
        for column in range(int(max(0.0, x0)), int(min(frame[3] - 1.0, x1)) + 1):
            b = row * int(frame[3]) + column
            for k in range(statics.bin_start[b], statics.bin_start[b + 1]):
                n = statics.bin_items[k]
                x, y = statics.centre[n, 0] - circle[0], statics.centre[n, 1] - circle[1]
                reach = circle[2] + math.hypot(statics.half[n, 0], statics.half[n, 1])
                if x * x + y * y < reach * reach:
                    near, found = _insert(near, found, n)
    return near, found


@part
def _insert(near: I32, count: int, item: int) -> tuple[I32, int]:
    """Insert into an ascending list that holds each number once."""
    if count == len(near):
        grown = np.empty(2 * count, np.int32)
        for k in range(count):
            grown[k] = near[k]
        near = grown
    place = count
    while place > 0 and near[place - 1] > item:
        place -= 1
    if place > 0 and near[place - 1] == item:
        return near, count
    for k in range(count, place, -1):
        near[k] = near[k - 1]
    near[place] = item
    return near, count + 1


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
