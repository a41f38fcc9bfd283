"""Arrows on the lanes before a junction with lights, where the lanes of an approach do not all lead the same ways."""

import math
from collections import defaultdict
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.meshes.mesh import Mesh, join
from linden.meshes.painted import Canvas
from linden.opendrive.evaluate.tables import Tables, tables_of
from linden.opendrive.model import OpenDrive
from linden.values.enums import LaneType
from linden.world.map_facts import MapFacts

F64 = NDArray[np.float64]

_BEFORE_M = 16.0  # the junction; stop lines lie about 5 m before it
_SHORTEST_ROAD_M = 30.0
_TURN_RAD = math.radians(35.0)

_SHAFT = [(-1.45, 0.09), (-1.45, -0.09), (0.5, -0.09), (0.5, 0.09)]
_HEAD = [(0.5, 0.33), (0.5, -0.33), (1.45, 0.0)]
_LOW_SHAFT = [(-1.45, 0.09), (-1.45, -0.09), (-0.2, -0.09), (-0.2, 0.09)]
_BEND = [(-0.38, 0.09), (-0.38, 0.5), (-0.2, 0.5), (-0.2, 0.09)]
_SIDE_HEAD = [(-0.62, 0.5), (0.04, 0.5), (-0.29, 1.05)]
_SHAPES = {
    "straight": (_SHAFT, _HEAD),
    "left": (_LOW_SHAFT, _BEND, _SIDE_HEAD),
    "right": tuple([(u, -v) for u, v in shape] for shape in (_LOW_SHAFT, _BEND, _SIDE_HEAD)),
}
"""Polygons of each way, ahead and to the left in m: slender forms of figure 3B-24 of the MUTCD 2009."""


class _Approach(NamedTuple):
    """The lanes that enter a junction from one road, by the end they enter it at."""

    road: int  # index
    forwards: bool  # in the direction of s


def arrows(opendrive: OpenDrive, facts: MapFacts) -> Mesh:
    """Return all arrows of a map."""
    tables, canvas = tables_of(opendrive), Canvas(facts)
    return join([canvas.flat(piece) for piece in _pieces(opendrive, tables)])


def _pieces(opendrive: OpenDrive, tables: Tables) -> Iterator[F64]:
    for approach, ways in _ways(opendrive, tables).items():
        road = tables.roads[approach.road]
        s_m = road.length_m - _BEFORE_M if approach.forwards else _BEFORE_M
        section = road.sections.index(road.section_at(s_m))
        rows = {lane_id: tables.lane_row.get((approach.road, section, lane_id), -1) for lane_id in ways}
        driven = {row: ways[lane_id] for lane_id, row in rows.items() if row >= 0 and _is_driven(tables, row)}
        if road.length_m < _SHORTEST_ROAD_M or len({frozenset(way) for way in driven.values()}) < 2:
            continue
        for row, way in driven.items():
            place = tables.lane_centres(np.array([row]), np.array([s_m]))
            heading = float(place.heading_rad[0]) + (0.0 if approach.forwards else math.pi)
            for name in sorted(way):
                for shape in _SHAPES[name]:
                    yield _laid(np.array(shape), float(place.x_m[0]), float(place.y_m[0]), heading)


def _is_driven(tables: Tables, row: int) -> bool:
    return bool(tables.lanes["type_bits"][row] == LaneType.DRIVING)


def _ways(opendrive: OpenDrive, tables: Tables) -> dict[_Approach, dict[int, set[str]]]:
    """Return where each lane of each approach may go, by lane id."""
    number = {road.id: index for index, road in enumerate(tables.roads)}
    found: dict[_Approach, dict[int, set[str]]] = defaultdict(lambda: defaultdict(set))
    for junction in opendrive.junctions:
        for connection in junction.connections if junction.controllers else ():
            if connection.incoming_road not in number or connection.connecting_road not in number:
                continue
            index = number[connection.incoming_road]
            way = _turn(tables, number[connection.connecting_road], backwards=connection.contact == "end")
            for come, _ in connection.lane_links:
                forwards = (come < 0) == tables.roads[index].is_right_hand
                found[_Approach(index, forwards)][come].add(way)
    return found


def _turn(tables: Tables, road: int, *, backwards: bool) -> str:
    """Return which way a connecting road leads whoever enters it at its start, or ``backwards`` at its end."""
    ends = tables.curves.pose(np.array([road, road]), np.array([0.0, tables.road_length_m[road]]))
    turn = math.remainder(float(ends.heading_rad[1] - ends.heading_rad[0]), math.tau)
    turn = -turn if backwards else turn
    return "left" if turn > _TURN_RAD else "right" if turn < -_TURN_RAD else "straight"


def _laid(shape: F64, x_m: float, y_m: float, heading_rad: float) -> F64:
    """Return a shape (K, 2), ahead and left, on the map in CARLA's frame."""
    cosine, sine = math.cos(heading_rad), math.sin(heading_rad)
    ahead, left = shape.T
    return np.column_stack([x_m + cosine * ahead - sine * left, -(y_m + sine * ahead + cosine * left)])
