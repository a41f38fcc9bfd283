"""A walking mesh as frozen values: square tiles of convex polygons, each of one area. Frame: CARLA's, metres."""

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
