"""Tiles of a walking mesh, and the Detour file that CARLA's client loads.

A walking mesh consists of square tiles of convex polygons, each of one area. Frame: CARLA's, metres. The client reads
the file in ``carla/nav/Navigation.cpp``. Layout: Recast Navigation, ``DetourNavMesh.h``, mesh version 7, references of
32 bits, and its demo's tile set. Detour's x is CARLA's x, its y (up) is z, and its z is y.
"""

import struct
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]


class Area(IntEnum):
    """CARLA's areas, as its client knows them (``carla/nav/Navigation.h``)."""

    BLOCK = 0
    SIDEWALK = 1
    CROSSWALK = 2
    ROAD = 3
    GRASS = 4


BORDER = -1
"""Neighbour of a side that ends the mesh."""
WEST, SOUTH, EAST, NORTH = -2, -3, -4, -5
"""Neighbour of a side that lies on the tile's side of that name: what touches it over there goes on."""


class Obstacles(NamedTuple):
    """Upright boxes that stand in the way: centres (M, 3) and half sizes (M, 3) in m, yaws (M,) in rad."""

    centre_m: F64
    half_m: F64
    yaw_rad: F64


class Polygon(NamedTuple):
    """Up to six corners, as rows of the tile's vertices, and for each side from a corner to the next its neighbour."""

    area: Area
    corners: tuple[int, ...]
    neighbours: tuple[int, ...]


class Tile(NamedTuple):
    """``column`` counts along x, ``row`` along y."""

    column: int
    row: int
    vertices_m: F64
    polygons: tuple[Polygon, ...]


class WalkingMesh(NamedTuple):
    """``origin_m``: x and y of the corner where tile (0, 0) begins."""

    origin_m: tuple[float, float]
    tile_m: float
    tiles: tuple[Tile, ...]


SET_MAGIC, SET_VERSION = 0x4D534554, 1  # "MSET"
TILE_MAGIC, TILE_VERSION = 0x444E4156, 7  # "DNAV"
SET_HEADER = struct.Struct("<3i3f2f2i")
TILE_PLACE = struct.Struct("<Ii")
TILE_HEADER = struct.Struct("<5iI9i3f6ff")
POLYGON = np.dtype(
    [
        ("first_link", "<u4"),
        ("corners", "<u2", 6),
        ("neighbours", "<u2", 6),
        ("flags", "<u2"),
        ("corner_count", "u1"),
        ("area_and_type", "u1"),
    ]
)
DETAIL = np.dtype([("vertex", "<u4"), ("triangle", "<u4"), ("vertices", "u1"), ("triangles", "u1"), ("padding", "<u2")])
LINK_BYTES = 12
NO_LINK = 0xFFFFFFFF
FLAG_OF_AREA = {Area.SIDEWALK: 0x02, Area.CROSSWALK: 0x04, Area.ROAD: 0x08, Area.GRASS: 0x10}
_SIDES = {BORDER: 0, EAST: 0x8000, SOUTH: 0x8002, WEST: 0x8004, NORTH: 0x8006}
"""Neighbours as Detour writes them: DT_EXT_LINK with the side; others are numbers of polygons plus one."""

_HEIGHT_M, _RADIUS_M, _CLIMB_M = 1.8, 0.3, 0.6
_SALT = 1
_MOST_BITS = 22
"""Detour leaves ten of a reference's 32 bits to the salt."""


def write(mesh: WalkingMesh) -> bytes:
    """Return the file of a mesh.

    Raises:
        ValueError: more tiles or polygons than a reference can name; a map of some thousand kilometres of road.
    """
    most_polygons = max((len(tile.polygons) for tile in mesh.tiles), default=1)
    tile_bits, polygon_bits = _bits(len(mesh.tiles)), _bits(most_polygons)
    if tile_bits + polygon_bits > _MOST_BITS:
        raise ValueError(f"{len(mesh.tiles)} tiles of up to {most_polygons} polygons are too many for one mesh")
    origin = (mesh.origin_m[0], 0.0, mesh.origin_m[1])
    counts = (1 << tile_bits, 1 << polygon_bits)
    parts = [SET_HEADER.pack(SET_MAGIC, SET_VERSION, len(mesh.tiles), *origin, mesh.tile_m, mesh.tile_m, *counts)]
    for number, tile in enumerate(mesh.tiles):
        data = _tile(tile)
        reference = (_SALT << (tile_bits + polygon_bits)) | (number << polygon_bits)
        parts += [TILE_PLACE.pack(reference, len(data)), data]
    return b"".join(parts)


def _bits(count: int) -> int:
    return max(1, (count - 1).bit_length())


def _tile(tile: Tile) -> bytes:
    """Return the data of one tile."""
    count = len(tile.polygons)
    corner_counts = np.array([len(polygon.corners) for polygon in tile.polygons])
    polygons = np.zeros(count, POLYGON)
    polygons["first_link"] = NO_LINK
    polygons["corner_count"] = corner_counts
    for row, polygon in zip(polygons, tile.polygons, strict=True):
        row["corners"][: len(polygon.corners)] = polygon.corners
        row["neighbours"][: len(polygon.corners)] = [
            _SIDES.get(neighbour, neighbour + 1) for neighbour in polygon.neighbours
        ]
        row["flags"], row["area_and_type"] = FLAG_OF_AREA[polygon.area], polygon.area
    details = np.zeros(count, DETAIL)
    details["triangles"] = corner_counts - 2
    details["triangle"] = np.cumsum(corner_counts - 2) - (corner_counts - 2)
    fans = {corners: _fan(corners) for corners in set(corner_counts.tolist())}
    fan = np.array([triangle for corners in corner_counts.tolist() for triangle in fans[corners]], np.uint8)
    vertices = np.ascontiguousarray(tile.vertices_m[:, [0, 2, 1]], "<f4")
    links = int(corner_counts.sum()) + 2 * _sides_on_border(tile)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    header = TILE_HEADER.pack(
        TILE_MAGIC, TILE_VERSION, tile.column, tile.row, 0, 0,
        count, len(vertices), links, count, 0, len(fan), 0, 0, count,
        _HEIGHT_M, _RADIUS_M, _CLIMB_M, *map(float, low), *map(float, high), 1.0,
    )  # fmt: skip
    body = (vertices, polygons, b"\0" * LINK_BYTES * links, details, fan)
    return header + b"".join(part if isinstance(part, bytes) else part.tobytes() for part in body)


def _fan(corners: int) -> list[tuple[int, int, int, int]]:
    """Return a polygon's triangles from its first corner: three corners, and by two bits each which sides are outer."""
    last = corners - 3
    return [(0, n + 1, n + 2, (n == 0) | 1 << 2 | (n == last) << 4) for n in range(corners - 2)]


def _sides_on_border(tile: Tile) -> int:
    """Return how many sides may be linked to other tiles; each may find several neighbours there."""
    return sum(neighbour < BORDER for polygon in tile.polygons for neighbour in polygon.neighbours)
