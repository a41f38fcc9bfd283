"""From street lines to roads and the gaps between them: nodes, edges, and how far each edge is cut back at its ends.

An edge is a street between two nodes. At a node with several legs each leg is cut back until the kerbs of neighbouring
legs can be joined by an arc; nodes without a road between their legs then become one junction.
"""

import math
from collections import defaultdict
from typing import NamedTuple

from linden.errors import UserError
from linden_maps.streets.cross_section import Section, View, of_street, view
from linden_maps.streets.curves import Path, Point, Pose, length, pose_at, rounded, trimmed, turned_back, wrapped
from linden_maps.streets.rings import KERB_RADII_M, LANE_RADII_M, leads_in
from linden_maps.streets.street_facts import Control, Facts, Intersection, Street

BEND_RADIUS_M = {"arterial": 60.0, "collector": 40.0, "local": 20.0, "service": 12.0}
CORNER_RADII_M = (6.0, 4.5, 3.5)
"""Of kerbs at street corners, the tighter ones where junctions stand close; estimated, not measured."""

SHORTEST_ROAD_M = 5.0  # between two junctions; below that they are one
SHORTEST_SETBACK_M = 6.0
LONGEST_SETBACK_M = 40.0
ROUNDABOUT_SETBACK_M = 16.0
BEND_SETBACK_M = 6.0
ACUTEST_RAD = math.radians(5)
"""Below that two legs run side by side, and their kerbs meet farther out than any leg is cut."""

SIGHT_M = 15.0  # a leg's direction is taken this far from its node


class Node(NamedTuple):
    """Where edges end."""

    point: Point
    intersection: Intersection | None


class Edge(NamedTuple):
    """A street between two nodes, its centre-line from node to node, corners rounded."""

    street: Street
    section: Section
    points: tuple[Point, ...]
    path: Path
    nodes: tuple[int, int]


class End(NamedTuple):
    """One end of an edge: ``at_end`` is false at the start of its path."""

    edge: int
    at_end: bool


class Leg(NamedTuple):
    """What a junction sees of a road: where it was cut and what lies across it, looking into the junction."""

    end: End
    node: int
    street: Street
    pose: Pose
    view: View
    setback_m: float


class Network(NamedTuple):
    """The roads (cut back, None inside a junction); for each junction its nodes, and its legs counter-clockwise."""

    nodes: tuple[Node, ...]
    edges: tuple[Edge, ...]
    roads: tuple[Path | None, ...]
    junctions: tuple[tuple[tuple[int, ...], tuple[Leg, ...]], ...]


def build(facts: Facts) -> Network:
    """Return the network of the facts; what it holds is in the order of the streets and their points."""
    nodes, edges = _split(facts)
    met = {node.point for node in nodes}
    for intersection in facts.intersections:
        if intersection.point not in met:
            raise UserError(f"intersection {intersection.id}: no two streets share its point; give them the same one")
    groups = [[number] for number in range(len(nodes))]
    tightness = [0] * len(nodes)
    while True:
        legs = [_legs(group, nodes, edges, CORNER_RADII_M[max(tightness[node] for node in group)]) for group in groups]
        legs = [group if len(group) > 1 or facts.turning_circles else [] for group in legs]
        setbacks = {leg.end: leg.setback_m for group in legs for leg in group}
        home = {node: number for number, group in enumerate(groups) for node in group if len(group) > 1}
        roads = tuple(_road(number, edge, setbacks, home) for number, edge in enumerate(edges))
        too_short = [
            edge.nodes
            for edge, road in zip(edges, roads, strict=True)
            if road is not None and length(road) < SHORTEST_ROAD_M
        ]
        if not too_short:
            break
        loose = {node for pair in too_short for node in pair if tightness[node] + 1 < len(CORNER_RADII_M)}
        for node in loose:
            tightness[node] += 1
        if not loose:
            groups = _merged(groups, too_short)
            for node in (node for group in groups if len(group) > 1 for node in group):
                tightness[node] = 0
    junctions = tuple((tuple(group), tuple(found)) for group, found in zip(groups, legs, strict=True) if found)
    return Network(nodes, edges, roads, junctions)


def nearest_road(network: Network, street_id: str, point: Point) -> tuple[int, float]:
    """Return which road (edge) of a street passes nearest to a point, and how far along, looked up every 0.25 m."""
    best = (math.inf, -1, 0.0)
    for number, (edge, road) in enumerate(zip(network.edges, network.roads, strict=True)):
        if edge.street.id != street_id or road is None:
            continue
        steps = math.ceil(length(road) / 0.25)
        for i in range(steps + 1):
            s_m = length(road) * i / steps
            pose = pose_at(road, s_m)
            best = min(best, (math.dist((pose.x_m, pose.y_m), point), number, s_m))
    return best[1], best[2]


def _road(number: int, edge: Edge, setbacks: dict[End, float], home: dict[int, int]) -> Path | None:
    """Return what is left of an edge between its junctions, None where it lies inside one."""
    if edge.nodes[0] in home and home[edge.nodes[0]] == home.get(edge.nodes[1]):
        return None
    begin_m, end_m = (setbacks.get(End(number, at_end), 0.0) for at_end in (False, True))
    return trimmed(edge.path, begin_m, length(edge.path) - end_m)


def _split(facts: Facts) -> tuple[tuple[Node, ...], tuple[Edge, ...]]:
    """Cut the streets where they touch: at points that two of them share, at intersections and at their ends."""
    uses: dict[Point, int] = defaultdict(int)
    for street in facts.streets:
        for point in street.points:
            uses[point] += 1
    intersections = {one.point: one for one in facts.intersections}
    numbers: dict[Point, int] = {}
    nodes: list[Node] = []
    edges: list[Edge] = []
    for street in facts.streets:
        section = of_street(street)
        first = 0
        last = len(street.points) - 1
        for i, point in enumerate(street.points):
            if i not in {0, last} and uses[point] == 1:
                continue
            if point not in numbers:
                numbers[point] = len(nodes)
                nodes.append(Node(point, intersections.get(point)))
            if i > 0:
                points = street.points[first : i + 1]
                path = rounded(points, BEND_RADIUS_M[street.street_class], ends_kept_m=12.0)
                edges.append(Edge(street, section, points, path, (numbers[points[0]], numbers[point])))
            first = i
    return tuple(nodes), tuple(edges)


def _merged(groups: list[list[int]], pairs: list[tuple[int, int]]) -> list[list[int]]:
    """Return the groups with those joined that hold both nodes of a pair; groups keep the order of their first node."""
    home = {node: group for group in groups for node in group}
    for a, b in pairs:
        one, other = sorted((home[a], home[b]))
        if one is not other:
            one.extend(other)
            home.update(dict.fromkeys(other, one))
    kept = {min(group): sorted(group) for group in home.values()}
    return [kept[key] for key in sorted(kept)]


def _legs(group: list[int], nodes: tuple[Node, ...], edges: tuple[Edge, ...], radius_m: float) -> list[Leg]:
    """Return the legs of a group of nodes, counter-clockwise by where they leave it. Inner edges are none."""
    inside = set(group)
    uncut = []
    for number, edge in enumerate(edges):
        if inside.issuperset(edge.nodes) and len(group) > 1:
            continue
        uncut += [_uncut(End(number, at_end), edge) for at_end in (False, True) if edge.nodes[at_end] in inside]
    if len(uncut) == 1:
        return _turning_circle(uncut[0], edges[uncut[0].end.edge])
    centre = _centre([nodes[node].point for node in group])
    uncut.sort(key=lambda leg: _bearing(centre, pose_at(_outward(edges[leg.end.edge].path, leg.end), 30.0)))
    least_m = _least_setback(group, nodes, uncut)
    cut_m = [least_m] * len(uncut)
    for i, leg in enumerate(uncut):
        j = (i + 1) % len(uncut)
        reach = _corner(leg, uncut[j], radius_m)
        cut_m[i], cut_m[j] = max(cut_m[i], reach[0]), max(cut_m[j], reach[1])
    return [
        leg._replace(
            setback_m=cut,
            pose=turned_back(pose_at(_outward(edges[leg.end.edge].path, leg.end), cut)),
        )
        for leg, cut in zip(uncut, (min(cut, LONGEST_SETBACK_M) for cut in cut_m), strict=True)
    ]


def _turning_circle(leg: Leg, edge: Edge) -> list[Leg]:
    """Return the only leg of a street's end, cut back for a turning circle; none without need or room for it."""
    if edge.street.oneway or length(edge.path) < 4 * ROUNDABOUT_SETBACK_M:
        return []
    pose = turned_back(pose_at(_outward(edge.path, leg.end), ROUNDABOUT_SETBACK_M))
    lanes = [(lane, side) for side in (True, False) for lane in leg.view.driving(right=side)]
    middles_m = [leg.view.middle_m(lane, right=side) for lane, side in lanes]
    kerbs_m = [leg.view.kerb_m(right=side) for side in (True, False)]
    centre = pose_at(_outward(edge.path, leg.end), 0.0)[:2]
    if not (leads_in(pose, centre, middles_m, LANE_RADII_M) and leads_in(pose, centre, kerbs_m, KERB_RADII_M)):
        return []
    return [leg._replace(setback_m=ROUNDABOUT_SETBACK_M, pose=pose)]


def _uncut(end: End, edge: Edge) -> Leg:
    """Return a leg that still reaches its node, its pose there, looking in along the leg's first metres."""
    outward = _outward(edge.path, end)
    near, far = pose_at(outward, 0.0), pose_at(outward, min(SIGHT_M, length(outward) / 2))
    heading = math.atan2(near.y_m - far.y_m, near.x_m - far.x_m)
    return Leg(
        end,
        edge.nodes[end.at_end],
        edge.street,
        Pose(near.x_m, near.y_m, heading),
        view(edge.section, along=end.at_end),
        0.0,
    )


def _outward(path: Path, end: End) -> Path:
    """Return the path as walked away from the junction at that end."""
    if not end.at_end:
        return path
    return tuple(
        piece._replace(
            start=turned_back(pose_at((piece,), piece.length_m)),
            curvature_per_m=-piece.curvature_per_m,
        )
        for piece in reversed(path)
    )


def _least_setback(group: list[int], nodes: tuple[Node, ...], legs: list[Leg]) -> float:
    """Return the distance from the node that every leg of the junction keeps."""
    controls = {nodes[node].intersection.control for node in group if nodes[node].intersection}  # type: ignore[union-attr]  # just asked
    if Control.ROUNDABOUT in controls:
        return ROUNDABOUT_SETBACK_M
    if len(legs) == 2:
        turn = abs(wrapped(legs[1].pose.heading_rad + math.pi - legs[0].pose.heading_rad))
        return max(BEND_SETBACK_M, BEND_RADIUS_M["service"] * math.tan(min(turn, 2.4) / 2))
    return SHORTEST_SETBACK_M


def _corner(leg: Leg, after: Leg, radius_m: float) -> tuple[float, float]:
    """Return how far a leg and the next one counter-clockwise are cut for a kerb arc of that radius between them.

    The two kerb lines meet some way out; from there the arc's tangents are radius / tan(half the angle) long.
    """
    out, out_after = turned_back(leg.pose), turned_back(after.pose)
    between = (out_after.heading_rad - out.heading_rad) % math.tau
    if not ACUTEST_RAD < between < math.radians(150):
        return 0.0, 0.0
    kerb_m = -leg.view.kerb_m(right=True)
    kerb_after_m = after.view.kerb_m(right=False)
    ux, uy = math.cos(out.heading_rad), math.sin(out.heading_rad)
    vx, vy = math.cos(out_after.heading_rad), math.sin(out_after.heading_rad)
    # points on the kerbs: out + kerb to its left + a u, and out_after + kerb to its right + b v
    dx = (out_after.x_m + vy * kerb_after_m) - (out.x_m - uy * kerb_m)
    dy = (out_after.y_m - vx * kerb_after_m) - (out.y_m + ux * kerb_m)
    sin = ux * vy - uy * vx
    a = (dx * vy - dy * vx) / sin
    b = (dx * uy - dy * ux) / sin
    tangent_m = radius_m / math.tan(between / 2)
    return a + tangent_m, b + tangent_m


def _centre(points: list[Point]) -> Point:
    return math.fsum(x for x, _ in points) / len(points), math.fsum(y for _, y in points) / len(points)


def _bearing(centre: Point, pose: Pose) -> float:
    """Return the direction from a centre to a pose, in [0, 2 pi)."""
    return math.atan2(pose.y_m - centre[1], pose.x_m - centre[0]) % math.tau
