"""Paint across the lanes: crosswalks, stop lines, yield lines, arrows; islands of roundabouts.

Arrows stand before junctions with lights where the lanes of an approach lead in different directions.
"""

import math
from collections import defaultdict
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.background import checkpoint
from linden.maps.facts import MapFacts
from linden.maps.ground import Ground
from linden.maps.opendrive.evaluate.tables import Tables, tables_of
from linden.maps.opendrive.limits import MOST_BARS, MOST_PAINTED
from linden.maps.opendrive.model import OpenDrive
from linden.maps.opendrive.outlines import outline_of
from linden.maps.opendrive.roadside import RoadObject
from linden.protocol.values.enums import LaneType, SemanticTag
from linden.scenery.mesh import Material, Mesh, join
from linden.scenery.patches import PatchLook, polygons
from linden.scenery.streets.markings import PAINT_HEIGHT_M, WHITE
from linden.scenery.streets.road import GRASS, KERB_STONE, is_paved

F64 = NDArray[np.float64]

_BAR_M, _BAR_GAP_M = 0.6, 0.6  # of a crosswalk: 12 to 24 inches each, MUTCD 2009, section 3B.18
_TOOTH_M, _TOOTH_GAP_M = 0.45, 0.2  # of a yield line, section 3B.16
_ISLAND_M = 0.15  # how high islands rise above the road
_PAINT = PatchLook(Material.PAINT, SemanticTag.ROAD_LINES, WHITE)
_UP = (0.0, 0.0, 1.0)
_HIGH_M = 1e6


def across_lanes(opendrive: OpenDrive, facts: MapFacts) -> Mesh:
    """Return everything painted that the map gives as an object with an outline, and its islands."""
    tables, canvas = tables_of(opendrive), Canvas(facts)
    found: list[Mesh] = []
    for index, road in enumerate(tables.roads):
        for thing in road.objects:
            outline = outline_of(tables, index, thing)
            if len(outline) < 3:
                continue
            kind = thing.type.lower()
            if len(found) > MOST_PAINTED:
                return join(found)
            checkpoint()
            if thing.is_crosswalk:
                found += [canvas.flat(piece) for piece in _bars(outline)]
            elif kind == "roadmark" and "yield" in thing.name.lower():
                found += [canvas.flat(piece) for piece in _teeth(outline, _towards(tables, index, thing))]
            elif kind == "roadmark":
                found.append(canvas.flat(outline))
            elif kind == "trafficisland":
                found.append(_island(outline, facts.ground))
    return join(found)


def _towards(tables: Tables, road_index: int, thing: RoadObject) -> F64:
    """Return the direction of travel, (2,) in CARLA's frame, of the traffic that a yield line concerns."""
    road = tables.roads[road_index]
    s_m = np.clip([thing.s_m], 0.0, tables.road_length_m[road_index])
    heading = float(tables.curves.pose(np.array([road_index]), s_m).heading_rad[0])
    forward = 1.0 if (thing.t_m <= 0.0) == road.is_right_hand else -1.0
    return forward * np.array([math.cos(heading), -math.sin(heading)])


def _several(fit: float) -> int:
    """Return how many pieces of paint there are where so many fit: at least one."""
    return max(1, min(MOST_BARS, math.floor(fit)))


def _bars(outline: F64) -> list[F64]:
    """Return the bars of a crosswalk: they lie the way the cars go, one beside the other along its longest side."""
    sides = np.roll(outline, -1, axis=0) - outline
    lengths = np.hypot(*sides.T)
    longest = int(np.argmax(lengths))
    along = sides[longest] / lengths[longest]
    at = (outline - outline[longest]) @ along
    count = _several((at.max() - at.min() + _BAR_GAP_M) / (_BAR_M + _BAR_GAP_M))
    rest = at.max() - at.min() - count * _BAR_M - (count - 1) * _BAR_GAP_M
    first = at.min() + 0.5 * rest
    begins = [first + nth * (_BAR_M + _BAR_GAP_M) for nth in range(count)]
    cut = (
        _clipped(
            _clipped(outline, outline[longest] + b * along, along), outline[longest] + (b + _BAR_M) * along, -along
        )
        for b in begins
    )
    return [piece for piece in cut if len(piece) >= 3]


def _teeth(outline: F64, coming: F64) -> list[F64]:
    """Return the triangles of a yield line, which point at the approaching traffic."""
    sides = np.roll(outline, -1, axis=0) - outline
    lengths = np.hypot(*sides.T)
    longest = int(np.argmax(lengths))
    along = sides[longest] / lengths[longest]
    across = np.array([-along[1], along[0]])
    across = across if across @ coming > 0.0 else -across
    at, depth = (outline - outline[longest]) @ along, (outline - outline[longest]) @ across
    count = _several((at.max() - at.min() + _TOOTH_GAP_M) / (_TOOTH_M + _TOOTH_GAP_M))
    pitch = (at.max() - at.min()) / count
    teeth = []
    for nth in range(count):
        middle = outline[longest] + (at.min() + (nth + 0.5) * pitch) * along
        base, tip = middle + depth.max() * across, middle + depth.min() * across
        teeth.append(np.stack([base - 0.5 * _TOOTH_M * along, base + 0.5 * _TOOTH_M * along, tip]))
    return teeth


def _clipped(polygon: F64, at: F64, inward: F64) -> F64:
    """Return the part of a convex polygon on one side of a line (Sutherland and Hodgman 1974)."""
    if len(polygon) == 0:
        return polygon
    side = (polygon - at) @ inward
    kept: list[F64] = []
    for k in range(len(polygon)):
        n = (k + 1) % len(polygon)
        if side[k] >= 0.0:
            kept.append(polygon[k])
        if (side[k] >= 0.0) != (side[n] >= 0.0):
            kept.append(polygon[k] + side[k] / (side[k] - side[n]) * (polygon[n] - polygon[k]))
    return np.array(kept).reshape(-1, 2)


class Canvas:
    """What paint lies on: lanes of asphalt."""

    def __init__(self, facts: MapFacts) -> None:
        self.ground = facts.ground
        self._paved = is_paved(facts.lanes["type_bits"])[facts.lane_of_triangle]

    def flat(self, outline: F64) -> Mesh:
        """Return a painted area; what of it reaches over a kerb lies below what is there, as if cut off by it."""
        height, triangle = self.ground.surfaces_under(np.column_stack([outline, np.full(len(outline), _HIGH_M)]))
        paved = (triangle >= 0) & self._paved[triangle]
        if not paved.any():
            return join([])
        known = np.flatnonzero(paved)
        for row in np.flatnonzero(~paved):
            nearest = known[np.hypot(*(outline[known] - outline[row]).T).argmin()]
            slope = self.ground.planes[triangle[nearest], 7:9]
            height[row] = height[nearest] + slope @ (outline[row] - outline[nearest])
        return polygons(np.column_stack([outline, height + PAINT_HEIGHT_M])[None], _PAINT, _UP)


def _island(outline: F64, ground: Ground) -> Mesh:
    """Return a kerb round an island and the grass within."""
    height, _ = ground.surfaces_under(np.column_stack([outline, np.full(len(outline), _HIGH_M)]))
    foot = np.column_stack([outline, height])
    middle = foot.mean(axis=0)
    raised = np.array([0.0, 0.0, _ISLAND_M])
    top = foot + raised
    inner = top + 0.08 * (middle + raised - top)
    stone = PatchLook(Material.CONCRETE, SemanticTag.SIDEWALKS, KERB_STONE)
    following = np.roll(np.arange(len(foot)), -1)
    walls = np.stack([foot, foot[following], top[following], top], axis=1)
    rim = np.stack([top, top[following], inner[following], inner], axis=1)
    return join(
        [
            polygons(walls, stone, foot - middle),
            polygons(rim, stone, _UP),
            polygons(inner[None], PatchLook(Material.GRASS, SemanticTag.TERRAIN, GRASS), _UP),
        ]
    )


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
        section = road.section_index_at(s_m)
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
    """Return the turn of a connecting road that is entered at its start, or ``backwards`` at its end."""
    ends = tables.curves.pose(np.array([road, road]), np.array([0.0, tables.road_length_m[road]]))
    turn = math.remainder(float(ends.heading_rad[1] - ends.heading_rad[0]), math.tau)
    turn = -turn if backwards else turn
    return "left" if turn > _TURN_RAD else "right" if turn < -_TURN_RAD else "straight"


def _laid(shape: F64, x_m: float, y_m: float, heading_rad: float) -> F64:
    """Return a shape (K, 2), ahead and left, on the map in CARLA's frame."""
    cosine, sine = math.cos(heading_rad), math.sin(heading_rad)
    ahead, left = shape.T
    return np.column_stack([x_m + cosine * ahead - sine * left, -(y_m + sine * ahead + cosine * left)])
