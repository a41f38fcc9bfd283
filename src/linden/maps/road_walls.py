"""Walls along the edges of roads, which keep vehicles on a road that was made of an OpenDRIVE text.

They stand along both sides of every road outside of junctions, as far beyond a driving lane as lanes are made wider.
Source: CARLA's MeshFactory.cpp (GenerateWalls) and Lane.cpp (GetCornerPositions). Frame: CARLA's.
"""

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.background import checkpoint
from linden.geometry import points_from_opendrive
from linden.maps.ground import Ground
from linden.maps.opendrive.evaluate.strips import Edges, edges_of, strips_of
from linden.maps.opendrive.evaluate.tables import Tables, tables_of
from linden.maps.opendrive.limits import MOST_WALL_PIECES
from linden.maps.opendrive.model import OpenDrive
from linden.protocol.values.enums import LaneType

F64 = NDArray[np.float64]

_LONGEST_M = 20.0  # of one piece: so that only those near a body are looked at
_MOST_RISE_M = 0.25  # of one piece: pieces are upright boxes
_SHORTEST_M = 0.05
_STRAIGHT = 1e-5  # change of direction, in radians, that counts as none
_PROBE_M = 0.1  # a piece behind which another road begins this near would stand between lanes
_HIGH_M = 1e9


class _Side(NamedTuple):
    lane: int  # row of Tables.lanes
    is_outer: bool  # along its outer edge, else along its inner one
    is_left: bool


def walls_along(opendrive: OpenDrive, ground: Ground, beyond_m: float) -> F64:
    """Return the feet (N, 2, 3) of the pieces of wall, from and to; ``beyond_m`` outside of driving lanes.

    Unlike CARLA's they leave out what would stand on another road, as between the two directions of a street.
    """
    tables = tables_of(opendrive)
    pieces = [piece for side, line in _lines(tables) for piece in _along(tables, side, line, beyond_m)]
    if not pieces:
        return np.empty((0, 2, 3))
    feet = np.concatenate([piece[0] for piece in pieces])
    probes = np.concatenate([piece[1] for piece in pieces])
    _, triangle = ground.surfaces_under(np.column_stack([probes, np.full(len(probes), _HIGH_M)]))
    free: F64 = feet[triangle < 0]
    return free


def _sides(tables: Tables) -> Iterator[_Side]:
    """Yield the lanes along which walls run: those furthest to either hand, or on a bare hand the innermost one."""
    for road_index, road in enumerate(tables.roads):
        for section_index, section in enumerate(() if road.is_in_junction else road.sections):
            ids = sorted(lane.id for lane in section.lanes if lane.id != 0)
            if ids:
                rows = {lane_id: tables.lane_row[road_index, section_index, lane_id] for lane_id in ids}
                yield _Side(rows[ids[0]], ids[0] < 0, is_left=False)
                yield _Side(rows[ids[-1]], ids[-1] > 0, is_left=True)


def _lines(tables: Tables) -> Iterator[tuple[_Side, F64]]:
    """Yield each side with the edge (N, 3) of its lane that it stands on; all lanes are laid out at once."""
    sides = list(_sides(tables))
    if not sides:
        return
    strips = strips_of(tables, np.array([side.lane for side in sides]))
    edges = Edges(*(points_from_opendrive(edge) for edge in edges_of(tables, strips)))
    begins = np.flatnonzero(np.concatenate([[True], ~strips.continues[:-1]]))
    of_lane = {int(strips.lane[begin]): at for begin, at in zip(begins, pairwise([*begins, None]), strict=True)}
    for side in sides:
        checkpoint()
        if side.lane in of_lane:  # a section shorter than any piece has no places
            begin, end = of_lane[side.lane]
            yield side, (edges.outer if side.is_outer else edges.inner)[begin:end]


def _along(tables: Tables, side: _Side, line: F64, beyond_m: float) -> Iterator[tuple[F64, F64]]:
    """Yield feet (K, 2, 3) and probes (K, 2), which lie just behind the middles of the pieces."""
    line = line[np.concatenate([[True], np.hypot(*np.diff(line[:, :2], axis=0).T) > _SHORTEST_M])]
    if len(line) < 2:
        return
    direction = np.gradient(line[:, :2], axis=0)
    direction /= np.hypot(*direction.T)[:, None]
    outward = np.column_stack([-direction[:, 1], direction[:, 0]]) * (-1.0 if side.is_left else 1.0)  # y points south
    if tables.lanes["type_bits"][side.lane] == LaneType.DRIVING:
        line[:, :2] += outward * beyond_m
    line, outward = line[bends := _bends(line)], outward[bends]
    for begin, end, behind in zip(line[:-1], line[1:], outward[:-1], strict=True):
        length_m, rise_m = math.hypot(*(end - begin)[:2]), abs(end[2] - begin[2])
        wanted = max(math.ceil(length_m / _LONGEST_M), math.ceil(rise_m / _MOST_RISE_M))
        count = min(wanted, MOST_WALL_PIECES)
        nodes = begin + np.linspace(0.0, 1.0, count + 1)[:, None] * (end - begin)
        yield np.stack([nodes[:-1], nodes[1:]], axis=1), 0.5 * (nodes[:-1] + nodes[1:])[:, :2] + _PROBE_M * behind


def _bends(line: F64) -> NDArray[np.bool_]:
    """Return which nodes of a line (N, 3) are needed: its ends, and where its direction changes.

    Every joint of two pieces is an edge that a body which slides along the wall may catch on.
    """
    ahead = np.diff(line, axis=0)
    ahead /= np.linalg.norm(ahead, axis=1)[:, None]
    turns: NDArray[np.bool_] = np.linalg.norm(np.diff(ahead, axis=0), axis=1) > _STRAIGHT
    return np.concatenate([[True], turns, [True]])
