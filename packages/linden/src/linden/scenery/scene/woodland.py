"""Trees of the open land: in back yards, on vacant ground, along the railroad; about a fifth of it lies under crowns.

Source of the share: what American neighbourhoods of this age have; no figure for Linden was found.
"""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from linden.maps.ground import Ground
from linden.plane_bins import nearby
from linden.protocol.values.enums import SemanticTag
from linden.scenery.scene.neighbourhood import SEED, TRUNK_HALF_M, TRUNK_HEIGHT_M, between
from linden.scenery.scene.objects import ObjectKind, Scene, assembled, boxes_on, things_with
from linden.structured import StructuredArray

F64 = NDArray[np.float64]

GRID_M = 24.0
SHARE = 0.3
FROM_ROAD_M = 8.0
FROM_OTHERS_M = 5.0
_NEAR_LOTS_M = 70.0
_FROM_LINE_M = 10.0
_HIGH_M = 1e9


def groves(lots: StructuredArray, others: Scene, avoid_m: F64, ground: Ground) -> Scene:
    """Return trees behind and between the lots, clear of roads, of other things, and of the line ``avoid_m`` (N, 2)."""
    places = _scattered(lots)
    draw = np.random.default_rng([SEED, 3]).random((len(places), 2))
    places = places[draw[:, 0] < SHARE]
    thick = draw[draw[:, 0] < SHARE, 1]
    open_land = far_from_roads(places, ground) & ~nearby(
        places, others.boxes["centre"][:, :2], np.hypot(*others.boxes["half"][:, :2].T) + FROM_OTHERS_M
    )
    open_land &= _away_from(places, avoid_m)
    places, thick = places[open_land], thick[open_land]
    height, _ = ground.surfaces_under(np.column_stack([places, np.full(len(places), _HIGH_M)]))
    things = things_with(ObjectKind.TREE, np.column_stack([places, height]), 6.0 * thick)
    half = np.full((len(places), 3), 0.5 * TRUNK_HEIGHT_M)
    half[:, :2] = between(TRUNK_HALF_M, thick)[:, None]
    return assembled(things, boxes_on(things, half * (0.0, 0.0, 1.0), half, SemanticTag.VEGETATION))


def _scattered(lots: StructuredArray) -> F64:
    """Return places (N, 2) on a grid, moved about at random, within some way of the lots."""
    if not len(lots):
        return np.empty((0, 2))
    low, high = lots["front_m"].min(axis=0) - _NEAR_LOTS_M, lots["front_m"].max(axis=0) + _NEAR_LOTS_M
    cells = np.stack(np.meshgrid(*(np.arange(low[k], high[k], GRID_M) for k in range(2)), indexing="ij"), axis=-1)
    flat = cells.reshape(-1, 2) + GRID_M * np.random.default_rng([SEED, 4]).random((cells.size // 2, 2))
    settled = np.unique(np.floor(lots["front_m"] / _NEAR_LOTS_M).astype(np.int64), axis=0)
    at = np.floor(flat / _NEAR_LOTS_M).astype(np.int64)
    near = np.zeros(len(flat), bool)
    for i in (-1, 0, 1):
        for j in (-1, 0, 1):
            near |= np.isin(_packed(at), _packed(settled + np.array([i, j])))
    scattered: F64 = flat[near]
    return scattered


def _packed(cells: NDArray[np.int64]) -> NDArray[np.int64]:
    packed: NDArray[np.int64] = cells[:, 0] * 1_000_000 + cells[:, 1]
    return packed


def far_from_roads(places: F64, ground: Ground) -> NDArray[np.bool_]:
    """Return which places (N, 2) lie further than ``FROM_ROAD_M`` from any road."""
    far = np.ones(len(places), bool)
    for angle in np.arange(8) * (np.pi / 4.0):
        for away in (0.5 * FROM_ROAD_M, FROM_ROAD_M):
            shifted = places + away * np.array([np.cos(angle), np.sin(angle)])
            far &= ground.surfaces_under(np.column_stack([shifted, np.full(len(places), _HIGH_M)]))[1] < 0
    return far


def _away_from(places: F64, line_m: F64) -> NDArray[np.bool_]:
    """Return which places lie well away from a line."""
    away = np.ones(len(places), bool)
    for begin, end in pairwise(line_m):
        ahead = end - begin
        share = np.clip(((places - begin) @ ahead) / max(float(ahead @ ahead), 1e-9), 0.0, 1.0)
        away &= np.hypot(*(places - begin - share[:, None] * ahead).T) > _FROM_LINE_M
    return away
