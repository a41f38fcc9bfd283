"""Intersection areas: a ring of nodes around each junction, along the ends of its legs and the kerbs between them."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from shapely import (
    LinearRing,
    Polygon,
    contains_xy,
    convex_hull,
    distance,
    get_coordinates,
    linestrings,
    make_valid,
    multipoints,
    orient_polygons,
    points,
)

from linden.maps.opendrive.evaluate.pieces import F64
from linden_maps.lanelet2.model import Bounds, LaneletMap
from linden_maps.lanelet2.overlap import overlap_share

_KERB_REACH_M = 5.0
"""Between the outermost lane of a leg and the kerb round its corner: a parking lane, and the kerb's own set-back."""
_WHOLE = 0.991
"""The share of a lanelet that has to lie inside; the validator wants 0.99."""
_NEAR_M = 0.01
"""So little out of an area is less than the validator's hundredth of any lane."""
_TOUCH_M = 1e-3


class EntryLeg(NamedTuple):
    """Where a street meets a junction: nodes from left to right in the direction of entry."""

    nodes: tuple[int, ...]
    angle_rad: float  # round the junction's middle


def ring_of(
    target: LaneletMap,
    entries: list[Bounds],
    exits: list[Bounds],
    ways: list[Bounds],
    kerbs: list[tuple[int, ...]],
) -> tuple[int, ...]:
    """Return the nodes of a junction's area, counter-clockwise: the first candidate ring that contains all ways.

    First comes the ring of the ends of the legs and the kerbs round the corners. Then come the ends alone. Then come
    convex hulls: of the ends, of ends and kerbs, of the ways. ``entries`` lead into the junction, ``exits`` lead out of
    it, and ``ways`` lie inside; all are given by their sides. The ring is empty where there is no area.
    """
    legs = _legs(target, entries, exits) if entries or exits else []
    ends = [node for leg in legs for node in leg.nodes]
    outlines = [_places(target, (*way.left, *way.right[::-1])) for way in ways]
    corners = [node for kerb in kerbs for node in kerb]
    for ring in (
        _ring(target, legs, kerbs),
        _ring(target, legs, []),
        _hull(target, ends),
        _hull(target, [*ends, *corners]),
    ):
        places = _places(target, ring)
        if len(ring) < 3 or not _is_simple(places):
            continue
        if all(_holds(places, outline) for outline in outlines):
            return ring
    ring = _hull(target, [node for way in ways for side in way for node in side])
    return ring if len(ring) > 2 else ()


def _legs(target: LaneletMap, entries: list[Bounds], exits: list[Bounds]) -> list[EntryLeg]:
    """Return the legs in the order of their angle; lanes that share a node at the junction are one leg."""
    edges = [(side.left[-1], side.right[-1]) for side in entries] + [(side.right[0], side.left[0]) for side in exits]
    groups: list[set[int]] = []
    order: dict[int, list[tuple[int, int]]] = {}
    for edge in dict.fromkeys(edges):
        touched = [group for group in groups if group & set(edge)]
        merged = set(edge).union(*touched)
        groups = [group for group in groups if group not in touched] + [merged]
    for edge in dict.fromkeys(edges):
        nth = next(number for number, group in enumerate(groups) if edge[0] in group)
        order.setdefault(nth, []).append(edge)
    middle = _places(target, tuple(dict.fromkeys(node for edge in edges for node in edge))).mean(axis=0)
    legs = []
    for group in order.values():
        across = sum(_place(target, right) - _place(target, left) for left, right in group)
        nodes = dict.fromkeys(node for edge in group for node in edge)
        ranked = sorted(nodes, key=lambda node: (float(_place(target, node) @ across), node))
        away = _places(target, tuple(ranked)).mean(axis=0) - middle
        legs.append(EntryLeg(tuple(ranked), math.atan2(away[1], away[0])))
    return sorted(legs, key=lambda leg: (leg.angle_rad, leg.nodes))


def _ring(target: LaneletMap, legs: list[EntryLeg], kerbs: list[tuple[int, ...]]) -> tuple[int, ...]:
    ring: list[int] = []
    for leg, following in zip(legs, [*legs[1:], *legs[:1]], strict=True):
        ring += leg.nodes
        start, end = _place(target, leg.nodes[-1]), _place(target, following.nodes[0])
        best: tuple[float, tuple[int, ...]] = (2.0 * _KERB_REACH_M, ())
        for kerb in kerbs:
            for way in (kerb, kerb[::-1]):
                gap_m = math.dist(start, _place(target, way[0])) + math.dist(end, _place(target, way[-1]))
                best = min(best, (gap_m, way))
        ring += best[1]
    return tuple(dict.fromkeys(ring))


def _place(target: LaneletMap, node: int) -> F64:
    return np.array(target.nodes[node][:2])


def _places(target: LaneletMap, ring: tuple[int, ...]) -> F64:
    return np.array([target.nodes[node][:2] for node in ring]).reshape(-1, 2)


def _is_simple(ring: F64) -> bool:
    """Return whether a ring turns to the left as a whole, and no two of its edges cross or touch but at common ends."""
    line = LinearRing(ring)
    return line.is_simple and line.is_ccw and not _touches(ring)


def _holds(ring: F64, outline: F64) -> bool:
    """Return whether a lanelet's outline (N, 2) lies in a ring (M, 2); its area is summed where corners do not tell."""
    outside = outline[~inside(ring, outline)]
    notches = ring[inside(outline, ring)]
    strays = [distance(points(places), LinearRing(other)) for places, other in ((outside, ring), (notches, outline))]
    if all((gap_m < _NEAR_M).all() for gap_m in strays):
        return True
    return overlap_share(outline, ring) >= _WHOLE


def _touches(ring: F64) -> bool:
    """Return whether a corner of a ring (N, 2) lies on an edge that it does not end."""
    edges = linestrings(np.stack([ring, np.roll(ring, -1, axis=0)], axis=1))
    corner, edge = np.nonzero(distance(points(ring[:, None]), edges) < _TOUCH_M)
    return bool(((corner != edge) & (corner != (edge + 1) % len(ring))).any())


def _hull(target: LaneletMap, nodes: list[int]) -> tuple[int, ...]:
    """Return the convex hull of nodes, counter-clockwise."""
    node_at = {target.nodes[node][:2]: node for node in nodes}
    hull = orient_polygons(convex_hull(multipoints(list(node_at))))
    return tuple(node_at[x, y] for x, y in get_coordinates(hull)[:-1].tolist())


def inside(ring: F64, places: F64) -> NDArray[np.bool_]:
    """Return which places (N, 2) lie inside a ring (M, 2)."""
    within: NDArray[np.bool_] = contains_xy(make_valid(Polygon(ring)), places)
    return within
