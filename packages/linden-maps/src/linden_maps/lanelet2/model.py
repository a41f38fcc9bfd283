"""Lanelet2's primitives as values: nodes, ways, relations. Frame: OpenDRIVE's (x east, y north, z up, m).

Source of names and meaning: Poggenhans et al., Lanelet2: A High-Definition Map Framework (ITSC 2018), and
autoware_lanelet2_extension (format 1).
"""

import hashlib
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import pairwise
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
Tags = Mapping[str, str]

ID_BITS = 48
"""Ids are positive, fit 64 bits with a sign, and a double keeps them exactly."""


SMALL_ID_BITS = 31
"""Ids that tags name: Autoware reads ``intersection_area`` with C's atoi, and ``traffic_light_id`` into an int."""

DIGITS = 4
"""Of a place in m: a tenth of a millimetre, in memory as in files, so that both are the same map."""


class LaneletPoint(NamedTuple):
    """A point in m."""

    x_m: float
    y_m: float
    z_m: float
    tags: Tags = MappingProxyType({})


class LaneletWay(NamedTuple):
    """A polyline; a closed area where its tags say ``area=yes``."""

    nodes: tuple[int, ...]
    tags: Tags


class Member(NamedTuple):
    """What a relation refers to: ``kind`` is "way" or "relation"."""

    kind: str
    ref: int
    role: str


class Relation(NamedTuple):
    """A lanelet or a regulatory element."""

    members: tuple[Member, ...]
    tags: Tags

    def refs(self, role: str) -> list[int]:
        """Return the ids of the members in a role."""
        return [member.ref for member in self.members if member.role == role]


@dataclass(slots=True)
class LaneletMap:
    """Primitives by id, in the order in which they are written."""

    nodes: dict[int, LaneletPoint] = field(default_factory=dict)
    ways: dict[int, LaneletWay] = field(default_factory=dict)
    relations: dict[int, Relation] = field(default_factory=dict)
    geo_reference: str = ""
    name: str = ""
    format_version: str = "1"  # of autoware_lanelet2_extension

    def lanelets(self, *subtypes: str) -> Iterator[tuple[int, Relation]]:
        """Yield lanelets by id; those of the given subtypes, or all."""
        for number, relation in self.relations.items():
            if relation.tags.get("type") == "lanelet" and (not subtypes or relation.tags.get("subtype") in subtypes):
                yield number, relation

    def elements(self, *subtypes: str) -> Iterator[tuple[int, Relation]]:
        """Yield regulatory elements by id; those of the given subtypes, or all."""
        for number, relation in self.relations.items():
            wanted = not subtypes or relation.tags.get("subtype") in subtypes
            if relation.tags.get("type") == "regulatory_element" and wanted:
                yield number, relation

    def line(self, way: int) -> F64:
        """Return the points (N, 3) of a way."""
        return np.array([self.nodes[node][:3] for node in self.ways[way].nodes]).reshape(-1, 3)


def without_lanelets(lanelet_map: LaneletMap, subtype: str) -> LaneletMap:
    """Return a map without the lanelets of a subtype, and without the ways and nodes that only these use."""
    dropped = {number for number, _ in lanelet_map.lanelets(subtype)}
    relations = {number: one for number, one in lanelet_map.relations.items() if number not in dropped}
    used = {member.ref for one in relations.values() for member in one.members if member.kind == "way"}
    theirs = {member.ref for number in dropped for member in lanelet_map.relations[number].members}
    ways = {number: way for number, way in lanelet_map.ways.items() if number in used or number not in theirs}
    kept = {node for way in ways.values() for node in way.nodes}
    nodes = {number: node for number, node in lanelet_map.nodes.items() if number in kept}
    return replace(lanelet_map, nodes=nodes, ways=ways, relations=relations)


class Bounds(NamedTuple):
    """The two sides of a lanelet in its direction of travel: node ids from its start to its end."""

    left: tuple[int, ...]
    right: tuple[int, ...]


def bounds_of(lanelet_map: LaneletMap, lanelet: Relation) -> Bounds:
    """Return a lanelet's sides, each turned so that left lies on the left, whatever the order of the ways' nodes.

    Lanelet2's loader does the same (``geometry::align`` of lanelet2_core); here the ends that
    lie nearer belong together, and the sign of the whole outline's area says which side is left, in bends too.

    Raises:
        KeyError, IndexError: the lanelet lacks a side, or names a way that is not there.
    """
    left, right = (lanelet_map.ways[lanelet.refs(role)[0]].nodes for role in ("left", "right"))
    places = {node: lanelet_map.nodes[node][:2] for node in (*left, *right)}
    start, end, first, last = (places[node] for node in (left[0], left[-1], right[0], right[-1]))
    if math.dist(start, last) + math.dist(end, first) < math.dist(start, first) + math.dist(end, last):
        right = right[::-1]
    turned = _area([places[node] for node in (*left, *right[::-1])]) > 0.0
    return Bounds(left[::-1], right[::-1]) if turned else Bounds(left, right)


def _area(ring: list[tuple[float, ...]]) -> float:
    """Return the area of a ring, positive where it turns to the left."""
    x0, y0 = ring[0]
    near = [(x - x0, y - y0) for x, y in ring]  # large coordinates would cost digits
    return 0.5 * sum(a[0] * b[1] - b[0] * a[1] for a, b in pairwise([*near, near[0]]))


class Ids:
    """Gives each thing an id that depends on its own key alone, so that a change elsewhere leaves it as it was."""

    def __init__(self) -> None:
        self._taken: set[int] = set()

    def small(self, *key: object) -> int:
        """Return the id of a key, for a thing that tags name."""
        return self.new(*key, bits=SMALL_ID_BITS)

    def new(self, *key: object, bits: int = ID_BITS) -> int:
        """Return the id of a key; a second request for a key gets a second id."""
        text = "/".join(map(str, key))
        attempt = 0
        while True:
            digest = hashlib.blake2b(f"{text}#{attempt}".encode(), digest_size=8).digest()
            number = int.from_bytes(digest, "big") >> (64 - bits)
            if number and number not in self._taken:
                self._taken.add(number)
                return number
            attempt += 1
