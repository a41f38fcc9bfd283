"""``cut_lots``: rectangular lots along the outer sidewalks of a map, clear of roads and of each other.

OpenDRIVE says nothing about what lies behind a pavement, so a lot is cut wherever behind one there is room for it.
Frame: CARLA's (x east, y south, z up).
"""

import math
from collections import defaultdict
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from linden.geometry import points_from_opendrive
from linden.maps.ground import Ground
from linden.maps.opendrive.evaluate.strips import edges_of, strips_of
from linden.maps.opendrive.evaluate.tables import Tables, tables_of
from linden.maps.opendrive.model import OpenDrive
from linden.maps.records import LOT_DEPTH_M, LOT_WIDTH_M, LOTS
from linden.protocol.values.enums import LaneType
from linden.structured import StructuredArray

F64 = NDArray[np.float64]

_SPACING_M = 1.0  # between the places along a pavement; LOT_WIDTH_M is counted in them
_SIDE_CLEARANCE = 3  # places before and after a lot that must be free too: a side street is no neighbour
_DEPTHS_M = (0.3, *map(float, range(1, LOT_DEPTH_M + 1)))  # where it is looked whether the land is free
_MOST_TURN_RAD = 0.2  # of the street along one lot: lots are rectangles
_TOLERANCE_M = 0.5  # by which neighbours may lie over one another where a street bends
_HIGH_M = 1e9  # above every road


def cut_lots(opendrive: OpenDrive, ground: Ground) -> StructuredArray:
    """Return the lots of a map, of LOTS, in the order of its roads; the first of two that overlap."""
    taken = _Taken()
    found = [
        (middle, yaw_rad, road_id)
        for road_id, edge_m, outward in _pavement_edges(tables_of(opendrive))
        for middle, yaw_rad in _along(edge_m, outward, _is_free(ground, edge_m, outward))
        if taken.claim(middle, yaw_rad)
    ]
    lots = np.zeros(len(found), LOTS)
    for row, lot in zip(lots, found, strict=True):
        row["front_m"], row["yaw_rad"], row["road_id"] = lot
    return lots


def _pavement_edges(tables: Tables) -> Iterator[tuple[int, F64, F64]]:
    """Yield road id, the outer edge of a pavement (N, 2) in steps of ``_SPACING_M`` and the unit normals away from it.

    Pavements in junctions are left out: what they bound is the corner of two streets.
    """
    rows = np.flatnonzero(_is_outer_pavement(tables))
    strips = strips_of(tables, rows)
    outer = points_from_opendrive(edges_of(tables, strips).outer)[:, :2]
    runs: dict[tuple[int, bool], list[F64]] = defaultdict(list)
    begins = np.flatnonzero(np.diff(strips.lane, prepend=-1))
    for points, lane in zip(np.split(outer, begins)[1:], strips.lane[begins], strict=True):
        runs[int(tables.lanes["road"][lane]), bool(tables.lanes["lane_id"][lane] > 0)].append(points)
    for (road, is_left), pieces in runs.items():
        line = np.concatenate(pieces)
        ahead = np.hypot(*np.diff(line, axis=0).T)
        along_m = np.concatenate([[0.0], np.cumsum(ahead)])
        at_m = np.arange(0.0, along_m[-1], _SPACING_M)
        edge_m = np.column_stack([np.interp(at_m, along_m, line[:, axis]) for axis in (0, 1)])
        if len(edge_m) > LOT_WIDTH_M:
            direction = np.gradient(edge_m, axis=0)
            direction /= np.maximum(np.hypot(*direction.T), 1e-9)[:, None]
            right = np.column_stack([-direction[:, 1], direction[:, 0]])  # y points south
            yield tables.roads[road].id, edge_m, -right if is_left else right


def _is_outer_pavement(tables: Tables) -> NDArray[np.bool_]:
    """Return for each lane whether it is a pavement beside which the road ends, outside of junctions."""
    lanes = tables.lanes
    outermost = np.ones(len(lanes), bool)
    outermost[lanes["inside"][lanes["inside"] >= 0]] = False
    open_road = np.array([not road.is_in_junction for road in tables.roads], bool)
    found: NDArray[np.bool_] = outermost & open_road[lanes["road"]] & (lanes["type_bits"] == LaneType.SIDEWALK)
    return found


def _is_free(ground: Ground, edge_m: F64, outward: F64) -> NDArray[np.bool_]:
    """Return for each place along an edge whether no road lies behind it for the depth of a lot."""
    depth_m = np.array(_DEPTHS_M)
    points = edge_m[:, None, :] + outward[:, None, :] * depth_m[None, :, None]
    high = np.full((len(edge_m), len(depth_m), 1), _HIGH_M)
    _, triangle = ground.surfaces_under(np.concatenate([points, high], axis=2))
    roads = (triangle >= 0).reshape(len(edge_m), len(depth_m)).sum(axis=1)
    free: NDArray[np.bool_] = roads == 0
    return free


def _along(edge_m: F64, outward: F64, is_free: NDArray[np.bool_]) -> Iterator[tuple[F64, float]]:
    """Yield front and yaw of lot after lot wherever there is room for one."""
    first = _SIDE_CLEARANCE
    while first + LOT_WIDTH_M + _SIDE_CLEARANCE < len(edge_m):
        last = first + LOT_WIDTH_M
        turn = float(outward[first] @ outward[last])
        if is_free[first - _SIDE_CLEARANCE : last + _SIDE_CLEARANCE + 1].all() and turn > math.cos(_MOST_TURN_RAD):
            into = outward[first] + outward[last]
            yield 0.5 * (edge_m[first] + edge_m[last]), math.atan2(into[1], into[0])
            first = last
        else:
            first += 1


class _Taken:
    """The lots that are there already, by cells so wide that neighbours lie in cells next to each other."""

    _CELL_M = math.hypot(LOT_WIDTH_M, LOT_DEPTH_M)

    def __init__(self) -> None:
        self._cells: dict[tuple[int, int], list[tuple[float, float, float]]] = defaultdict(list)

    def claim(self, front_m: NDArray[Any], yaw_rad: float) -> bool:
        """Take a lot unless it lies over one that is taken; return whether it was."""
        x = float(front_m[0]) + 0.5 * LOT_DEPTH_M * math.cos(yaw_rad)
        y = float(front_m[1]) + 0.5 * LOT_DEPTH_M * math.sin(yaw_rad)
        column, row = math.floor(x / self._CELL_M), math.floor(y / self._CELL_M)
        for i in (column - 1, column, column + 1):
            for j in (row - 1, row, row + 1):
                if any(_overlap((x, y, yaw_rad), other) for other in self._cells.get((i, j), ())):
                    return False
        self._cells[column, row].append((x, y, yaw_rad))
        return True


def _overlap(a: tuple[float, float, float], b: tuple[float, float, float]) -> bool:
    """Whether two lots (x, y of the middle, yaw) lie over one another: separating axes, Ericson, section 4.4.1."""
    dx, dy, turn = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    half_x, half_y = 0.5 * LOT_DEPTH_M, 0.5 * LOT_WIDTH_M
    cosine, sine = abs(math.cos(turn)), abs(math.sin(turn))
    reach_x, reach_y = half_x * (1.0 + cosine) + half_y * sine, half_y * (1.0 + cosine) + half_x * sine
    for yaw in (a[2], b[2]):
        c, s = math.cos(yaw), math.sin(yaw)
        if abs(dx * c + dy * s) > reach_x - _TOLERANCE_M or abs(dy * c - dx * s) > reach_y - _TOLERANCE_M:
            return False
    return True
