"""The part of a Lanelet2 map along a route: the work of Autoware.AI's lane_rule grows with the square of the map."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import cast

import networkx as nx
import numpy as np
import shapely
from lxml import etree

from linden.errors import UserError
from linden.maps.opendrive.evaluate.pieces import F64
from linden_maps.aisan.lanes import Course, courses_of, graph_of
from linden_maps.lanelet2.model import LaneletMap, Relation
from linden_maps.polylines import lengths

_ON_LANE_M = 2.0
"""A position of a route lies on each lane with its middle this near; across a junction there are several."""
_FAR_M = 30.0
"""A position with no lane within this distance is not on this map."""
_SAME_M = 0.2
"""A lane belongs to the way when its middle lies this near to it throughout."""


def read_positions(path: Path) -> F64:
    """Return x and y in m (N, 2) of the positions of a file's first route, in the map's frame: y to the north.

    Raises:
        UserError: the file cannot be read, or its first route has fewer than two positions.
    """
    try:
        root = etree.parse(str(path)).getroot()
    except (OSError, etree.XMLSyntaxError) as error:
        raise UserError(f"cannot read the route of {path}: {error}") from None
    route = next(root.iter("route"), None)
    found = [] if route is None else [*route.iter("position"), *route.iter("waypoint")]
    try:
        positions = np.array([(float(one.attrib["x"]), -float(one.attrib["y"])) for one in found])
    except (KeyError, ValueError) as error:
        raise UserError(f"{path}: a position needs the numbers x and y: {error}") from None
    if len(positions) < 2 or not np.isfinite(positions).all():
        raise UserError(f"{path} has no route of at least two positions; name a route file of CARLA's leaderboard")
    return positions


def way_along(lanelet_map: LaneletMap, positions_m: F64) -> shapely.Geometry:
    """Return the middle lines of the lanes that lead from position (N, 2) to position on the shortest way.

    Where no lane leads from one to the next, such as at a change of lanes, the way is the straight line.

    Raises:
        UserError: a position is not on the map; says which.
    """
    courses = courses_of(lanelet_map)
    if not courses:
        raise UserError("the map has no lanelet of the subtype road, so no route leads along it")
    lines = [shapely.LineString(course.middle[:, :2]) for course in courses]
    graph = _digraph(lanelet_map, courses)
    tree = shapely.STRtree(lines)
    at = [_lanes_at(tree, lines, place) for place in positions_m]
    parts = [shapely.LineString(pair) for pair in pairwise(positions_m.tolist())]
    for starts, ends in pairwise(at):
        parts += [lines[nth] for nth in _between(graph, starts, ends)]
    return shapely.union_all(parts)


def part_along(lanelet_map: LaneletMap, way: shapely.Geometry, within_m: float) -> LaneletMap:
    """Return the map without what is farther from a way than ``within_m``.

    A lanelet is kept as a whole when one of its sides comes near enough. A road lanelet that loses all its predecessors
    or all its successors is left out, unless it belongs to the way. Autoware.AI's op_global_planner joins such an end
    to another lane nearby, and may die of it. A regulatory element is kept while a kept lanelet refers to it.

    Raises:
        UserError: no road lanelet is near enough.
    """
    near = _near_ways(lanelet_map, way, within_m)
    kept = {
        number
        for number, lanelet in lanelet_map.lanelets()
        if not near.isdisjoint((*lanelet.refs("left"), *lanelet.refs("right")))
    }
    if not any(number in kept for number, _ in lanelet_map.lanelets("road")):
        raise UserError(f"no side of a lane comes within {within_m:g} m of the route; give --within a larger distance")
    kept -= _cut_off(lanelet_map, way, kept)
    kept |= {ref for number in kept for ref in lanelet_map.relations[number].refs("regulatory_element")}
    relations = {number: _with_members_of(one, kept) for number, one in lanelet_map.relations.items() if number in kept}
    used = {member.ref for one in relations.values() for member in one.members if member.kind == "way"}
    theirs = {member.ref for one in lanelet_map.relations.values() for member in one.members if member.kind == "way"}
    wanted = used | (near - theirs)
    ways = {number: line for number, line in lanelet_map.ways.items() if number in wanted}
    nodes_used = {node for line in ways.values() for node in line.nodes}
    nodes = {number: one for number, one in lanelet_map.nodes.items() if number in nodes_used}
    return replace(lanelet_map, nodes=nodes, ways=ways, relations=relations)


def _cut_off(lanelet_map: LaneletMap, way: shapely.Geometry, kept: set[int]) -> set[int]:
    """Return the kept road lanelets beside the way that lead nowhere or come from nowhere once the others are gone."""
    courses = courses_of(lanelet_map)
    graph = graph_of(lanelet_map, courses)
    beside = shapely.buffer(way, _SAME_M)
    shapely.prepare(beside)
    fixed = {nth for nth, one in enumerate(courses) if shapely.covers(beside, shapely.LineString(one.middle[:, :2]))}
    left = {nth for nth, one in enumerate(courses) if one.lanelet in kept}
    pending = sorted(left - fixed)
    while pending:
        nth = pending.pop()
        ends = [links for links in (graph.predecessors[nth], graph.successors[nth]) if links]
        if nth in left and nth not in fixed and any(left.isdisjoint(links) for links in ends):
            left.remove(nth)
            pending += [*graph.predecessors[nth], *graph.successors[nth]]
    return {one.lanelet for nth, one in enumerate(courses) if one.lanelet in kept and nth not in left}


def _near_ways(lanelet_map: LaneletMap, way: shapely.Geometry, within_m: float) -> set[int]:
    """Return the polylines of a map that come within a distance of a way."""
    numbers = [number for number, line in lanelet_map.ways.items() if len(line.nodes) > 1]
    lines = [shapely.LineString(lanelet_map.line(number)[:, :2]) for number in numbers]
    shapely.prepare(way)
    is_near = shapely.dwithin(lines, way, within_m)
    return {number for number, one in zip(numbers, is_near.tolist(), strict=True) if one}


def _with_members_of(relation: Relation, kept: set[int]) -> Relation:
    """Return a relation without the members that are relations and were not kept."""
    members = tuple(one for one in relation.members if one.kind != "relation" or one.ref in kept)
    return relation._replace(members=members)


def _digraph(lanelet_map: LaneletMap, courses: list[Course]) -> "nx.DiGraph[int]":
    """Return which course leads into which; an edge is as long as the course it leaves, in m."""
    graph: nx.DiGraph[int] = nx.DiGraph()
    graph.add_nodes_from(range(len(courses)))
    for nth, after in enumerate(graph_of(lanelet_map, courses).successors):
        length_m = float(lengths(courses[nth].middle)[-1])
        graph.add_weighted_edges_from((nth, other, length_m) for other in after)
    return graph


def _lanes_at(tree: shapely.STRtree, lines: list[shapely.LineString], place: F64) -> list[int]:
    """Return the courses on which a place lies; the nearest where it lies on none."""
    point = shapely.Point(place)
    found: list[int] = sorted(tree.query(point, predicate="dwithin", distance=_ON_LANE_M).tolist())
    if found:
        return found
    nearest = int(tree.nearest(point))
    away_m = lines[nearest].distance(point)
    if away_m > _FAR_M:
        x_m, y_m = place.tolist()
        raise UserError(
            f"the route's position x {x_m:.1f}, y {-y_m:.1f} is {away_m:.0f} m from the nearest lane; "
            "name a route of this map"
        )
    return [nearest]


def _between(graph: "nx.DiGraph[int]", starts: list[int], ends: list[int]) -> list[int]:
    """Return the courses of the shortest way from one of some courses to one of others; none where no way leads."""
    found = cast("tuple[dict[int, float], dict[int, list[int]]]", nx.multi_source_dijkstra(graph, set(starts)))
    away_m, ways = found
    reached = [end for end in ends if end in away_m]
    return ways[min(reached, key=lambda end: (away_m[end], end))] if reached else []
