"""A floor under every junction, so that nothing is seen between its lanes.

Lanes of turns cover a junction's middle only nearly: small gaps stay between three turns, and cracks beside the kerbs.
A floor lies a finger's breadth under the lanes, made of square cells; the land leaves those to it.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.background import checkpoint
from linden.maps.ground import Ground
from linden.maps.opendrive.limits import MOST_FLOOR_CELLS
from linden.maps.opendrive.mesh import RoadMesh
from linden.maps.opendrive.model import NO_JUNCTION
from linden.protocol.values.enums import SemanticTag
from linden.scenery.mesh import Material, Mesh, join
from linden.scenery.patches import PatchLook, polygons
from linden.scenery.streets.road import ASPHALT, is_paved

F64 = NDArray[np.float64]
Flags = NDArray[np.bool_]

CELL_M = 1.0
_LARGEST_GAP = 25  # cells; what is larger is an island of its own, as in a roundabout
_LONGEST_RUN = 16  # cells that one quad spans
_UNDER_M = 0.022  # where a road sags, the middle of a quad lies up to 16 mm above its ends; paint is 6 mm high
_MARGIN = 2
_HIGH_M = 1e6
_FILLS = 12


class Floors(NamedTuple):
    """The floors and the cells they take: pairs of whole numbers, (N, 2), of CELL_M."""

    mesh: Mesh
    cells: NDArray[np.int64]

    def take(self, points_m: F64) -> Flags:
        """Return which points (N, 2) lie on a cell of a floor."""
        if not len(self.cells):
            return np.zeros(len(points_m), bool)
        at = np.floor(points_m / CELL_M).astype(np.int64)
        taken: Flags = np.isin(_packed(at), _packed(self.cells))
        return taken


def _packed(cells: NDArray[np.int64]) -> NDArray[np.int64]:
    packed: NDArray[np.int64] = cells[:, 0] * 4_000_000_000 + cells[:, 1]
    return packed


def floors(road: RoadMesh, ground: Ground) -> Floors:
    """Return the floors of all junctions of a map."""
    junction = road.lanes["junction"][road.lane_of_triangle]
    paved = is_paved(road.lanes["type_bits"])
    rows = np.flatnonzero((junction != NO_JUNCTION) & paved[road.lane_of_triangle])
    rows = rows[np.argsort(junction[rows], kind="stable")]
    made: list[tuple[F64, NDArray[np.int64]]] = []
    for group in np.split(rows, np.flatnonzero(np.diff(junction[rows])) + 1):
        if len(group):
            corners = road.vertices[road.triangles[group]].reshape(-1, 3)[:, :2]
            made.append(_floor(corners.min(axis=0), corners.max(axis=0), road, ground, paved))
    if not made:
        return Floors(join([]), np.empty((0, 2), np.int64))
    quads = np.concatenate([quad for quad, _ in made])
    look = PatchLook(Material.ASPHALT, SemanticTag.ROADS, ASPHALT)
    return Floors(polygons(quads, look, (0.0, 0.0, 1.0)), np.concatenate([cells for _, cells in made]))


def _floor(low: F64, high: F64, road: RoadMesh, ground: Ground, paved: Flags) -> tuple[F64, NDArray[np.int64]]:
    """Return the quads (Q, 4, 3) and the cells of one junction's floor."""
    first = np.floor(low / CELL_M).astype(np.int64) - _MARGIN
    count = np.ceil(high / CELL_M).astype(np.int64) + _MARGIN - first + 1
    if count.prod() > MOST_FLOOR_CELLS:
        return np.empty((0, 4, 3)), np.empty((0, 2), np.int64)
    checkpoint()
    x, y = (CELL_M * (first[k] + np.arange(count[k])) for k in range(2))
    nodes = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    height, triangle = ground.surfaces_under(np.column_stack([nodes, np.full(len(nodes), _HIGH_M)]))
    shape = (int(count[0]), int(count[1]))
    on_road = (triangle >= 0).reshape(shape)
    driven = on_road & paved[road.lane_of_triangle[triangle]].reshape(shape)
    gap = _gaps(~on_road)
    z = _spread(np.where(driven, height.reshape(shape), np.nan)) - _UNDER_M
    wanted = _any_corner(driven | gap) & ~_any_corner(~on_road & ~gap) & ~_any_corner(np.isnan(z))
    quads = []
    for i, j in zip(*np.nonzero(wanted), strict=True):
        if (j - _run_start(wanted[i], j)) % _LONGEST_RUN:
            continue  # part of the quad begun before it
        end = j + 1
        while end < shape[1] - 1 and wanted[i, end] and end - j < _LONGEST_RUN:
            end += 1
        quads.append([(x[a], y[b], z[a, b]) for a, b in ((i, j), (i + 1, j), (i + 1, end), (i, end))])
    return np.array(quads).reshape(-1, 4, 3), np.argwhere(wanted) + first


def _run_start(row: Flags, at: int) -> int:
    while at > 0 and row[at - 1]:
        at -= 1
    return at


def _any_corner(nodes: Flags) -> Flags:
    """Return for each cell whether any of its four corners is so."""
    return nodes[:-1, :-1] | nodes[1:, :-1] | nodes[:-1, 1:] | nodes[1:, 1:]


def _gaps(empty: Flags) -> Flags:
    """Return the nodes without a road that lie in small pockets, closed all round."""
    outside = np.zeros_like(empty)
    outside[[0, -1]], outside[:, [0, -1]] = empty[[0, -1]], empty[:, [0, -1]]
    outside = _grown(outside, empty)
    closed = empty & ~outside
    gaps = np.zeros_like(empty)
    while closed.any():
        seed = np.zeros_like(empty)
        seed[tuple(np.argwhere(closed)[0])] = True
        pocket = _grown(seed, closed)
        closed = closed & ~pocket
        if pocket.sum() <= _LARGEST_GAP:
            gaps |= pocket
    return gaps


def _grown(seed: Flags, within: Flags) -> Flags:
    """Return what can be reached from the seed by steps to neighbours."""
    while True:
        grown = seed.copy()
        grown[1:] |= seed[:-1]
        grown[:-1] |= seed[1:]
        grown[:, 1:] |= seed[:, :-1]
        grown[:, :-1] |= seed[:, 1:]
        grown &= within
        if (grown == seed).all():
            return seed
        seed = grown


def _spread(z: F64) -> F64:
    """Return heights with those missing taken from the lowest neighbour, some cells far."""
    for _ in range(_FILLS):
        missing = np.isnan(z)
        if not missing.any():
            break
        padded = np.pad(z, 1, constant_values=np.nan)
        near = np.stack([padded[:-2, 1:-1], padded[2:, 1:-1], padded[1:-1, :-2], padded[1:-1, 2:]])
        lowest = np.where(np.isnan(near), np.inf, near).min(axis=0)
        z = np.where(missing & np.isfinite(lowest), lowest, z)
    return z
