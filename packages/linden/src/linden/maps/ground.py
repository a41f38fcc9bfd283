"""The ground: which height lies under a point, answered in constant time, on any number of levels.

Frame: CARLA's (x east, y south, z up), metres. Triangles are found by uniform bins over the plane; beside them lies a
terrain, a height grid drawn from the nearest triangles, so that nothing ever falls out of the world.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from linden.background import checkpoint
from linden.compiled import kernel, unlocked

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

STEP_M = 0.5
"""A surface this much above the asker still counts as under it: it is what a wheel or a foot climbs in a step."""

_MARGIN_M = 60.0  # terrain reaches this far past the outermost triangle; beyond, its edge goes on
_TERRAIN_NODES = 160_000  # at most; sets the terrain's grain
_FINEST_TERRAIN_M = 2.0
_FINEST_BIN_M = 1.0
_SMOOTHINGS = 24  # sweeps over the terrain between the roads: takes the edges off the nearest-height pattern
_EDGE_TOLERANCE = 1e-4  # in barycentric units: points on a shared edge belong to either triangle
_POINTS_AT_ONCE = 20_000  # between two looks whether the work is still wanted
_LEAST_AREA_M2 = 1e-9  # seen from above; steeper triangles are walls, not ground


class Ground(NamedTuple):
    """Heights as plain arrays, made by :meth:`from_triangles` or :meth:`flat`; goes into kernels as it is."""

    planes: F64  # (T, 9): x0, y0, then the two barycentric gradients (4), then z0, dz/dx, dz/dy
    bin_start: I32  # (bins + 1,): where the triangles of a bin begin in bin_items
    bin_items: I32  # triangle numbers, ascending within a bin
    bin_frame: F64  # (5,): x0, y0, bins per metre, bins in x, bins in y
    terrain: F64  # (ny, nx) heights
    terrain_frame: F64  # (3,): x0, y0, nodes per metre

    @staticmethod
    def from_triangles(vertices: ArrayLike, triangles: ArrayLike) -> "Ground":
        """Build from ``vertices`` (V, 3) in m and ``triangles`` (T, 3), which may wind either way.

        Raises:
            ValueError: wrong shapes, or a corner that is not finite.
        """
        corners_m = _corners(vertices, triangles)
        if len(corners_m) == 0:
            return Ground.flat()
        low, high = corners_m.min(axis=(0, 1))[:2], corners_m.max(axis=(0, 1))[:2]
        planes = _planes(corners_m)
        bin_frame = _bin_frame(low, high, len(corners_m))
        bin_start, bin_items = _fill_bins(corners_m, planes, bin_frame)
        terrain, terrain_frame = _terrain(corners_m, planes, low, high)
        return Ground(planes, bin_start, bin_items, bin_frame, terrain, terrain_frame)

    @staticmethod
    def flat(z: float = 0.0) -> "Ground":
        """Return an endless plane at height ``z`` m, without triangles."""
        return Ground(
            planes=np.empty((0, 9)),
            bin_start=np.zeros(2, np.int32),
            bin_items=np.empty(0, np.int32),
            bin_frame=np.array([0.0, 0.0, 1.0, 1.0, 1.0]),
            terrain=np.full((2, 2), float(z)),
            terrain_frame=np.array([0.0, 0.0, 1.0]),
        )

    def surfaces_under(self, points_m: ArrayLike) -> tuple[F64, I32]:
        """Return heights (N,) and triangle numbers (N,), -1 on terrain, under ``points_m`` (N, 3), z being the hint."""
        points = np.ascontiguousarray(points_m, np.float64).reshape(-1, 3)
        heights, triangles = np.empty(len(points)), np.empty(len(points), np.int32)
        for first in range(0, len(points), _POINTS_AT_ONCE):
            checkpoint()
            some = slice(first, first + _POINTS_AT_ONCE)
            _surfaces_under(self, points[some], heights[some], triangles[some])
        return heights, triangles


def _corners(vertices: ArrayLike, triangles: ArrayLike) -> F64:
    """Return the corners (T, 3, 3) of well-formed triangles."""
    points = np.asarray(vertices, np.float64).reshape(-1, 3)
    numbers = np.asarray(triangles, np.int64).reshape(-1, 3)
    if len(numbers) and not (numbers.min() >= 0 and numbers.max() < len(points)):
        raise ValueError(f"triangles name vertices outside 0..{len(points) - 1}: {numbers.min()}..{numbers.max()}")
    corners: F64 = np.ascontiguousarray(points[numbers])
    if not np.isfinite(corners).all():
        raise ValueError("a corner of a ground triangle is not a finite number")
    return corners


def _planes(corners_m: F64) -> F64:
    """Return (T, 9) as :class:`Ground` holds them; triangles without area seen from above become empty ones."""
    origin, first, second = corners_m[:, 0], corners_m[:, 1] - corners_m[:, 0], corners_m[:, 2] - corners_m[:, 0]
    area = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    wall = np.abs(area) < _LEAST_AREA_M2
    area = np.where(wall, 1.0, area)
    along_first = np.stack([second[:, 1], -second[:, 0]], 1) / area[:, None]
    along_second = np.stack([-first[:, 1], first[:, 0]], 1) / area[:, None]
    slope = along_first * first[:, 2:] + along_second * second[:, 2:]
    planes: F64 = np.column_stack([origin[:, :2], along_first, along_second, origin[:, 2], slope])
    planes[wall] = np.nan  # every comparison with it is false
    return np.ascontiguousarray(planes)


def _bin_frame(low_m: F64, high_m: F64, count: int) -> F64:
    """Choose bins of about two a triangle, none finer than a metre."""
    size_m = np.maximum(high_m - low_m, 1.0)
    bin_m = max(_FINEST_BIN_M, math.sqrt(size_m[0] * size_m[1] / (2.0 * count + 64.0)))
    counts = np.floor(size_m / bin_m) + 1.0
    return np.array([low_m[0], low_m[1], 1.0 / bin_m, counts[0], counts[1]])


@kernel
def _bin_of(at_m: float, origin_m: float, per_m: float, count: float) -> int:
    """Return the number of a bin along one axis, held inside the grid (nan goes to 0)."""
    place = (at_m - origin_m) * per_m
    if not place > 0.0:
        return 0
    return int(min(place, count - 1.0))


@unlocked
def _fill_bins(corners_m: F64, planes: F64, frame: F64) -> tuple[I32, I32]:
    """Return bin_start and bin_items: each triangle goes into every bin that its bounding rectangle touches."""
    columns = int(frame[3])
    start = np.zeros(columns * int(frame[4]) + 1, np.int32)
    reach = np.empty((len(corners_m), 4), np.int32)
    for t in range(len(corners_m)):
        c = corners_m[t]
        reach[t, 0] = _bin_of(min(c[0, 0], c[1, 0], c[2, 0]), frame[0], frame[2], frame[3])
        reach[t, 1] = _bin_of(max(c[0, 0], c[1, 0], c[2, 0]), frame[0], frame[2], frame[3])
        reach[t, 2] = _bin_of(min(c[0, 1], c[1, 1], c[2, 1]), frame[1], frame[2], frame[4])
        reach[t, 3] = _bin_of(max(c[0, 1], c[1, 1], c[2, 1]), frame[1], frame[2], frame[4])
        if math.isnan(planes[t, 0]):
            reach[t, 1] = reach[t, 0] - 1
        for row in range(reach[t, 2], reach[t, 3] + 1):
            for column in range(reach[t, 0], reach[t, 1] + 1):
                start[row * columns + column + 1] += 1
    for b in range(1, len(start)):
        start[b] += start[b - 1]
    items = np.empty(start[-1], np.int32)
    filled = start[:-1].copy()
    for t in range(len(corners_m)):
        for row in range(reach[t, 2], reach[t, 3] + 1):
            for column in range(reach[t, 0], reach[t, 1] + 1):
                b = row * columns + column
                items[filled[b]] = t
                filled[b] += 1
    return start, items


def _terrain(corners_m: F64, planes: F64, low_m: F64, high_m: F64) -> tuple[F64, F64]:
    """Return the terrain's heights and frame: the lowest triangle where there is one, else the nearest, smoothed."""
    low, high = low_m - _MARGIN_M, high_m + _MARGIN_M
    size = high - low
    spacing_m = max(_FINEST_TERRAIN_M, math.sqrt(size[0] * size[1] / _TERRAIN_NODES))
    frame = np.array([low[0], low[1], 1.0 / spacing_m])
    columns, rows = (np.ceil(size / spacing_m) + 1.0).astype(np.int64)
    heights = np.full((int(rows), int(columns)), np.inf)
    _seed_terrain(heights, corners_m, planes, frame)
    _spread_terrain(heights)
    return heights, frame


@unlocked
def _seed_terrain(heights_m: F64, corners_m: F64, planes: F64, frame: F64) -> None:
    """Give the nodes inside triangles, else those nearest to a corner, the lowest height found there."""
    rows, columns = heights_m.shape
    inside = np.zeros((rows, columns), np.bool_)
    for t in range(len(corners_m)):
        c = corners_m[t]
        first_column = math.ceil((min(c[0, 0], c[1, 0], c[2, 0]) - frame[0]) * frame[2])
        last_column = math.floor((max(c[0, 0], c[1, 0], c[2, 0]) - frame[0]) * frame[2])
        first_row = math.ceil((min(c[0, 1], c[1, 1], c[2, 1]) - frame[1]) * frame[2])
        last_row = math.floor((max(c[0, 1], c[1, 1], c[2, 1]) - frame[1]) * frame[2])
        for row in range(first_row, last_row + 1):
            for column in range(first_column, last_column + 1):
                x, y = frame[0] + column / frame[2], frame[1] + row / frame[2]
                z = _height_on(planes, t, x, y)
                if z > -math.inf:
                    heights_m[row, column] = min(z, heights_m[row, column])
                    inside[row, column] = True
    for t in range(len(corners_m)):
        for k in range(3):
            column = round((corners_m[t, k, 0] - frame[0]) * frame[2])
            row = round((corners_m[t, k, 1] - frame[1]) * frame[2])
            if not inside[row, column]:
                heights_m[row, column] = min(corners_m[t, k, 2], heights_m[row, column])


@unlocked
def _spread_terrain(heights_m: F64) -> None:
    """Fill the empty (inf) nodes from the nearest filled one, then smooth what was empty; in place.

    Nearest: Danielsson 1980, "Euclidean distance mapping", the sequential four-neighbour transform.
    """
    rows, columns = heights_m.shape
    empty, away = np.zeros((rows, columns), np.bool_), np.zeros((rows, columns))
    dx, dy = np.zeros((rows, columns)), np.zeros((rows, columns))
    _note_empty(heights_m, empty, away)
    for sweep in range(2):
        step = 1 if sweep == 0 else -1
        for i in range(rows):
            row = i if sweep == 0 else rows - 1 - i
            for j in range(columns * 2):
                if j < columns:  # from the row before, then to and fro along the row
                    column, from_row, from_column = j, row - step, j
                    _take_nearer(heights_m, away, dx, dy, row, column, from_row, from_column)
                    _take_nearer(heights_m, away, dx, dy, row, column, row, column - 1)
                else:
                    column = 2 * columns - 1 - j
                    _take_nearer(heights_m, away, dx, dy, row, column, row, column + 1)
    for _ in range(_SMOOTHINGS):
        for row in range(1, rows - 1):
            for column in range(1, columns - 1):
                if empty[row, column]:
                    around = heights_m[row - 1, column] + heights_m[row + 1, column]
                    around += heights_m[row, column - 1] + heights_m[row, column + 1]
                    heights_m[row, column] = 0.25 * around


@kernel
def _note_empty(heights_m: F64, empty: NDArray[np.bool_], away: F64) -> None:
    """Mark the nodes without a height (inf), which are as far from their source as can be; in place."""
    for row in range(heights_m.shape[0]):
        for column in range(heights_m.shape[1]):
            if math.isinf(heights_m[row, column]):
                empty[row, column], away[row, column] = True, 1e9


@kernel
def _take_nearer(
    heights_m: F64, away: F64, dx: F64, dy: F64, row: int, column: int, from_row: int, from_column: int
) -> None:
    """Let a node take over the source of its neighbour where that is nearer than its own."""
    if from_row < 0 or from_row >= away.shape[0] or from_column < 0 or from_column >= away.shape[1]:
        return
    if away[from_row, from_column] >= 1e9:
        return
    x = dx[from_row, from_column] + (column - from_column)
    y = dy[from_row, from_column] + (row - from_row)
    if x * x + y * y < away[row, column]:
        away[row, column] = x * x + y * y
        dx[row, column], dy[row, column] = x, y
        heights_m[row, column] = heights_m[from_row, from_column]


@kernel
def _height_on(planes: F64, t: int, x: float, y: float) -> float:
    """Return the height of triangle ``t`` over or under a point, by barycentric coordinates; -inf beside it."""
    away_x, away_y = x - planes[t, 0], y - planes[t, 1]
    first = planes[t, 2] * away_x + planes[t, 3] * away_y
    second = planes[t, 4] * away_x + planes[t, 5] * away_y
    if first >= -_EDGE_TOLERANCE and second >= -_EDGE_TOLERANCE and first + second <= 1.0 + _EDGE_TOLERANCE:
        return float(planes[t, 6] + planes[t, 7] * away_x + planes[t, 8] * away_y)
    return -math.inf


@kernel
def triangle_under(ground: Ground, x: float, y: float, z_hint: float) -> tuple[float, int]:
    """Return height and number of the highest triangle at most ``STEP_M`` above ``z_hint``, number -1 without one."""
    frame, start, items = ground.bin_frame, ground.bin_start, ground.bin_items
    b = _bin_of(y, frame[1], frame[2], frame[4]) * int(frame[3]) + _bin_of(x, frame[0], frame[2], frame[3])
    best_z, best = -math.inf, -1
    for k in range(start[b], start[b + 1]):
        z = _height_on(ground.planes, items[k], x, y)
        if best_z < z <= z_hint + STEP_M:
            best_z, best = z, items[k]
    return best_z, best


@kernel
def surface_under(ground: Ground, x: float, y: float, z_hint: float) -> tuple[float, float, float, float, int]:
    """Return height, upward normal (3) and triangle of the highest surface at most ``STEP_M`` above ``z_hint``.

    All in m. Where no triangle lies there (beside the roads, or all of them higher) the terrain answers, triangle -1.
    """
    z, triangle = triangle_under(ground, x, y, z_hint)
    if triangle < 0:
        return _terrain_under(ground, x, y)
    slope_x, slope_y = ground.planes[triangle, 7], ground.planes[triangle, 8]
    up = 1.0 / math.sqrt(1.0 + slope_x * slope_x + slope_y * slope_y)
    return z, -slope_x * up, -slope_y * up, up, triangle


@kernel
def _terrain_under(ground: Ground, x: float, y: float) -> tuple[float, float, float, float, int]:
    """Return the terrain's height and normal, bilinear between its nodes; its edge goes on for ever."""
    rows, columns = ground.terrain.shape
    per_m = ground.terrain_frame[2]
    fx = (x - ground.terrain_frame[0]) * per_m
    fy = (y - ground.terrain_frame[1]) * per_m
    fx = min(fx, columns - 1.0) if fx > 0.0 else 0.0
    fy = min(fy, rows - 1.0) if fy > 0.0 else 0.0
    column, row = min(int(fx), columns - 2), min(int(fy), rows - 2)
    fx, fy = fx - column, fy - row
    a, b = ground.terrain[row, column], ground.terrain[row, column + 1]
    c, d = ground.terrain[row + 1, column], ground.terrain[row + 1, column + 1]
    slope_x = ((b - a) * (1.0 - fy) + (d - c) * fy) * per_m
    slope_y = ((c - a) * (1.0 - fx) + (d - b) * fx) * per_m
    up = 1.0 / math.sqrt(1.0 + slope_x * slope_x + slope_y * slope_y)
    z = (a * (1.0 - fx) + b * fx) * (1.0 - fy) + (c * (1.0 - fx) + d * fx) * fy
    return z, -slope_x * up, -slope_y * up, up, -1


@unlocked
def _surfaces_under(ground: Ground, points_m: F64, heights_m: F64, triangles: I32) -> None:
    """Write what :func:`surface_under` finds for each row of (N, 3)."""
    for i in range(len(points_m)):
        heights_m[i], _, _, _, triangles[i] = surface_under(ground, points_m[i, 0], points_m[i, 1], points_m[i, 2])
