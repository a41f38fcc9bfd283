"""The land between and beyond the streets: it begins where the outermost lanes end and follows the ground's heights.

Corners lie densely along the edges of the roads and thinly elsewhere; the triangles between them are Delaunay's. Such
triangles keep an edge if its corners are closer to each other than to any other corner.
"""

import numpy as np
from numpy.typing import NDArray

from linden.maps.ground import Ground
from linden.protocol.values.enums import SemanticTag
from linden.scenery.mesh import Material, Mesh, faces
from linden.scenery.streets.junction_floors import Floors
from linden.scenery.streets.road import GRASS
from linden.scenery.streets.simplified_lanes import SimplifiedLanes

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

_EDGE_STEP_M = 4.0
_GRAIN_M = 45.0
_CLEAR_M = 5.5  # no corner of the open land lies nearer to a road
_BELOW_EDGE_M = 0.004
_PROBE_M = 0.08
_MARGIN_M = 150.0  # past the outermost road
_FAR_M = 2500.0  # to where a last ring of land reaches, so that the horizon is land
_HIGH_M = 1e6


def land(simplified_lanes: SimplifiedLanes, ground: Ground, floors: Floors) -> Mesh:
    """Return the land of a map; flat and empty where the map has no roads."""
    edges = _edges(simplified_lanes, ground)
    if not len(edges):
        edges = np.zeros((1, 3))
    points = _thinned(np.concatenate([edges, _open_land(edges, ground), _horizon(edges, ground)]))
    triangles = _delaunay(points[:, :2])
    a, b, c = (points[triangles[:, k]] for k in range(3))
    turned = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) < (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    triangles[turned] = triangles[turned][:, [0, 2, 1]]
    middle = (a + b + c) / 3.0
    triangles = triangles[~(_on_roads(middle, ground) | floors.take(middle[:, :2]))]
    return Mesh(
        points.astype(np.float32),
        triangles.astype(np.uint32),
        faces(len(triangles), Material.GRASS, SemanticTag.TERRAIN, GRASS),
    )


def _delaunay(points: F64) -> I64:
    """Return Delaunay's triangles (T, 3) of different points (N, 2), as their indices."""
    import shapely  # noqa: PLC0415 - 0.2 s, which a server with cached maps does without

    corners = shapely.get_coordinates(shapely.delaunay_triangles(shapely.multipoints(points))).reshape(-1, 4, 2)[:, :3]
    number = {point: index for index, point in enumerate(map(tuple, points.tolist()))}
    return np.array([number[x, y] for x, y in corners.reshape(-1, 2).tolist()], np.int64).reshape(-1, 3)


def _on_roads(points: F64, ground: Ground) -> NDArray[np.bool_]:
    high = np.column_stack([points[:, :2], np.full(len(points), _HIGH_M)])
    on: NDArray[np.bool_] = ground.surfaces_under(high)[1] >= 0
    return on


def _edges(simplified_lanes: SimplifiedLanes, ground: Ground) -> F64:
    """Return corners (N, 3) along the outer edges of the outermost lanes, where no other road lies beyond."""
    if not len(simplified_lanes.lane):
        return np.empty((0, 3))
    inside = simplified_lanes.tables.lanes["inside"]
    outermost, innermost = ~np.isin(simplified_lanes.lane, inside), inside[simplified_lanes.lane] < 0
    places = []
    for line, other, wanted in (
        (simplified_lanes.outer, simplified_lanes.inner, outermost),
        (simplified_lanes.inner, simplified_lanes.outer, innermost),
    ):
        rows = np.flatnonzero(wanted & simplified_lanes.continues & np.append(wanted[1:], [False]))
        away = line - other
        away[:, 2] = 0.0
        away /= np.maximum(np.hypot(*away[:, :2].T), 1e-6)[:, None]
        begin, end = line[rows], line[rows + 1]
        count = np.maximum(1, np.ceil(np.hypot(*(end - begin)[:, :2].T) / _EDGE_STEP_M)).astype(np.int64)
        piece = np.repeat(np.arange(len(rows)), count)
        share = (np.arange(len(piece)) - np.repeat(np.cumsum(count) - count, count)) / count[piece]
        found = begin[piece] + share[:, None] * (end - begin)[piece]
        last = ~simplified_lanes.continues[rows + 1]
        both = np.concatenate([found, end[last]])
        outward = np.concatenate([away[rows][piece], away[rows + 1][last]])
        places.append(both[~_on_roads(both + _PROBE_M * outward, ground)])
    edges: F64 = np.concatenate(places) - np.array([0.0, 0.0, _BELOW_EDGE_M])
    return edges


def _thinned(points: F64) -> F64:
    """Return the points without points within centimetres of an earlier one: triangles need some width."""
    cell = np.round(points[:, :2] / 0.25).astype(np.int64)
    _, first = np.unique(cell, axis=0, return_index=True)
    return points[np.sort(first)]


def _open_land(edges: F64, ground: Ground) -> F64:
    """Return corners of a staggered grid wherever no road is near."""
    low, high = edges[:, :2].min(axis=0) - _MARGIN_M, edges[:, :2].max(axis=0) + _MARGIN_M
    x, y = (np.arange(low[k], high[k], _GRAIN_M) for k in range(2))
    grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    grid[:, 1::2, 0] += 0.5 * _GRAIN_M if grid.shape[1] > 1 else 0.0
    flat = grid.reshape(-1, 2)
    angles = np.arange(8) * (np.pi / 4.0)
    near = np.zeros(len(flat), bool)
    for away in (0.0, 0.5 * _CLEAR_M, _CLEAR_M):
        for angle in angles[: 1 if away == 0.0 else 8]:
            near |= _on_roads(flat + away * np.array([np.cos(angle), np.sin(angle)]), ground)
    flat = flat[~near]
    height, _ = ground.surfaces_under(np.column_stack([flat, np.full(len(flat), _HIGH_M)]))
    return np.column_stack([flat, height])


def _horizon(edges: F64, ground: Ground) -> F64:
    """Return a ring of corners far out."""
    low, high = edges[:, :2].min(axis=0) - _FAR_M, edges[:, :2].max(axis=0) + _FAR_M
    share = np.linspace(0.0, 1.0, 9)
    side = [
        np.array([low[0] + k * (high[0] - low[0]), low[1] + j * (high[1] - low[1])])
        for k in share
        for j in share
        if k in (0.0, 1.0) or j in (0.0, 1.0)
    ]
    ring = np.array(side)
    height, _ = ground.surfaces_under(np.column_stack([ring, np.full(len(ring), _HIGH_M)]))
    return np.column_stack([ring, height])
