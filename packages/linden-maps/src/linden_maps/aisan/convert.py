"""A Lanelet2 map as an Aisan vector map. OpenDRIVE goes the same way, so both give the same town."""

import math
from typing import NamedTuple

import numpy as np

from linden.errors import UserError
from linden.maps.opendrive.evaluate.pieces import F64
from linden_maps.aisan.draft import VectorMapDraft
from linden_maps.aisan.furniture import add_furniture
from linden_maps.aisan.lanes import Course, curvatures, headings, junction_flag
from linden_maps.aisan.tables import STRAIGHT_R, Tables
from linden_maps.lanelet2.model import LaneletMap

_LANE_TYPES = {"straight": 0, "left": 1, "right": 2}
_DEFAULT_KMH = 50
_KMH_PER_UNIT = {"km/h": 1.0, "kmh": 1.0, "mph": 1.609344, "m/s": 3.6, "mps": 3.6}


class Vectors(NamedTuple):
    """An Aisan vector map, and what a reader of it should know."""

    tables: Tables
    lost_links: int  # beyond the four that a row has room for
    without_limit: int


def convert(lanelet_map: LaneletMap) -> Vectors:
    """Return the Aisan vector map of a Lanelet2 map.

    Raises:
        UserError: it has no road lanelet, or its projection is of another kind.
    """
    draft = VectorMapDraft(lanelet_map)
    if not draft.courses:
        raise UserError("the map has no lanelet of the subtype road, so it makes no lane")
    areas = _way_areas(draft)
    junctions: dict[str, int] = {}
    without_limit = 0
    nodes: dict[tuple[int, int], int] = {}
    for nth, course in enumerate(draft.courses):
        tags = lanelet_map.relations[course.lanelet].tags
        area = tags.get("intersection_area", "")
        inside = bool(tags.get("turn_direction"))
        junction = junctions.setdefault(area or f"of {course.lanelet}", len(junctions) + 1) if inside else 0
        limit = _limit_kmh(tags.get("speed_limit", ""))
        without_limit += limit is None
        ids = _node_ids(draft, course, nodes)
        _add_rows(
            draft,
            nth,
            ids,
            _Facts(junction, _LANE_TYPES.get(tags.get("turn_direction", ""), 0), limit or _DEFAULT_KMH, areas[nth]),
        )
    add_furniture(draft)
    return Vectors(draft.tables, draft.graph.lost, without_limit)


class _Facts(NamedTuple):
    """What holds for all rows of a course."""

    junction: int
    lane_type: int
    limit_kmh: int
    way_area: int


def _limit_kmh(text: str) -> int | None:
    """Return a limit in whole km/h; Lanelet2 takes a number without a unit for km/h."""
    parts = text.split()
    unit = parts[1] if len(parts) > 1 else "km/h"
    try:
        value = float(parts[0]) * _KMH_PER_UNIT.get(unit, math.nan)
    except (IndexError, ValueError):
        return None
    return round(value) if math.isfinite(value) and value >= 1.0 else None


def _way_areas(draft: VectorMapDraft) -> list[int]:
    """Add the area of each road lanelet; return their ids in way area's file."""
    found = []
    for course in draft.courses:
        ring = [*course.bounds.left, *course.bounds.right[::-1]]
        points = [draft.points.of_node(draft.source, node) for node in dict.fromkeys(ring)]
        area = draft.tables.add("area", *draft.tables.chain(points, closed=True))
        found.append(draft.tables.add("wayarea", area))
    return found


def _node_ids(draft: VectorMapDraft, course: Course, shared: dict[tuple[int, int], int]) -> list[tuple[int, int]]:
    """Add the nodes along a course; return (node, point) of each place. Touching courses share their end nodes."""
    ends = ((course.bounds.left[0], course.bounds.right[0]), (course.bounds.left[-1], course.bounds.right[-1]))
    found = []
    for at, place in enumerate(course.middle):
        end = ends[0] if at == 0 else ends[1] if at == course.rows else None
        if end is not None and end in shared:
            node = shared[end]
            found.append((node, int(draft.tables.rows["node"][node - 1].split(",")[1])))
            continue
        point = draft.points.new(place)
        node = draft.tables.add("node", point)
        if end is not None:
            shared[end] = node
        found.append((node, point))
    return found


def _add_rows(draft: VectorMapDraft, nth: int, ids: list[tuple[int, int]], facts: _Facts) -> None:
    """Add the rows of lane.csv and dtlane.csv of a course."""
    course, graph = draft.courses[nth], draft.graph
    first, last = draft.first_row[nth], draft.first_row[nth] + course.rows - 1
    before = [_ends(draft, graph.predecessors[nth], last=True)] + [(row, 0, 0, 0) for row in range(first, last)]
    after = [(row, 0, 0, 0) for row in range(first + 1, last + 1)] + [_ends(draft, graph.successors[nth], last=False)]
    flags = [0] * course.rows
    for at in {0, course.rows - 1}:
        flags[at] = junction_flag(draft.courses, graph, nth, first=at == 0, last=at == course.rows - 1)
    lanes = (0, 0) if facts.junction else (graph.lane_count[nth], graph.number[nth])
    section = graph.section[nth]
    same = (
        f"{lanes[0]},{lanes[1]},{facts.lane_type},{facts.limit_kmh},{facts.limit_kmh},"
        f"{0 if facts.junction else section},{0 if graph.changes[nth] else 1},{facts.way_area}"
    )
    step = np.diff(course.middle, axis=0)
    spans = np.hypot(step[:, 0], step[:, 1])
    rows = range(first, last + 1)
    draft.tables.extend(
        "lane",
        (
            f"{row},{row},{b[0]},{a[0]},{start[0]},{end[0]},{flag},{b[1]},{b[2]},{b[3]},{a[1]},{a[2]},{a[3]},"
            f"{facts.junction},{span:.3f},{same}"
            for row, b, a, start, end, flag, span in zip(
                rows, before, after, ids[:-1], ids[1:], flags, spans.tolist(), strict=True
            )
        ),
    )
    _add_details(draft, course, rows, ids, step, spans)


def _add_details(
    draft: VectorMapDraft, course: Course, rows: range, ids: list[tuple[int, int]], step: F64, spans: F64
) -> None:
    """Add the rows of dtlane.csv of a course."""
    columns = (
        np.concatenate([[0.0], np.cumsum(spans)[:-1]]),
        headings(course),
        curvatures(course),
        100.0 * step[:, 2] / np.maximum(spans, 1e-6),
        course.cant_percent[:-1],
        course.left_m[:-1],
        course.right_m[:-1],
    )
    draft.tables.extend(
        "dtlane",
        (
            f"{row},{dist:.3f},{place[1]},{heading:.8f},0,{f'{1.0 / bend:.4f}' if bend else STRAIGHT_R},"
            f"{slope:.4f},{cant:.4f},{left:.4f},{right:.4f}"
            for row, place, (dist, heading, bend, slope, cant, left, right) in zip(
                rows, ids[:-1], zip(*(column.tolist() for column in columns), strict=True), strict=True
            )
        ),
    )


def _ends(draft: VectorMapDraft, others: tuple[int, ...], *, last: bool) -> tuple[int, int, int, int]:
    """Return the rows at the ends of other courses, filled up with 0 to four."""
    rows = [draft.first_row[n] + (draft.courses[n].rows - 1 if last else 0) for n in others]
    a, b, c, d = [*rows, 0, 0, 0, 0][:4]
    return a, b, c, d
