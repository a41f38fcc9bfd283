"""``add_furniture``: Aisan rows for markings, stop lines, road edges, stop signs, lights, poles, crosswalks, areas."""

import math
from collections import defaultdict
from itertools import pairwise

import numpy as np

from linden.maps.opendrive.evaluate.pieces import F64
from linden_maps.aisan.draft import VectorMapDraft
from linden_maps.lanelet2.model import Relation, bounds_of
from linden_maps.polylines import lengths, places_at

_PAINT_M = 0.12
_DASH_M, _GAP_M = 3.05, 9.14  # 10 and 30 ft: MUTCD 2009, section 3A.06
_KERB_HEIGHT_M, _KERB_WIDTH_M = 0.15, 0.15
_BAR_M = 0.6  # of a crosswalk, and as much between two: MUTCD 2009, section 3B.18
_POLE_M = 0.1
_STOP = 1  # roadsign's type, as decision_maker reads it
_BULBS = {"red": 1, "green": 2, "yellow": 3}
_UPRIGHT_DEG, _LEVEL_DEG = 0.0, 90.0  # Vang, from the zenith


def add_furniture(draft: VectorMapDraft) -> None:
    """Add all of it, and the points at the end."""
    users: dict[int, list[int]] = defaultdict(list)
    for number, lanelet in draft.source.lanelets("road"):
        for role in ("left", "right"):
            users[lanelet.refs(role)[0]].append(number)
    for number, way in draft.source.ways.items():
        kind = way.tags.get("type")
        if kind in {"line_thin", "line_thick"}:
            _add_paint(draft, number, users[number])
        elif kind in {"road_border", "curbstone"}:
            _add_edge(draft, number, users[number])
    _add_controls(draft)
    _add_junctions(draft)
    _add_crosswalks(draft)
    for _, walk in draft.source.lanelets("walkway"):
        bounds = bounds_of(draft.source, walk)
        ring = [draft.points.of_node(draft.source, n) for n in (*bounds.left, *bounds.right[::-1])]
        draft.tables.add("sidewalk", draft.tables.add("area", *draft.tables.chain(ring, closed=True)), 0)
    draft.points.write()


def _add_paint(draft: VectorMapDraft, number: int, users: list[int]) -> None:
    """Add whiteline rows along a way: one for each segment; broken lines alternate between paint and gap."""
    way = draft.source.ways[number]
    line = draft.source.line(number)
    dashed = way.tags.get("subtype", "").startswith("dashed")
    colour = "Y" if way.tags.get("color") == "yellow" else "W"
    pieces = _dashes(line) if dashed else [(line, 0)]
    for piece, kind in pieces:
        points = (
            [draft.points.new(place) for place in piece]
            if dashed
            else [draft.points.of_node(draft.source, node) for node in way.nodes]
        )
        first, last = draft.tables.chain(points, closed=False)
        for at, segment in enumerate(range(first, last + 1)):
            link = draft.nearest_row(users, (piece[at] + piece[at + 1]) / 2.0)
            draft.tables.add("whiteline", segment, _PAINT_M, colour, kind, link)


def _dashes(line: F64) -> list[tuple[F64, int]]:
    """Return the pieces of a broken line from its start on: paint (1) and gaps (2)."""
    length = lengths(line)
    cuts = [0.0]
    while cuts[-1] < length[-1]:
        cuts.append(min(cuts[-1] + (_DASH_M if len(cuts) % 2 else _GAP_M), float(length[-1])))
    pieces = []
    for nth, (start, end) in enumerate(pairwise(cuts)):
        inner = length[(length > start + 1e-6) & (length < end - 1e-6)]
        places = np.concatenate([[start], inner, [end]])
        piece = places_at(line, length, places)
        pieces.append((piece, 1 + nth % 2))
    return pieces


def _add_edge(draft: VectorMapDraft, number: int, users: list[int]) -> None:
    """Add roadedge rows along a way, and curb rows where it is a kerb."""
    way = draft.source.ways[number]
    is_kerb = way.tags.get("type") == "curbstone" or way.tags.get("subtype") == "curbstone"
    line = draft.source.line(number)
    points = [draft.points.of_node(draft.source, node) for node in way.nodes]
    first, last = draft.tables.chain(points, closed=False)
    on_left = any(draft.source.relations[user].refs("left") == [number] for user in users)
    for at, segment in enumerate(range(first, last + 1)):
        link = draft.nearest_row(users, (line[at] + line[at + 1]) / 2.0)
        draft.tables.add("roadedge", segment, link)
        if is_kerb:
            draft.tables.add("curb", segment, _KERB_HEIGHT_M, _KERB_WIDTH_M, int(on_left), link)


def _add_controls(draft: VectorMapDraft) -> None:
    """Add lights and stop signs with their poles, and a stopline row for each lane before them."""
    before: dict[int, list[int]] = defaultdict(list)
    for nth, after in enumerate(draft.graph.successors):
        for following in after:
            before[draft.courses[following].lanelet].append(draft.courses[nth].lanelet)
    referring: dict[int, list[int]] = defaultdict(list)
    for number, lanelet in draft.source.lanelets("road"):
        for ref in lanelet.refs("regulatory_element"):
            referring[ref].append(number)
    lines: dict[int, int] = {}
    for number, element in draft.source.elements("traffic_light", "traffic_sign"):
        is_light = element.tags["subtype"] == "traffic_light"
        inside = referring[number]
        lanes = dict.fromkeys(lane for n in inside for lane in before[n]) if is_light else dict.fromkeys(inside)
        _add_control(draft, element, list(lanes) or inside, lines, is_light=is_light)


def _add_control(
    draft: VectorMapDraft, element: Relation, lanes: list[int], lines: dict[int, int], *, is_light: bool
) -> None:
    heading = _heading_at_end(draft, lanes)
    signal = sign = 0
    for nth, way in enumerate(ref for ref in element.refs("refers") if ref in draft.source.ways):
        line = draft.source.line(way)
        link = draft.nearest_row(lanes, line.mean(axis=0))
        pole = _add_pole(draft, line.mean(axis=0), link)
        if is_light:
            bulbs = element.refs("light_bulbs")
            number = _add_bulbs(draft, line, bulbs[nth] if nth < len(bulbs) else 0, heading, pole, link)
            signal = signal or number
        elif draft.source.ways[way].tags.get("subtype") == "stop_sign":
            vector = draft.tables.add("vector", draft.points.new(line.mean(axis=0)), *_facing(heading))
            sign = draft.tables.add("roadsign", vector, pole, _STOP, link)
    for ref in element.refs("ref_line"):
        line = draft.source.line(ref)
        if ref not in lines:
            points = [draft.points.of_node(draft.source, node) for node in draft.source.ways[ref].nodes]
            lines[ref], _ = draft.tables.chain([points[0], points[-1]], closed=False)
        for lane in lanes:
            row = draft.nearest_row([lane], _crossing(draft, lane, line))
            draft.tables.add("stopline", lines[ref], signal, sign, row)


def _crossing(draft: VectorMapDraft, lane: int, line: F64) -> F64:
    """Return the place on a stop line in front of a lane."""
    middle = draft.courses[draft.course_of[lane]].middle
    away = np.linalg.norm(middle[:, None] - np.linspace(line[0], line[-1], 33)[None], axis=2)
    place: F64 = middle[int(np.argmin(away.min(axis=1)))]
    return place


def _heading_at_end(draft: VectorMapDraft, lanes: list[int]) -> float:
    """Return the direction of lanes at their end, degrees clockwise from north."""
    steps = [draft.courses[draft.course_of[lane]].middle[-2:] for lane in lanes]
    east, north = (sum(float(step[1, axis] - step[0, axis]) for step in steps) for axis in (0, 1))
    return math.degrees(math.atan2(east, north))


def _facing(heading_deg: float) -> tuple[str, str]:
    """Return Hang and Vang of what looks at traffic that comes in a direction."""
    return f"{(heading_deg + 180.0) % 360.0:.4f}", f"{_LEVEL_DEG:.4f}"


def _add_pole(draft: VectorMapDraft, top: F64, link: int) -> int:
    """Add a pole from the height of the nearest lane up to a sign or light, and its data."""
    ground = top[2] if not link else _height_of_row(draft, link)
    foot = np.array([top[0], top[1], ground])
    vector = draft.tables.add("vector", draft.points.new(foot), "0.0000", f"{_UPRIGHT_DEG:.4f}")
    pole = draft.tables.add("pole", vector, f"{max(0.0, float(top[2] - ground)):.3f}", _POLE_M)
    draft.tables.add("poledata", pole, link)
    return pole


def _height_of_row(draft: VectorMapDraft, row: int) -> float:
    nth = int(np.searchsorted(draft.first_row, row, side="right")) - 1
    return float(draft.courses[nth].middle[row - draft.first_row[nth], 2])


def _add_bulbs(draft: VectorMapDraft, line: F64, bulbs: int, heading_deg: float, pole: int, link: int) -> int:
    """Add one row for each bulb of a light; return the id of the first."""
    if bulbs in draft.source.ways:
        nodes = [draft.source.nodes[node] for node in draft.source.ways[bulbs].nodes]
        found = [(_BULBS.get(node.tags.get("color", ""), 9), np.array(node[:3])) for node in nodes]
    else:
        found = [(kind, line.mean(axis=0)) for kind in _BULBS.values()]
    first = draft.tables.next_id("signaldata")
    for kind, place in found:
        vector = draft.tables.add("vector", draft.points.new(place), *_facing(heading_deg))
        draft.tables.add("signaldata", vector, pole, kind, link)
    return first


def _add_junctions(draft: VectorMapDraft) -> None:
    inside: dict[str, list[int]] = defaultdict(list)
    for number, lanelet in draft.source.lanelets("road"):
        inside[lanelet.tags.get("intersection_area", "")].append(number)
    for number, way in draft.source.ways.items():
        if way.tags.get("type") == "intersection_area":
            points = [draft.points.of_node(draft.source, node) for node in way.nodes]
            area = draft.tables.add("area", *draft.tables.chain(points, closed=True))
            middle = draft.source.line(number).mean(axis=0)
            draft.tables.add("intersection", area, draft.nearest_row(inside[str(number)], middle))


def _add_crosswalks(draft: VectorMapDraft) -> None:
    """Add the outline of each crosswalk, and its bars."""
    crossed: dict[int, list[int]] = defaultdict(list)
    for number, lanelet in draft.source.lanelets("road"):
        for element in lanelet.refs("regulatory_element"):
            relation = draft.source.relations.get(element)
            if relation is not None and relation.tags.get("subtype") == "crosswalk":
                for ref in relation.refs("refers"):
                    crossed[ref].append(number)
    for number, walk in draft.source.lanelets("crosswalk"):
        bounds = bounds_of(draft.source, walk)
        ring = [draft.points.of_node(draft.source, n) for n in (*bounds.left, *bounds.right[::-1])]
        sides = [np.array([draft.source.nodes[n][:3] for n in side]) for side in bounds]
        link = draft.nearest_row(crossed[number], np.concatenate(sides).mean(axis=0))
        area = draft.tables.add("area", *draft.tables.chain(ring, closed=True))
        outline = draft.tables.add("crosswalk", area, 0, 0, link)
        for bar in _bars(*sides):
            points = [draft.points.new(place) for place in bar]
            area = draft.tables.add("area", *draft.tables.chain(points, closed=True))
            draft.tables.add("crosswalk", area, 1, outline, link)


def _bars(left: F64, right: F64) -> list[F64]:
    """Return the painted bars (4, 3) of a crosswalk, along the traffic."""
    length = float(np.linalg.norm(left[-1] - left[0]))
    count = max(1, int((length + _BAR_M) / (2.0 * _BAR_M)))
    margin = (length - (2 * count - 1) * _BAR_M) / 2.0
    found = []
    for nth in range(count):
        start = (margin + 2 * nth * _BAR_M) / max(length, 1e-6)
        end = start + _BAR_M / max(length, 1e-6)
        ends = [
            side[0] + share * (side[-1] - side[0])
            for side, share in ((left, start), (left, end), (right, end), (right, start))
        ]
        found.append(np.stack(ends))
    return found
