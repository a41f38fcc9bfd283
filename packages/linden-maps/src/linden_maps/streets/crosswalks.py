"""Crosswalks of a map: at schools, behind shuttle stops, and where the facts have crossings."""

import math
from collections.abc import Iterator

from linden_maps.streets import controls
from linden_maps.streets.cross_section import view
from linden_maps.streets.curves import Point, length, pose_at
from linden_maps.streets.document import Object
from linden_maps.streets.network import End, Network, nearest_road
from linden_maps.streets.street_facts import Facts

CROSSWALK_BEFORE_STOP_M = 8.0  # passengers cross behind the shuttle
ONE_CROSSWALK_WITHIN_M = 30.0  # of opposite stops
CROSSING_AT_JUNCTION_M = 14.0  # a crossing this near to a junction crosses that leg, before the stop line
SCHOOL_CROSSING_WITHIN_M = 150.0

Between = tuple[tuple[int, float, str], ...]
"""Crossings between junctions: edge, place along its road in m, confidence."""


def nodes_at_schools(facts: Facts, network: Network) -> frozenset[int]:
    """Return the nodes nearest to schools: their legs get crosswalks."""
    found = set()
    real = [number for number, node in enumerate(network.nodes) if node.intersection is not None]
    for school in facts.schools:
        nearest = min(real, key=lambda number: math.dist(network.nodes[number].point, school.point), default=None)
        if nearest is not None and math.dist(network.nodes[nearest].point, school.point) < SCHOOL_CROSSING_WITHIN_M:
            found.add(nearest)
    return frozenset(found)


def mapped_crossings(facts: Facts, network: Network) -> tuple[frozenset[End], Between]:
    """Return the ends of roads that the facts' crossings lie at, and the crossings between junctions."""
    ends, between = set(), []
    for crossing in facts.crossings:
        edge, s_m = nearest_road(network, crossing.street_id, crossing.point)
        road = network.roads[edge] if edge >= 0 else None
        if road is None:
            continue
        rest_m = length(road) - s_m
        met = {leg.end for _, legs in network.junctions if len(legs) > 1 for leg in legs}
        end = End(edge, at_end=rest_m < s_m)
        if min(s_m, rest_m) < CROSSING_AT_JUNCTION_M and end in met:
            ends.add(end)
        else:
            between.append((edge, s_m, crossing.confidence))
    return frozenset(ends), tuple(between)


def at_stops(facts: Facts, network: Network, ids: Iterator[int]) -> Iterator[tuple[int, Object]]:
    """Yield an edge and a crosswalk behind each shuttle stop, one for two stops that face each other."""
    taken: list[Point] = []
    for stop in facts.stops:
        edge, s_m = nearest_road(network, stop.street_id, stop.point)
        road = network.roads[edge]
        assert road is not None
        behind_m = s_m - CROSSWALK_BEFORE_STOP_M if stop.forward else s_m + CROSSWALK_BEFORE_STOP_M
        at_m = min(max(behind_m, controls.CROSSWALK_M), length(road) - controls.CROSSWALK_M)
        pose = pose_at(road, at_m)
        if any(math.dist((pose.x_m, pose.y_m), other) < ONE_CROSSWALK_WITHIN_M for other in taken):
            continue
        taken.append((pose.x_m, pose.y_m))
        across = view(network.edges[edge].section, along=True)
        yield edge, controls.crosswalk_at(next(ids), across, at_m, stop.confidence)


def between_junctions(crossings: Between, network: Network, ids: Iterator[int]) -> Iterator[tuple[int, Object]]:
    """Yield an edge and a crosswalk for each crossing of the facts that lies between junctions."""
    for edge, s_m, confidence in crossings:
        road = network.roads[edge]
        assert road is not None
        at_m = min(max(s_m, controls.CROSSWALK_M), length(road) - controls.CROSSWALK_M)
        across = view(network.edges[edge].section, along=True)
        yield edge, controls.crosswalk_at(next(ids), across, at_m, confidence)
