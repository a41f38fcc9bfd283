"""Rays through a scene: every surface one crosses, in order. Road surface, terrain, boxes that stand, boxes that move.

Boxes count where a ray enters them, or where it begins if that is inside; road and terrain count from either side.
Grids are walked cell by cell: Amanatides and Woo 1987, "A Fast Voxel Traversal Algorithm for Ray Tracing".
"""

import math
from collections.abc import Callable
from enum import IntEnum
from pathlib import Path
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from linden.compiled import fingerprint, kernel, part
from linden.maps.ground import Ground, surface_under, triangle_under
from linden.plane_bins import Bins, bins_of
from linden.scenery.ray_surfaces import cut_to_slab, enters, enters_turned, meets_triangle, parabola_roots

F64 = NDArray[np.float64]

_HIGH_M = 1e9  # above every road
_LOW_M = -1e9  # below every road: there only the terrain answers
_SLACK = 1e-9  # of the ray: a triangle met on the border of two cells is met in both


class Surface(IntEnum):
    """What a ray meets."""

    ROAD = 0  # numbered by triangle
    TERRAIN = 1
    STANDING = 2  # numbered by row of the boxes
    MOVING = 3


class StandingBoxes(NamedTuple):
    """Upright boxes that stay where they are, with bins to find them by."""

    centre_m: F64  # (M, 3)
    half_m: F64  # (M, 3)
    yaw_rad: F64  # (M,)
    bins: Bins

    @staticmethod
    def of(centre_m: F64, half_m: F64, yaw_rad: F64) -> "StandingBoxes":
        """Return boxes sorted into bins of the plane."""
        bins = bins_of(centre_m[:, :2], np.hypot(half_m[:, 0], half_m[:, 1]))
        centre_m, half_m, yaw_rad = map(np.ascontiguousarray, (centre_m, half_m, yaw_rad))
        return StandingBoxes(centre_m, half_m, yaw_rad, bins)


class MovingBoxes(NamedTuple):
    """Boxes turned in any way."""

    centre_m: F64  # (K, 3)
    half_m: F64  # (K, 3)
    axes: F64  # (K, 3, 3): the columns are the box's own axes in the world


Hits = F64
"""(H, 3): place along the ray from 0 to 1, a Surface, and its number (-1 for the terrain); in the order of the ray."""


@part
def _noted(hits: Hits, count: int, at: float, surface: int, number: int) -> Hits:
    """Return the list with one more hit, grown where needed."""
    if count == len(hits):
        grown = np.empty((2 * count, 3))
        for k in range(count):
            for column in range(3):
                grown[k, column] = hits[k, column]
        hits = grown
    hits[count, 0], hits[count, 1], hits[count, 2] = at, surface, number
    return hits


@part
def _within_frame(start: F64, step: F64, frame: F64) -> F64:
    """Return from and to (2,) of a ray within the rectangle of bins; to is less where it passes by."""
    span = np.array([0.0, 1.0])
    for axis in range(2):
        half = 0.5 * frame[3 + axis] / frame[2]
        cut_to_slab(start[axis] - frame[axis] - half, step[axis], half, span)
    return span


@part
def _next_line(start: float, step: float, origin: float, per_m: float, cell: int) -> float:
    """Return where the ray leaves a cell of a row or column of cells."""
    if step == 0.0:
        return math.inf
    line = origin + (cell + (1 if step > 0.0 else 0)) / per_m
    return (line - start) / step


@part
def _cross_road(ground: Ground, start: F64, step: F64, hits: Hits, count: int) -> tuple[Hits, int]:
    """Note every triangle of the ground that the ray meets; one on the border of two cells may be noted twice."""
    frame = ground.bin_frame
    span = _within_frame(start, step, frame)
    at, end = span[0], span[1]
    if len(ground.bin_items) == 0 or not at <= end:
        return hits, count
    column = int(min(max((start[0] + at * step[0] - frame[0]) * frame[2], 0.0), frame[3] - 1.0))
    row = int(min(max((start[1] + at * step[1] - frame[1]) * frame[2], 0.0), frame[4] - 1.0))
    while True:
        to_x = _next_line(start[0], step[0], frame[0], frame[2], column)
        to_y = _next_line(start[1], step[1], frame[1], frame[2], row)
        leave = min(to_x, to_y, end)
        bin_number = row * int(frame[3]) + column
        for k in range(ground.bin_start[bin_number], ground.bin_start[bin_number + 1]):
            triangle = ground.bin_items[k]
            met = meets_triangle(start, step, ground.planes[triangle])
            if at - _SLACK <= met <= leave + _SLACK:
                hits = _noted(hits, count, met, 0, triangle)
                count += 1
        if leave >= end:
            return hits, count
        if to_x <= to_y:
            column += 1 if step[0] > 0.0 else -1
        else:
            row += 1 if step[1] > 0.0 else -1
        at = leave
        if not (0 <= column < frame[3] and 0 <= row < frame[4]):
            return hits, count


@part
def _cross_standing(boxes: StandingBoxes, start: F64, step: F64, hits: Hits, count: int) -> tuple[Hits, int]:
    """Note every standing box that the ray enters: in the one cell in which it does."""
    frame = boxes.bins.frame
    span = _within_frame(start, step, frame)
    at, end = span[0], span[1]
    if len(boxes.bins.items) == 0 or not at <= end:
        return hits, count
    column = int(min(max((start[0] + at * step[0] - frame[0]) * frame[2], 0.0), frame[3] - 1.0))
    row = int(min(max((start[1] + at * step[1] - frame[1]) * frame[2], 0.0), frame[4] - 1.0))
    while True:
        to_x = _next_line(start[0], step[0], frame[0], frame[2], column)
        to_y = _next_line(start[1], step[1], frame[1], frame[2], row)
        leave = min(to_x, to_y, end)
        bin_number = row * int(frame[3]) + column
        for k in range(boxes.bins.start[bin_number], boxes.bins.start[bin_number + 1]):
            box = boxes.bins.items[k]
            cosine, sine = math.cos(boxes.yaw_rad[box]), math.sin(boxes.yaw_rad[box])
            met = enters(start, step, boxes.centre_m[box], boxes.half_m[box], cosine, sine)
            if at <= met < leave or (met == leave and leave >= end):
                hits = _noted(hits, count, met, 2, box)
                count += 1
        if leave >= end:
            return hits, count
        if to_x <= to_y:
            column += 1 if step[0] > 0.0 else -1
        else:
            row += 1 if step[1] > 0.0 else -1
        at = leave
        if not (0 <= column < frame[3] and 0 <= row < frame[4]):
            return hits, count


@part
def _above_terrain(ground: Ground, start: F64, step: F64, at: float) -> float:
    """Return how high the ray is above the terrain."""
    x, y = start[0] + at * step[0], start[1] + at * step[1]
    return float(start[2] + at * step[2] - surface_under(ground, x, y, _LOW_M)[0])


@part
def _first_line(start: float, step: float, origin: float, per_m: float, nodes: int) -> int:
    """Return the number of the first line of nodes ahead of a ray; one that is not there where none is."""
    place = min(max((start - origin) * per_m, -1.0), float(nodes))
    return math.floor(place) + 1 if step > 0.0 else math.ceil(place) - 1


@part
def _reaches_line(start: float, step: float, origin: float, per_m: float, nodes: int, line: int) -> float:
    """Return where a ray crosses a line of nodes, inf where there is no such line."""
    return (origin + line / per_m - start) / step if step != 0.0 and 0 <= line < nodes else math.inf


@part
def _cross_terrain(ground: Ground, start: F64, step: F64, hits: Hits, count: int) -> tuple[Hits, int]:
    """Note where the ray meets the terrain, but where a road lies on it.

    Between two lines of its nodes the terrain is bilinear, so the height above it is a parabola along the ray; three of
    its values give it, and its sign at both ends and at its turn says how often it is crossed.
    """
    frame = ground.terrain_frame
    rows, columns = ground.terrain.shape
    line_x = _first_line(start[0], step[0], frame[0], frame[2], columns)
    line_y = _first_line(start[1], step[1], frame[1], frame[2], rows)
    at, height = 0.0, _above_terrain(ground, start, step, 0.0)
    while at < 1.0:
        to_x = _reaches_line(start[0], step[0], frame[0], frame[2], columns, line_x)
        to_y = _reaches_line(start[1], step[1], frame[1], frame[2], rows, line_y)
        leave = max(at, min(to_x, to_y, 1.0))
        if to_x <= to_y:
            line_x += 1 if step[0] > 0.0 else -1
        else:
            line_y += 1 if step[1] > 0.0 else -1
        middle = _above_terrain(ground, start, step, 0.5 * (at + leave))
        last = _above_terrain(ground, start, step, leave)
        for met in parabola_roots(height, middle, last):
            if 0.0 <= met <= 1.0:
                place = at + met * (leave - at)
                x, y = start[0] + place * step[0], start[1] + place * step[1]
                if triangle_under(ground, x, y, _HIGH_M)[1] < 0:
                    hits = _noted(hits, count, place, 1, -1)
                    count += 1
        at, height = leave, last
    return hits, count


_Cross = Callable[[Ground, StandingBoxes, MovingBoxes, F64, F64], Hits]


def _build(sources: int) -> _Cross:
    """Return the compiled caster; ``sources`` becomes part of the name it is cached under."""

    def cross(ground: Ground, standing: StandingBoxes, moving: MovingBoxes, start: F64, step: F64) -> Hits:
        _fingerprint = sources
        hits, count = _cross_road(ground, start, step, np.empty((16, 3)), 0)
        hits, count = _cross_terrain(ground, start, step, hits, count)
        hits, count = _cross_standing(standing, start, step, hits, count)
        for box in range(len(moving.centre_m)):
            met = enters_turned(start, step, moving.centre_m[box], moving.half_m[box], moving.axes[box])
            if met <= 1.0:
                hits = _noted(hits, count, met, 3, box)
                count += 1
        return hits[:count]

    return cast("_Cross", kernel(cross))


_HERE = Path(__file__).parent
_cross = _build(fingerprint(_HERE / "ray_query.py", _HERE / "ray_surfaces.py", _HERE.parent / "maps" / "ground.py"))


def crossings(ground: Ground, standing: StandingBoxes, moving: MovingBoxes, start_m: F64, end_m: F64) -> Hits:
    """Return all surfaces between two points (3,) in the world, those at the same place in the order of ``Surface``."""
    hits = _cross(ground, standing, moving, start_m, end_m - start_m)
    in_order: Hits = hits[np.lexsort((hits[:, 2], hits[:, 1], hits[:, 0]))]
    return in_order


def warm_up() -> None:
    """Compile the caster, or load it from the cache."""
    standing = StandingBoxes.of(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0))
    moving = MovingBoxes(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3, 3)))
    crossings(Ground.flat(), standing, moving, np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.0, -1.0]))
