"""Comparison of a Lanelet2 map with its OpenDRIVE map: counts, lengths, lane connections and geometric errors."""

from collections import Counter
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from linden.maps.opendrive.evaluate.pieces import F64
from linden.maps.opendrive.evaluate.strips import edges_of, strips_of
from linden.maps.opendrive.evaluate.tables import Tables, tables_of
from linden.maps.opendrive.links import lane_links
from linden.maps.opendrive.model import OpenDrive
from linden.maps.opendrive.roadside import STOP_SIGN_TYPE, YIELD_SIGN_TYPE
from linden.protocol.values.enums import LaneType
from linden_maps.lanelet2.bounds import edges_of_stretch, evaluate
from linden_maps.lanelet2.convert import ConvertedMap, convert
from linden_maps.lanelet2.model import LaneletMap, bounds_of
from linden_maps.lanelet2.second_reader import Routes
from linden_maps.lanelet2.stretches import BICYCLE, DRIVABLE, ROAD, SHOULDER, WALKWAY, intersections, network_of
from linden_maps.polylines import lengths, resampled

_CELL_M = 0.5
_SPACING_M = 0.25


class Row(NamedTuple):
    """One class of things: how much the OpenDRIVE map has, and how much the Lanelet2 map."""

    name: str
    unit: str
    before: float
    after: float

    @property
    def is_lost(self) -> bool:
        """Whether the Lanelet2 map has less; lengths within one in a thousand are the same."""
        return self.after < self.before * (0.999 if self.unit == "km" else 1.0)


class Reach(NamedTuple):
    """Pairs of driving lanes that lead into each other: in both maps, only in OpenDRIVE, only in Lanelet2."""

    both: int
    missing: tuple[str, ...]
    added: tuple[str, ...]


def compare(lanelet_map: LaneletMap, opendrive: OpenDrive) -> list[Row]:
    """Return what both maps have, class by class."""
    tables = tables_of(opendrive)
    signals = Counter(
        "light" if signal.is_light else {STOP_SIGN_TYPE: "stop", YIELD_SIGN_TYPE: "yield"}.get(signal.type, "other")
        for _, signal in opendrive.signals()
    )
    ways = Counter((way.tags.get("type"), way.tags.get("subtype")) for way in lanelet_map.ways.values())
    kinds = Counter(way.tags.get("type") for way in lanelet_map.ways.values())
    walks = sum(thing.is_crosswalk for road in opendrive.roads for thing in road.objects)
    return [
        *_length_rows(tables, lanelet_map),
        Row("traffic lights", "", signals["light"], kinds["traffic_light"]),
        Row("stop signs", "", signals["stop"], ways["traffic_sign", "stop_sign"]),
        Row("yield signs", "", signals["yield"], ways["traffic_sign", "yield_sign"]),
        Row("crosswalks", "", walks, sum(1 for _ in lanelet_map.lanelets("crosswalk"))),
        Row("intersections", "", len(intersections(network_of(opendrive))), kinds["intersection_area"]),
    ]


def _length_rows(tables: Tables, lanelet_map: LaneletMap) -> list[Row]:
    middles = {
        subtype: [_middle(lanelet_map, number) for number, _ in lanelet_map.lanelets(subtype)]
        for subtype in (ROAD, SHOULDER, WALKWAY, BICYCLE)
    }
    rows = []
    for name, types, subtype in (
        ("driving lanes", DRIVABLE, ROAD),
        ("shoulders outside junctions", LaneType.SHOULDER | LaneType.STOP | LaneType.PARKING, SHOULDER),
        ("sidewalks", LaneType.SIDEWALK, WALKWAY),
        ("bicycle lanes", LaneType.BIKING, BICYCLE),
    ):
        if subtype == WALKWAY and not middles[subtype]:
            continue  # a file for Autoware has none
        before, covered = _covered_km(tables, types, middles[subtype])
        rows.append(Row(name, "km", before, covered))
    return rows


def _middle(lanelet_map: LaneletMap, number: int) -> F64:
    """Return points along a lanelet's middle."""
    sides = [
        np.array([lanelet_map.nodes[node][:3] for node in side])
        for side in bounds_of(lanelet_map, lanelet_map.relations[number])
    ]
    count = max(2, int(max(lengths(side)[-1] for side in sides) / _SPACING_M) + 2)
    middle: F64 = (resampled(sides[0], count) + resampled(sides[1], count)) / 2.0
    return middle


def _covered_km(tables: Tables, types: LaneType, middles: list[F64]) -> tuple[float, float]:
    """Return the length of the lanes of some types, and how much of it has a lanelet's middle within a metre."""
    rows = np.flatnonzero(tables.lanes["type_bits"] & int(types))
    if types & LaneType.SHOULDER:
        rows = rows[[not tables.roads[index].is_in_junction for index in tables.lanes["road"][rows]]]
    if not len(rows):
        return 0.0, 0.0
    strips = strips_of(tables, rows)
    inner, outer = (edge[:, :2] for edge in edges_of(tables, strips))  # not lane_centres: it looks beyond a jump
    points = (inner + outer) / 2.0
    chords = np.flatnonzero(strips.continues & (np.linalg.norm(outer - inner, axis=1) > 0.0))
    start, step = points[chords], points[chords + 1] - points[chords]
    length = np.linalg.norm(step, axis=1)
    count = np.maximum(np.ceil(length / _SPACING_M), 1.0).astype(np.int64)
    nth = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    share = (nth + 0.5) / np.repeat(count, count)
    places = np.repeat(start, count, axis=0) + np.repeat(step, count, axis=0) * share[:, None]
    weight = np.repeat(length / count, count)
    if not middles:
        return float(weight.sum()) / 1000.0, 0.0
    cells = np.unique(_key(np.floor(np.concatenate(middles)[:, :2] / _CELL_M)))
    own = np.floor(places / _CELL_M)
    hit = np.zeros(len(own), dtype=np.bool_)
    for east in (-1, 0, 1):
        for north in (-1, 0, 1):
            hit |= np.isin(_key(own + np.array([east, north])), cells)
    return float(weight.sum()) / 1000.0, float(weight[hit].sum()) / 1000.0


def _key(cells: F64) -> F64:
    key: F64 = cells[:, 0] * 2.0**26 + cells[:, 1]
    return key


def reach(opendrive: OpenDrive, routes: Routes, converted: ConvertedMap | None = None) -> Reach:
    """Compare which driving lanes lead into which: OpenDRIVE's links, and what Lanelet2's library found.

    Lanelets are known by their ids, which depend on the OpenDRIVE map alone.
    """
    converted = convert(opendrive) if converted is None else converted
    tables, links = tables_of(opendrive), lane_links(opendrive)
    entered: dict[int, int] = {}
    inner: set[tuple[int, int]] = set()
    left: dict[int, int] = {}
    for lanelet, stretch in zip(converted.lanelet_of, converted.network.stretches, strict=True):
        if stretch.subtype != ROAD or lanelet not in routes.passable:
            continue
        rows = [piece.row for piece in stretch.pieces]
        rows = rows if stretch.forward else rows[::-1]
        entered[lanelet], left[lanelet] = rows[0], rows[-1]
        inner.update(pairwise(rows))
    drivable = (tables.lanes["type_bits"] & int(DRIVABLE)) != 0
    wanted = {
        (row, after) for row in np.flatnonzero(drivable).tolist() for after in links.successors[row] if drivable[after]
    }
    found = inner | {(left[a], entered[b]) for a, b in routes.following if a in left and b in entered}
    found = {(a, b) for a, b in found if a != b}
    return Reach(
        len(wanted & found),
        tuple(_lane_pair(tables, pair) for pair in sorted(wanted - found)),
        tuple(_lane_pair(tables, pair) for pair in sorted(found - wanted)),
    )


def _lane_pair(tables: Tables, pair: tuple[int, int]) -> str:
    names = [
        f"road {tables.roads[lane['road']].id} lane {lane['lane_id']}" for lane in (tables.lanes[row] for row in pair)
    ]
    return " to ".join(names)


class Worst(NamedTuple):
    """How far the lanes' edges lie from their bounds at most, in m: in plan, and in height at the nearest place.

    ``shared_m`` is the worst of both where two ways through a junction share the mean of their edges as a bound.
    """

    plan_m: float
    height_m: float
    shared_m: float


def worst_error_m(opendrive: OpenDrive, converted: ConvertedMap) -> Worst:
    """Return the worst errors of a converted map."""
    tables = tables_of(opendrive)
    before = np.cumsum([0, *(len(road.sections) for road in tables.roads)])
    specs, ways, is_shared = [], [], []
    for lanelet, stretch in zip(converted.lanelet_of, converted.network.stretches, strict=True):
        relation = converted.lanelet_map.relations[lanelet]
        for side, edges in edges_of_stretch(before, stretch).items():
            role = "left" if side == stretch.left else "right"
            specs.append(edges)
            ways.append(relation.refs(role)[0])
            is_shared.append(side in converted.shared)
    plan_m = height_m = shared_m = 0.0
    for line, way, both in zip(evaluate(tables, specs), ways, is_shared, strict=True):
        away, rise = _from_polyline(line, converted.lanelet_map.line(way))
        if both:
            shared_m = max(shared_m, away, rise)
        else:
            plan_m, height_m = max(plan_m, away), max(height_m, rise)
    return Worst(plan_m, height_m, shared_m)


def _from_polyline(points: F64, line: F64) -> tuple[float, float]:
    start, chord = line[:-1], np.diff(line, axis=0)
    away = points[:, None, :2] - start[None, :, :2]
    size = np.maximum((chord[:, :2] ** 2).sum(axis=1), 1e-12)
    share = np.clip((away * chord[None, :, :2]).sum(axis=2) / size, 0.0, 1.0)
    gap = np.linalg.norm(away - share[..., None] * chord[None, :, :2], axis=2)
    best = np.argmin(gap, axis=1)
    row = np.arange(len(points))
    z_m = start[best, 2] + share[row, best] * chord[best, 2]
    return float(gap[row, best].max()), float(np.abs(points[:, 2] - z_m).max())
