"""OpenDRIVE to Lanelet2, format 1 of autoware_lanelet2_extension."""

from collections import Counter, defaultdict
from typing import NamedTuple

import numpy as np

from linden.errors import UserError
from linden.maps.opendrive.evaluate.pieces import F64
from linden.maps.opendrive.evaluate.tables import Tables, tables_of
from linden.maps.opendrive.model import OpenDrive
from linden_maps.lanelet2 import bounds as sides_of
from linden_maps.lanelet2.areas import ring_of
from linden_maps.lanelet2.bus_stops import KerbStop, add_bus_stops
from linden_maps.lanelet2.controls import add_controls
from linden_maps.lanelet2.crosswalks import crossed, crosswalks_of
from linden_maps.lanelet2.draft import LaneletDraft
from linden_maps.lanelet2.kerbs import loose_kerbs
from linden_maps.lanelet2.markings import KERB, tags_of_sides
from linden_maps.lanelet2.model import DIGITS, Bounds, LaneletMap, LaneletPoint, LaneletWay, Member, Relation
from linden_maps.lanelet2.movements import Movement, movements_of
from linden_maps.lanelet2.roundabouts import FORMAT_VERSION, add_roundabouts
from linden_maps.lanelet2.stretches import (
    ROAD,
    SHOULDER,
    WALKWAY,
    LaneletNetwork,
    Side,
    Stretch,
    intersections,
    network_of,
)

UNKNOWN_SPEED_KMH = 50.0
"""Where the map gives a lane no limit: the usual one in towns. The report counts these lanelets."""
_KMH_PER_MPS = 3.6


class ConvertedMap(NamedTuple):
    """A Lanelet2 map, and what a reader of it should know."""

    lanelet_map: LaneletMap
    network: LaneletNetwork
    lanelet_of: tuple[int, ...]  # id of the lanelet of each stretch of the network
    lost_links: int
    largest_gap_m: float
    without_limit: int
    signals_without_lane: int
    lost_stops: tuple[KerbStop, ...] = ()
    shared: frozenset[Side] = frozenset()  # sides of two ways through a junction that are one way of the map


class Wanted(NamedTuple):
    """What a user can ask for.

    ``pairwise_priority``: every priority between two ways, not only what Autoware's requirements count as complete.
    ``roundabouts``: the elements of format 2. ``stops``: bus stops.
    """

    pairwise_priority: bool = False
    roundabouts: bool = False
    stops: tuple[KerbStop, ...] = ()


PLAIN = Wanted()


def convert(opendrive: OpenDrive, wanted: Wanted = PLAIN) -> ConvertedMap:
    """Return the Lanelet2 map of an OpenDRIVE map.

    Raises:
        UserError: the map has no lane that makes a lanelet.
    """
    tables = tables_of(opendrive)
    network = network_of(opendrive)
    if not any(stretch.subtype == ROAD for stretch in network.stretches):
        raise UserError("the map has no driving lane at least 0.3 m wide, so it makes no lanelet")
    draft = LaneletDraft(tables, network)
    kerbs = loose_kerbs(tables, network)
    laid = sides_of.lay(tables, network, kerbs, draft.target, draft.ids)
    draft.way_of, draft.nodes_of = laid.way_of, laid.nodes_of
    ways = draft.target.ways
    for side, tags in tags_of_sides(tables, network).items():
        way = laid.way_of[side]
        if not ways[way].tags or ways[way].tags["type"] == "virtual":  # a boundary of two ways may be a kerb for one
            ways[way] = ways[way]._replace(tags=tags)
    for side in kerbs:
        ways[laid.way_of[side]] = ways[laid.way_of[side]]._replace(tags=KERB)
    without_limit = _add_lanelets(draft)
    movements = movements_of(tables, network)
    _add_junctions(opendrive, draft, movements, kerbs)
    unheard = add_controls(opendrive, draft, movements, pairwise=wanted.pairwise_priority)
    _add_crosswalks(draft)
    if wanted.roundabouts:
        add_roundabouts(opendrive, draft, movements)
        draft.target.format_version = FORMAT_VERSION
    lost_stops = add_bus_stops(draft, wanted.stops)
    _finish(draft)
    draft.target.geo_reference, draft.target.name = opendrive.geo_reference, opendrive.name
    return ConvertedMap(
        draft.target,
        network,
        tuple(draft.lanelet_of),
        len(laid.lost_links),
        laid.largest_gap_m,
        without_limit,
        unheard,
        lost_stops,
        laid.shared,
    )


def _add_lanelets(draft: LaneletDraft) -> int:
    """Give every stretch an id, its tags and its sides; return how many road lanelets the map gives no limit."""
    unlimited = 0
    limits = _limits_kmh(draft.tables, draft.network)
    for stretch, limit in zip(draft.network.stretches, limits, strict=True):
        road = draft.tables.roads[stretch.road]
        pieces = [f"{piece.section},{piece.lane_id},{piece.start_m:.3f}" for piece in stretch.pieces]
        lanelet = draft.ids.new("lanelet", road.id, *pieces)
        tags = {"type": "lanelet", "subtype": stretch.subtype, "location": "urban"}
        if stretch.subtype == WALKWAY:
            tags |= {"one_way": "no", "participant:pedestrian": "yes"}
        elif stretch.subtype == SHOULDER:
            tags["one_way"] = "yes"  # no participant: with one, Lanelet2 would lead traffic over it
        elif stretch.subtype == ROAD:
            unlimited += not np.isfinite(limit)
            speed = limit if np.isfinite(limit) else UNKNOWN_SPEED_KMH
            tags |= {"one_way": "yes", "participant:vehicle": "yes", "speed_limit": f"{round(speed, 2):g}"}
        else:
            tags |= {"one_way": "yes", "participant:bicycle": "yes"}
        if road.name and not road.is_in_junction:
            tags["road_name"] = road.name
        draft.tags[lanelet] = tags
        draft.lanelet_of.append(lanelet)
        draft.bounds[lanelet] = Bounds(*(_nodes_along(draft, stretch, side) for side in (stretch.left, stretch.right)))
    return unlimited


def _nodes_along(draft: LaneletDraft, stretch: Stretch, side: Side) -> tuple[int, ...]:
    """Return a side's nodes in the direction of travel."""
    nodes = draft.nodes_of[side]
    return nodes if stretch.forward else nodes[::-1]


def _limits_kmh(tables: Tables, network: LaneletNetwork) -> list[float]:
    """Return the speed limit of each stretch at its middle, nan where the map gives none."""
    row = np.array([stretch.pieces[0].row for stretch in network.stretches])
    middle = np.array([(s.pieces[0].start_m + s.pieces[0].end_m) / 2.0 for s in network.stretches])
    limits: list[float] = (tables.speeds.value(row, middle) * _KMH_PER_MPS).tolist()
    return [limit if limit > 0.0 else float("nan") for limit in limits]


def _add_junctions(
    opendrive: OpenDrive,
    draft: LaneletDraft,
    movements: dict[int, list[Movement]],
    kerbs: dict[Side, tuple[sides_of.LaneEdge, ...]],
) -> None:
    """Tag the ways through each junction with their turn, and add its area."""
    corner: dict[int, list[tuple[int, ...]]] = defaultdict(list)
    for side in [*kerbs, *(s for stretch in draft.network.stretches for s in (stretch.left, stretch.right))]:
        way = draft.target.ways[draft.way_of[side]]
        road = draft.tables.roads[side.road]
        if road.is_in_junction and way.tags.get("type") == "road_border":
            corner[road.junction_id].append(way.nodes)
    leads_out = {m.stretch: draft.network.successors[m.stretch] for found in movements.values() for m in found}
    met = intersections(draft.network)
    for junction, found in movements.items():
        if junction not in met:
            continue  # a turning circle, or a street that parts
        entries = dict.fromkeys(n for m in found for n in sorted(m.origins) if _is_outside(draft, n, junction))
        exits = dict.fromkeys(n for m in found for n in leads_out[m.stretch] if _is_outside(draft, n, junction))
        inside = dict.fromkeys(movement.stretch for movement in found)
        ring = ring_of(
            draft.target, _sides(draft, entries), _sides(draft, exits), _sides(draft, inside), corner[junction]
        )
        area = draft.ids.small("area", "junction", junction)
        if ring:
            tags = {"type": "intersection_area", "area": "yes"}
            name = opendrive.junction_by_id[junction].name if junction in opendrive.junction_by_id else ""
            draft.target.ways[area] = LaneletWay(ring, {**tags, "name": name} if name else tags)
        for movement in found:
            tags = draft.tags[draft.lanelet_of[movement.stretch]]
            tags["turn_direction"] = movement.direction
            if ring:
                tags["intersection_area"] = str(area)


def _is_outside(draft: LaneletDraft, number: int, junction: int) -> bool:
    return draft.network.stretches[number].junction_id != junction


def _sides(draft: LaneletDraft, numbers: dict[int, None]) -> list[Bounds]:
    return [draft.bounds[draft.lanelet_of[number]] for number in numbers]


def _add_crosswalks(draft: LaneletDraft) -> None:
    """Add the lanelet, polygon and regulatory elements of every crosswalk: one element for each stop line before it."""
    walks = crosswalks_of(draft.tables)
    roads = {
        lanelet: draft.bounds[lanelet]
        for lanelet, stretch in zip(draft.lanelet_of, draft.network.stretches, strict=True)
        if stretch.subtype == ROAD
    }
    lines = _lines_of_lanelets(draft)
    for walk, under in zip(walks, crossed(draft.target, roads, walks), strict=True):
        outline = draft.add_line(
            walk.outline, {"type": "crosswalk_polygon", "area": "yes"}, "crosswalk", walk.key, "outline"
        )
        left, right = (
            draft.add_line(side, {"type": "pedestrian_marking"}, "crosswalk", walk.key, name)
            for side, name in ((walk.left, "left"), (walk.right, "right"))
        )
        lanelet = draft.ids.new("lanelet", "crosswalk", walk.key)
        draft.tags[lanelet] = {
            "type": "lanelet",
            "subtype": "crosswalk",
            "location": "urban",
            "one_way": "no",
            "participant:pedestrian": "yes",
        }
        draft.bounds[lanelet] = Bounds(draft.target.ways[left].nodes, draft.target.ways[right].nodes)
        draft.target.relations[lanelet] = Relation((Member("way", left, "left"), Member("way", right, "right")), {})
        by_line: dict[int, list[int]] = defaultdict(list)
        for road in under:
            by_line[_line_before(draft, lines.get(road, []), walk.outline)].append(road)
        for line, lanelets in (by_line or {0: []}).items():
            members = [Member("relation", lanelet, "refers"), Member("way", outline, "crosswalk_polygon")]
            members += [Member("way", line, "ref_line")] if line else []
            element = draft.add_element("crosswalk", members, lanelets, walk.key, line)
            draft.elements[lanelet].append(element)


_LINE_REACH_M = 8.0


def _lines_of_lanelets(draft: LaneletDraft) -> dict[int, list[int]]:
    """Return the stop lines that lanelets refer to already."""
    lines: dict[int, list[int]] = {}
    for lanelet, elements in draft.elements.items():
        for element in elements:
            relation = draft.target.relations[element]
            if relation.tags["subtype"] in {"traffic_light", "traffic_sign"}:
                lines.setdefault(lanelet, []).extend(relation.refs("ref_line"))
    approach = {
        draft.lanelet_of[before]: [
            line for after in draft.network.successors[before] for line in lines.get(draft.lanelet_of[after], [])
        ]
        for before in range(len(draft.lanelet_of))
    }
    return {
        lanelet: list(dict.fromkeys([*lines.get(lanelet, []), *approach.get(lanelet, [])]))
        for lanelet in draft.lanelet_of
    }


def _line_before(draft: LaneletDraft, lines: list[int], outline: F64) -> int:
    """Return the stop line near a crosswalk, 0 where there is none."""
    best = (_LINE_REACH_M, 0)
    for line in lines:
        middle = draft.target.line(line).mean(axis=0)
        best = min(best, (float(np.linalg.norm(outline - middle, axis=1).min()), line))
    return best[1]


def _finish(draft: LaneletDraft) -> None:
    """Write the relations of all lanelets, now that their elements are known; round places as files have them."""
    nodes = draft.target.nodes
    for node, place in nodes.items():
        nodes[node] = LaneletPoint(
            round(place[0], DIGITS), round(place[1], DIGITS), round(place[2], DIGITS), place.tags
        )
    elements = dict(draft.target.relations)
    draft.target.relations.clear()
    for lanelet, stretch in zip(draft.lanelet_of, draft.network.stretches, strict=True):
        members = (
            Member("way", draft.way_of[stretch.left], "left"),
            Member("way", draft.way_of[stretch.right], "right"),
            *(Member("relation", element, "regulatory_element") for element in draft.elements[lanelet]),
        )
        draft.target.relations[lanelet] = Relation(members, draft.tags[lanelet])
    for number, relation in elements.items():
        refers = tuple(Member("relation", element, "regulatory_element") for element in draft.elements.get(number, ()))
        tags = draft.tags.get(number, relation.tags)  # crosswalks have theirs there
        draft.target.relations[number] = Relation((*relation.members, *refers), tags)


def counts(lanelet_map: LaneletMap) -> Counter[str]:
    """Return how many there are of each kind of lanelet, regulatory element and way."""
    found: Counter[str] = Counter()
    for relation in lanelet_map.relations.values():
        found[f"{relation.tags['type']} {relation.tags.get('subtype', '')}"] += 1
    for way in lanelet_map.ways.values():
        found[f"way {way.tags.get('type', '')}"] += 1
    return found
