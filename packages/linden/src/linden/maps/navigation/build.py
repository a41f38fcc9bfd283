"""The walking mesh of a map: every tile painted, cleared of what stands there, and cut into convex polygons."""

import logging
import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from linden.background import checkpoint
from linden.maps.navigation import raster
from linden.maps.navigation.areas import Surfaces
from linden.maps.navigation.contour import Corner, faces_of
from linden.maps.navigation.detour import BORDER, EAST, NORTH, SOUTH, WEST, Area, Obstacles, Polygon, Tile, WalkingMesh
from linden.maps.navigation.raster import CROSSWALK, EDGE, LEVELS, ROAD, SIDEWALK, VOID
from linden.maps.navigation.triangulate import convex_polygons
from linden.maps.opendrive.limits import MOST_WALKING_TILES

log = logging.getLogger("linden")

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]
U8 = NDArray[np.uint8]

CELL_M = 0.2
CELLS = 320
"""Of a tile's side: 64 m, so that a straight pavement has few polygons and a tile few hundred."""
RADIUS_M = 0.3
"""A walker's, to the client (``Navigation.cpp``: AGENT_RADIUS)."""
_MARGIN = 3
"""Cells seen round a tile, so that what is cleared at its border is cleared alike on both sides."""
_TOLERANCE_M = 0.29
_TOLERANCE_Z_M = 0.25

_AREA_OF_KIND = np.zeros(5, np.uint8)
_AREA_OF_KIND[[SIDEWALK, CROSSWALK, ROAD, EDGE]] = Area.SIDEWALK, Area.CROSSWALK, Area.ROAD, Area.ROAD


def build(surfaces: Surfaces, obstacles: Obstacles) -> WalkingMesh:
    """Return the mesh. Tiles on which there is neither pavement nor crosswalk are left out: no walker starts there."""
    of_walker = np.flatnonzero((surfaces.kinds == SIDEWALK) | (surfaces.kinds == CROSSWALK))
    if not (surfaces.kinds == SIDEWALK).any():
        return WalkingMesh((0.0, 0.0), CELLS * CELL_M, ())
    low_m = np.floor(surfaces.corners_m[of_walker].min(axis=(0, 1))[:2])
    tile_m = CELLS * CELL_M
    triangles_of = _by_tile(surfaces.corners_m.min(axis=1)[:, :2], surfaces.corners_m.max(axis=1)[:, :2], low_m, tile_m)
    walked_m = surfaces.corners_m[of_walker, :, :2]
    wanted = _by_tile(walked_m.min(axis=1), walked_m.max(axis=1), low_m, tile_m)
    reach_m = np.hypot(obstacles.half_m[:, 0], obstacles.half_m[:, 1]) + RADIUS_M
    around = obstacles.centre_m[:, :2]
    boxes_of = _by_tile(around - reach_m[:, None], around + reach_m[:, None], low_m, tile_m)
    if len(wanted) > MOST_WALKING_TILES:
        log.warning(
            "the map's pavements take %d tiles, too many for a walking mesh: walkers cannot find paths on this map",
            len(wanted),
        )
        return WalkingMesh((0.0, 0.0), tile_m, ())
    tiles = []
    for column, row in sorted(wanted):
        if column < 0 or row < 0:
            continue
        checkpoint()
        frame = np.array([low_m[0] + column * tile_m, low_m[1] + row * tile_m, CELL_M])
        frame[:2] -= _MARGIN * CELL_M
        boxes = boxes_of.get((column, row), np.empty(0, np.int32))
        nearby = Obstacles(
            obstacles.centre_m[boxes],
            obstacles.half_m[boxes] + np.array([RADIUS_M, RADIUS_M, 0.0]),
            obstacles.yaw_rad[boxes],
        )
        kind, z_m = _painted(surfaces, triangles_of[column, row], nearby, frame)
        polygons = list(_polygons(kind, z_m))
        if any(area in (Area.SIDEWALK, Area.CROSSWALK) for area, _, _ in polygons):
            corner_m = (float(low_m[0] + column * tile_m), float(low_m[1] + row * tile_m))
            tiles.append(_tile(column, row, polygons, corner_m))
    return WalkingMesh((float(low_m[0]), float(low_m[1])), tile_m, tuple(tiles))


def _by_tile(low_m: F64, high_m: F64, origin_m: F64, tile_m: float) -> dict[tuple[int, int], I32]:
    """Return for each tile (column, row) what touches it or its margin, of things given by their rectangles."""
    margin_m = _MARGIN * CELL_M
    first = np.floor((low_m - margin_m - origin_m) / tile_m).astype(np.int64)
    last = np.floor((high_m + margin_m - origin_m) / tile_m).astype(np.int64)
    found: dict[tuple[int, int], list[NDArray[np.int64]]] = {}
    spans = last - first
    for across in range(int(spans[:, 0].max(initial=-1)) + 1):
        for down in range(int(spans[:, 1].max(initial=-1)) + 1):
            items = np.flatnonzero((spans[:, 0] >= across) & (spans[:, 1] >= down))
            places = first[items] + (across, down)
            order = np.lexsort((items, places[:, 1], places[:, 0]))
            items, places = items[order], places[order]
            begins = np.flatnonzero(np.any(np.diff(places, axis=0, prepend=places[:1] - 1) != 0, axis=1))
            for part, begin in zip(np.split(items, begins[1:]), begins, strict=True) if len(items) else ():
                found.setdefault((int(places[begin, 0]), int(places[begin, 1])), []).append(part)
    return {place: np.sort(np.concatenate(parts)).astype(np.int32) for place, parts in found.items()}


def _painted(surfaces: Surfaces, items: I32, obstacles: Obstacles, frame: F64) -> tuple[U8, F64]:
    """Return what the cells of a tile and its margin are, and their heights (levels, rows, columns)."""
    size = CELLS + 2 * _MARGIN
    kind, z_m = np.zeros((LEVELS, size, size), np.uint8), np.zeros((LEVELS, size, size))
    lanes = items[surfaces.kinds[items] != CROSSWALK]
    crossings = items[surfaces.kinds[items] == CROSSWALK]
    raster.paint(surfaces.corners_m, surfaces.kinds, lanes, frame, kind, z_m)
    levels = _used(kind)
    raster.close_gaps(kind[:levels], z_m[:levels])
    raster.keep_clear(kind[:levels], z_m[:levels])
    raster.paint(surfaces.corners_m, surfaces.kinds, crossings, frame, kind, z_m)
    levels = _used(kind)
    raster.block(*obstacles, frame, kind[:levels], z_m[:levels])
    if levels > 1:
        raster.untangle(kind[:levels], z_m[:levels])
    inside = slice(_MARGIN, _MARGIN + CELLS)
    return kind[:levels, inside, inside], z_m[:levels, inside, inside]


def _used(kind: U8) -> int:
    """Return how many levels are in use; the lower ones fill first."""
    return max(1, int((kind != VOID).any(axis=(1, 2)).sum()))


def _polygons(kind: U8, z_m: F64) -> Iterator[tuple[Area, list[Corner], list[float]]]:
    """Yield convex polygons with the heights of their corners, floor after floor."""
    for level in range(len(kind)):
        area = np.ascontiguousarray(_AREA_OF_KIND[kind[level]])
        if not area.any():
            continue
        corner_z_m = _corner_heights(kind[level] != VOID, z_m[level])
        for face in faces_of(area, corner_z_m, cell_m=CELL_M, tolerance_m=_TOLERANCE_M, tolerance_z_m=_TOLERANCE_Z_M):
            for polygon in convex_polygons(face.outer, face.holes):
                yield Area(face.kind), polygon, [float(corner_z_m[y, x]) for x, y in polygon]


def _corner_heights(walkable: NDArray[np.bool_], z_m: F64) -> F64:
    """Return the height at each corner of the cells: that of the highest walkable cell round it."""
    framed = np.full((z_m.shape[0] + 2, z_m.shape[1] + 2), -math.inf)
    framed[1:-1, 1:-1][walkable] = z_m[walkable]
    heights: F64 = np.maximum(
        np.maximum(framed[:-1, :-1], framed[1:, :-1]), np.maximum(framed[:-1, 1:], framed[1:, 1:])
    )
    return np.where(np.isfinite(heights), heights, 0.0)


def _tile(
    column: int, row: int, polygons: list[tuple[Area, list[Corner], list[float]]], corner_m: tuple[float, float]
) -> Tile:
    """Return a tile of polygons: corners shared, neighbours found by their common sides."""
    number: dict[tuple[Corner, float], int] = {}
    rings = []
    for _, loop, heights_m in polygons:
        rings.append([number.setdefault((corner, z), len(number)) for corner, z in zip(loop, heights_m, strict=True)])
    owner = {side: n for n, ring in enumerate(rings) for side in zip(ring, [*ring[1:], ring[0]], strict=True)}
    places = [corner for corner, _ in number]
    finished = []
    for (area, _, _), ring in zip(polygons, rings, strict=True):
        sides = zip(ring, [*ring[1:], ring[0]], strict=True)
        beyond = tuple(owner.get((b, a), _border(places[a], places[b])) for a, b in sides)
        finished.append(Polygon(area, tuple(ring), beyond))
    vertices_m = np.array([(corner_m[0] + x * CELL_M, corner_m[1] + y * CELL_M, z) for (x, y), z in number])
    return Tile(column, row, vertices_m, tuple(finished))


def _border(a: Corner, b: Corner) -> int:
    """Return on which side of the tile a line lies, if on any."""
    if a[0] == b[0] and a[0] in (0, CELLS):
        return EAST if a[0] else WEST
    if a[1] == b[1] and a[1] in (0, CELLS):
        return SOUTH if a[1] else NORTH
    return BORDER
