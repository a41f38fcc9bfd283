"""Traffic control of each junction of an OpenStreetMap extract (lights, signs, roundabout), tagged or guessed.

Sources: OpenStreetMap Wiki, "Tag:highway=traffic_signals", "Tag:highway=stop", "Tag:highway=give_way". Signs and lights
are mapped on the junction's node, or on the way before it; a tag ``direction`` then says for which traffic.
"""

import math
from collections import Counter, defaultdict
from collections.abc import Mapping
from itertools import pairwise
from typing import NamedTuple

from shapely import LineString, Point

from linden_maps.openstreetmap.extract import Extract, Tags
from linden_maps.openstreetmap.graph import STRAIGHT_TO_RING_M, Segment, SegmentGraph
from linden_maps.openstreetmap.tags import TAGGED
from linden_maps.streets.street_facts import Control

FARTHEST_M = 60.0
"""From a sign or light on a way to its junction; farther ones are those of crossings between junctions."""

_KINDS = {"traffic_signals": "signal", "stop": "stop", "give_way": "give_way"}
_RANK = {"arterial": 0, "collector": 1, "local": 2, "service": 3}


class Governed(NamedTuple):
    """What governs a junction: the segments with traffic that waits, and where that is known from."""

    control: Control
    waiting: tuple[str, ...]
    source: str


class JunctionControls(NamedTuple):
    """What governs each junction node, and how many signs and lights belong to no junction."""

    at: Mapping[int, Governed]
    unplaced: Counter[str]


def controls_of(extract: Extract, graph: SegmentGraph, *, metric: bool) -> JunctionControls:
    """Return what governs the junctions. ``metric``: guessed signs are yield signs; else stop signs, as in the US."""
    ends: dict[int, list[tuple[Segment, bool]]] = defaultdict(list)
    for segment in graph.segments:
        ends[segment.nodes[0]].append((segment, False))
        ends[segment.nodes[-1]].append((segment, True))
    junctions = {node for node, legs in ends.items() if len(legs) > 2 or node in graph.rings}
    marks, unplaced = _marks_before(extract, graph, junctions)
    found = {}
    for node in sorted(junctions):
        own = extract.nodes[node].tags if node in extract.nodes else {}
        incoming = [segment for segment, at_end in ends[node] if _lanes_into(segment, at_end=at_end)]
        governed = _told(graph, node, own, incoming, marks.get(node, {}))
        found[node] = governed or _guessed(graph, ends[node], incoming, metric=metric)
    return JunctionControls(found, unplaced)


def _told(
    graph: SegmentGraph, node: int, own: Tags, incoming: list[Segment], marks: Mapping[str, set[str]]
) -> Governed | None:
    """Return what tags say of a junction, None where they say nothing."""
    kind = _KINDS.get(own.get("highway", ""))
    if kind == "signal" or marks.get("signal"):
        return Governed(Control.SIGNAL, (), TAGGED)
    if node in graph.rings or own.get("highway") == "mini_roundabout":
        if _has_room(graph, node):
            return Governed(Control.ROUNDABOUT, (), TAGGED)
        return Governed(Control.NONE, (), "simplified: a roundabout without room for its island")
    if kind == "stop" and own.get("stop") != "minor":
        return Governed(Control.ALL_WAY_STOP, tuple(segment.id for segment in incoming), TAGGED)
    return _signed(incoming, marks) or _of_ring(graph, incoming)


def _signed(incoming: list[Segment], marks: Mapping[str, set[str]]) -> Governed | None:
    """Return what signs before a junction say, None where none stands."""
    everyone = {segment.id for segment in incoming}
    for mark, control in (("stop", Control.TWO_WAY_STOP), ("give_way", Control.GIVE_WAY)):
        waiting = marks.get(mark, set())
        if waiting:
            is_all = mark == "stop" and len(waiting) > 2 and waiting >= everyone
            return Governed(Control.ALL_WAY_STOP if is_all else control, tuple(sorted(waiting)), TAGGED)
    return None


def _of_ring(graph: SegmentGraph, incoming: list[Segment]) -> Governed | None:
    """Return that traffic waits for the traffic of a ring, None where no ring passes."""
    waiting = tuple(segment.id for segment in incoming if segment.id not in graph.circulating)
    if len(waiting) == len(incoming) or not waiting:
        return None
    return Governed(Control.GIVE_WAY, waiting, "implied by junction=roundabout")


def _guessed(
    graph: SegmentGraph, legs: list[tuple[Segment, bool]], incoming: list[Segment], *, metric: bool
) -> Governed:
    """Return a guess: traffic of a lower class waits where a street of a higher class passes through."""
    best = min(_RANK[segment.across.street_class] for segment, _ in legs)
    passing = sum(_RANK[segment.across.street_class] == best for segment, _ in legs)
    waiting = tuple(segment.id for segment in incoming if _RANK[segment.across.street_class] > best)
    if passing < 2 or not waiting or any(segment.id in graph.circulating for segment, _ in legs):
        return Governed(Control.NONE, (), "guessed: no tag, and streets of one class")
    control = Control.GIVE_WAY if metric else Control.TWO_WAY_STOP
    return Governed(control, waiting, "guessed: no tag, the lower class of street waits")


def _has_room(graph: SegmentGraph, node: int) -> bool:
    """Return whether the streets of a mini-roundabout lead straight to its middle from far enough away."""
    centre = graph.metres[node]
    for segment in graph.at(node):
        nodes = segment.nodes if segment.nodes[0] == node else segment.nodes[::-1]
        if math.dist(graph.metres[nodes[1]], centre) < STRAIGHT_TO_RING_M - 1e-6:
            return False
        if sum(math.dist(graph.metres[a], graph.metres[b]) for a, b in pairwise(nodes)) < 2 * STRAIGHT_TO_RING_M:
            return False
    return True


def _lanes_into(segment: Segment, *, at_end: bool) -> int:
    """Return how many lanes of a segment lead to one of its ends."""
    return segment.across.forward if at_end else segment.across.backward


def _marks_before(
    extract: Extract, graph: SegmentGraph, junctions: set[int]
) -> tuple[dict[int, dict[str, set[str]]], Counter[str]]:
    """Return for each junction which segments have a sign or light before it, and how many belong to none."""
    found: dict[int, dict[str, set[str]]] = defaultdict(lambda: defaultdict(set))
    unplaced: Counter[str] = Counter()
    walked = _walks(extract, graph)
    for node in sorted(walked):
        tags = extract.nodes[node].tags
        kind = _KINDS.get(tags.get("highway", ""))
        if kind is None or node in junctions:
            continue
        segment, before_m, after_m, along = walked[node]
        ends = _ends_meant(segment, tags, before_m, after_m, along=along)
        near = [end for end, far_m in ends if far_m <= FARTHEST_M and segment.nodes[-1 if end else 0] in junctions]
        if not near:
            unplaced[kind] += 1
        for end in near:
            found[segment.nodes[-1 if end else 0]][kind].add(segment.id)
    return found, unplaced


def _ends_meant(
    segment: Segment, tags: Tags, before_m: float, after_m: float, *, along: bool
) -> list[tuple[bool, float]]:
    """Return the ends of a segment (True: its last node) that a sign is meant for, with the way to them."""
    told = tags.get("traffic_signals:direction", tags.get("direction", ""))
    options = [(False, before_m), (True, after_m)]
    if told in {"forward", "backward"}:
        return [options[(told == "forward") == along]]
    possible = [(end, far_m) for end, far_m in options if _lanes_into(segment, at_end=end)]
    return sorted(possible, key=lambda option: option[1])[:1]


def _walks(extract: Extract, graph: SegmentGraph) -> dict[int, tuple[Segment, float, float, bool]]:
    """Return where each sign or light stands: the segment, the way to both its ends, whether its way runs along."""
    found: dict[int, tuple[Segment, float, float, bool]] = {}
    for segment in graph.segments:
        for way in segment.ways:
            nodes = extract.ways[way].nodes
            for node in nodes:
                if node in found or _KINDS.get(extract.nodes[node].tags.get("highway", "")) is None:
                    continue
                measured = _measured(graph, segment, node)
                if measured is not None:
                    found[node] = (segment, *measured, _is_along(segment, nodes, graph, node))
    return found


def _measured(graph: SegmentGraph, segment: Segment, node: int) -> tuple[float, float] | None:
    """Return how far along a segment a node lies, from its first and to its last node; None where it is elsewhere."""
    line = LineString([graph.metres[each] for each in segment.nodes])
    point = Point(graph.metres[node])
    if line.distance(point) > 1.0 or node in segment.ends:
        return None
    at_m = float(line.project(point))
    return at_m, float(line.length) - at_m


def _is_along(segment: Segment, nodes: tuple[int, ...], graph: SegmentGraph, node: int) -> bool:
    """Return whether the nodes of a way have the order of a segment's, near a node."""
    line = LineString([graph.metres[each] for each in segment.nodes])
    place = nodes.index(node)
    before, after = nodes[max(place - 1, 0)], nodes[min(place + 1, len(nodes) - 1)]
    return bool(line.project(Point(graph.metres[before])) < line.project(Point(graph.metres[after])))
