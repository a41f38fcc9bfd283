"""Marked crosswalks at junctions: their streets end at the stop line, and people cross on the marking alone.

OpenDRIVE's roads end behind a crosswalk, and netconvert makes a lane of a whole road. So SUMO's drivers would stop on
the crosswalk, and netconvert's own crossings lie beside it, inside the junction.
"""

import itertools
import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from lxml import etree

from linden.maps.navigation.areas import crosswalk_outlines
from linden.maps.opendrive.model import OpenDrive
from linden_maps.sumo.net import Net, NetEdge, along

AT_JUNCTION_M = 20.0  # from a crosswalk to the end of a street; one farther away crosses within the street
LINE_M = 1.8  # from a crosswalk to where vehicles stop: MUTCD 3B.16 asks for 4 ft of road and a line of up to 2 ft
SHORTEST_M = 5.0  # of a street between two crosswalks; one that would be shorter keeps its ends

Place = tuple[float, float]
Point = tuple[float, float, float]


class CrosswalkLeg(NamedTuple):
    """A leg of a junction with a marked crosswalk. Places are in SUMO's frame."""

    node: str
    coming: str  # the edge into the junction
    going: str | None  # the edge out of it
    cut_m: float  # from the stop line to the end of the street
    ends_m: tuple[Point, Point]  # of the crosswalk, from left to right for traffic into the junction
    width_m: float


def marked_legs(net: Net, opendrive: OpenDrive) -> tuple[CrosswalkLeg, ...]:
    """Return the legs with a marked crosswalk, in the order of the map; a leg with several has that nearest to it."""
    found: dict[tuple[str, str], CrosswalkLeg] = {}
    for road_id, outline_m in crosswalk_outlines(opendrive):
        shape = [(x_m + net.offset_m[0], y_m + net.offset_m[1]) for x_m, y_m in outline_m]
        for edge in _edges_of_road(net, road_id):
            leg = _leg(net, edge, shape)
            if leg is not None:
                known = found.setdefault((leg.node, leg.coming), leg)
                found[leg.node, leg.coming] = min(known, leg, key=lambda each: each.cut_m)
    return tuple(found.values())


def _edges_of_road(net: Net, road_id: int) -> list[NetEdge]:
    """Return the edges for cars that were made of a road's lanes."""
    return [edge for edge in net.car_edges() if str(road_id) in _roads_of(edge)]


def _roads_of(edge: NetEdge) -> set[str]:
    """Return the roads that an edge was made of."""
    return {origin.rpartition("_")[0] for lane in edge.car_lanes for origin in lane.origins}


def _leg(net: Net, edge: NetEdge, shape: Sequence[Place]) -> CrosswalkLeg | None:
    """Return the leg that ``edge`` comes in on, where a crosswalk lies before its end."""
    lane = edge.car_lanes[-1]
    if net.node_types[edge.end] == "dead_end":
        return None
    line_m = sum(math.dist(first[:2], second[:2]) for first, second in itertools.pairwise(lane.shape))
    at_m = [along(lane, *corner)[1] for corner in shape]
    cut_m = line_m - min(at_m) + LINE_M
    if cut_m - LINE_M > AT_JUNCTION_M or lane.length_m - cut_m < SHORTEST_M:
        return None
    back = (each for each in net.car_edges() if each.start == edge.end and each.end == edge.start)
    going = next((each.id for each in back if _roads_of(each) & _roads_of(edge)), None)
    (x0_m, y0_m), (x1_m, y1_m) = lane.shape[-2][:2], lane.shape[-1][:2]
    z_m = lane.shape[-1][2] if len(lane.shape[-1]) > 2 else 0.0
    ends_m, width_m = _axis(shape, ((x1_m - x0_m), (y1_m - y0_m)), z_m)
    return CrosswalkLeg(edge.end, edge.id, going, cut_m, ends_m, width_m)


def _axis(shape: Sequence[Place], heading: Place, z_m: float) -> tuple[tuple[Point, Point], float]:
    """Return the ends of a crosswalk's axis, from left to right of ``heading``, and its width along the street.

    Both ends have the height of the street's end. Without one, people would walk at height 0.
    """
    size = math.hypot(*heading)
    ahead = (heading[0] / size, heading[1] / size)
    right = (ahead[1], -ahead[0])
    middle = (sum(x for x, _ in shape) / len(shape), sum(y for _, y in shape) / len(shape))
    aside_m = [(x - middle[0]) * right[0] + (y - middle[1]) * right[1] for x, y in shape]
    ahead_m = [(x - middle[0]) * ahead[0] + (y - middle[1]) * ahead[1] for x, y in shape]
    left, right_end = (
        (middle[0] + far_m * right[0], middle[1] + far_m * right[1], z_m) for far_m in (min(aside_m), max(aside_m))
    )
    return (left, right_end), max(ahead_m) - min(ahead_m)


def end_at_lines(root: "etree._Element", legs: Iterable[CrosswalkLeg]) -> None:
    """Shorten the streets of a network, so that they end at the stop lines before their marked crosswalks."""
    cuts: dict[str, list[float]] = {}
    for leg in legs:
        cuts.setdefault(leg.coming, [0.0, 0.0])[1] = leg.cut_m
        if leg.going is not None:
            cuts.setdefault(leg.going, [0.0, 0.0])[0] = leg.cut_m
    for edge in root.iter("edge"):
        begin_m, end_m = cuts.get(str(edge.get("id")), (0.0, 0.0))
        for element in (edge, *edge.iter("lane")) if begin_m or end_m else ():
            if element.get("shape") is None:
                continue
            points = [tuple(map(float, point.split(","))) for point in str(element.get("shape")).split()]
            rest = _without_begin(_without_begin(points, begin_m)[::-1], end_m)[::-1]
            element.set("shape", " ".join(",".join(f"{value:.2f}" for value in point) for point in rest))
            if element.get("length") is not None:
                element.set("length", f"{float(str(element.get('length'))) - begin_m - end_m:.2f}")


def _without_begin(points: list[tuple[float, ...]], cut_m: float) -> list[tuple[float, ...]]:
    """Return a line without its first metres."""
    rest_m = cut_m
    for number, (first, second) in enumerate(itertools.pairwise(points)):
        length_m = math.dist(first[:2], second[:2])
        if length_m > rest_m:
            share = rest_m / length_m
            at = tuple(one + share * (other - one) for one, other in zip(first, second, strict=True))
            return [at, *points[number + 1 :]]
        rest_m -= length_m
    return points


def crossing_patch(legs: Iterable[CrosswalkLeg]) -> bytes:
    """Return the file of crossings for netconvert, each on its marking."""
    root = etree.Element("connections")
    for leg in legs:
        edges = [each for each in (leg.going, leg.coming) if each is not None]
        shape = " ".join(",".join(f"{value:.2f}" for value in end) for end in leg.ends_m)
        given = {"node": leg.node, "edges": " ".join(edges), "shape": shape, "width": f"{leg.width_m:.2f}"}
        etree.SubElement(root, "crossing", given)
    return etree.tostring(root, pretty_print=True)
