"""Walls along the edges of roads, which keep vehicles on a road that was made of an OpenDRIVE text.

They stand along both sides of every road outside of junctions, as far beyond a driving lane as lanes are made wider.
Source: CARLA's MeshFactory.cpp (GenerateWalls) and Lane.cpp (GetCornerPositions). Frame: CARLA's.
"""

from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.background import checkpoint
from linden.geometry import points_from_opendrive
from linden.maps.ground import Ground
from linden.maps.opendrive.evaluate.strips import edges_of, strips_of
from linden.maps.opendrive.evaluate.tables import Tables, tables_of
from linden.maps.opendrive.limits import MOST_WALL_PIECES
from linden.maps.opendrive.model import OpenDrive
from linden.protocol.values.enums import LaneType

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

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
    sides = list(_sides(tables))
    if not sides:
        return np.empty((0, 2, 3))
    feet, probes = _pieces(*_along(tables, sides, *_lines(tables, sides), beyond_m))
    _, triangle = ground.surfaces_under(np.column_stack([probes, np.full(len(probes), _HIGH_M)]))
    free: F64 = feet[triangle < 0]
    return free


def _sides(tables: Tables) -> Iterator[_Side]:
    """Yield the lanes along which walls run: those furthest to either hand, or on a bare hand the innermost one."""
    for road_index, road in enumerate(tables.roads):
        for section_index, section in enumerate(() if road.is_in_junction else road.sections):
            checkpoint()
            ids = sorted(lane.id for lane in section.lanes if lane.id != 0)
            if ids:
                rows = {lane_id: tables.lane_row[road_index, section_index, lane_id] for lane_id in ids}
                yield _Side(rows[ids[0]], ids[0] < 0, is_left=False)
                yield _Side(rows[ids[-1]], ids[-1] > 0, is_left=True)


def _lines(tables: Tables, sides: list[_Side]) -> tuple[F64, I64]:
    """Return the places (N, 3) of the edges that walls stand on, side after side, and the number of each one's side.

    All lanes are laid out at once. A section shorter than any piece has no places.
    """
    strips = strips_of(tables, np.array([side.lane for side in sides]))
    inner, outer = (points_from_opendrive(edge) for edge in edges_of(tables, strips))
    begins = np.flatnonzero(np.concatenate([[True], ~strips.continues[:-1]])[: len(strips.lane)])
    of_lane = {int(strips.lane[begin]): at for begin, at in zip(begins, pairwise([*begins, None]), strict=True)}
    parts: list[F64] = [np.empty((0, 3))]
    numbers = [np.empty(0, np.int64)]
    for number, side in enumerate(sides):
        if side.lane in of_lane:
            begin, end = of_lane[side.lane]
            parts.append((outer if side.is_outer else inner)[begin:end])
            numbers.append(np.full(len(parts[-1]), number))
    return np.concatenate(parts), np.concatenate(numbers)


def _along(tables: Tables, sides: list[_Side], line: F64, number: I64, beyond_m: float) -> tuple[F64, F64, I64]:
    """Return the nodes (N, 3) of the walls, which way is outward there (N, 2), and the number of each one's side."""
    far = np.hypot(*np.diff(line[:, :2], axis=0).T) > _SHORTEST_M
    kept = np.concatenate([[True], far | (np.diff(number) != 0)])[: len(line)]
    line, number = line[kept], number[kept]
    first, last = _ends(number)
    kept = ~(first & last)  # a wall has two nodes at least
    line, number = line[kept], number[kept]
    first, last = _ends(number)
    rows = np.arange(len(line))
    behind, ahead = rows - ~first, rows + ~last
    direction = (line[ahead, :2] - line[behind, :2]) / (ahead - behind)[:, None]
    direction /= np.hypot(*direction.T)[:, None]
    hand = np.where(np.array([side.is_left for side in sides]), -1.0, 1.0)[number]
    outward = np.column_stack([-direction[:, 1], direction[:, 0]]) * hand[:, None]  # y points south
    lane = np.array([side.lane for side in sides])[number]
    line[:, :2] += np.where((tables.lanes["type_bits"][lane] == LaneType.DRIVING)[:, None], outward * beyond_m, 0.0)
    needed = first | last | _bends(line)
    return line[needed], outward[needed], number[needed]


def _ends(number: I64) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return which nodes are the first and which are the last of their side."""
    changes = np.diff(number) != 0
    return np.concatenate([[True], changes])[: len(number)], np.concatenate([changes, [True]])[: len(number)]


def _bends(line: F64) -> NDArray[np.bool_]:
    """Return which nodes of a line (N, 3) are needed because its direction changes there.

    Every joint of two pieces is an edge that a body which slides along the wall may catch on.
    """
    turns = np.zeros(len(line), np.bool_)
    ahead = np.diff(line, axis=0)
    ahead /= np.maximum(np.linalg.norm(ahead, axis=1), _SHORTEST_M * _SHORTEST_M)[:, None]
    turns[1:-1] = np.linalg.norm(np.diff(ahead, axis=0), axis=1) > _STRAIGHT
    return turns


def _pieces(nodes: F64, outward: F64, number: I64) -> tuple[F64, F64]:
    """Return feet (K, 2, 3) and probes (K, 2), which lie just behind the middles of the pieces."""
    begins = np.flatnonzero(np.diff(number) == 0)
    begin, step = nodes[begins], nodes[begins + 1] - nodes[begins]
    wanted = np.maximum(np.ceil(np.hypot(step[:, 0], step[:, 1]) / _LONGEST_M), np.ceil(abs(step[:, 2]) / _MOST_RISE_M))
    count = np.minimum(wanted, MOST_WALL_PIECES).astype(np.int64)
    of = np.repeat(np.arange(len(begins)), count)
    nth = np.arange(len(of)) - np.repeat(np.cumsum(count) - count, count)
    shares = [np.where(k == count[of], 1.0, k * (1.0 / count[of])) for k in (nth, nth + 1)]
    low, high = (begin[of] + share[:, None] * step[of] for share in shares)
    return np.stack([low, high], axis=1), 0.5 * (low + high)[:, :2] + _PROBE_M * outward[begins][of]
