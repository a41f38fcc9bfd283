"""The streets of an extract between the places where they meet: cut at junctions, joined where nothing changes.

Small roundabouts are mapped as rings of ways. A ring that is too small for roads of its own becomes one place, and the
streets that touch it lead to its middle.
"""

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

from pyproj import Proj
from shapely import LineString

from linden_maps.openstreetmap.extract import Extract, OsmWay
from linden_maps.openstreetmap.tags import Carriageway, carriageway, is_street
from linden_maps.streets.geojson import refuse_too_wide
from linden_maps.streets.network import ROUNDABOUT_SETBACK_M

SMALL_RING_M = 14.0
"""Radius up to which a ring becomes a mini-roundabout; FHWA's have inscribed circles of 15 to 27 m in diameter."""

STRAIGHT_TO_RING_M = ROUNDABOUT_SETBACK_M + 8.0
TOLERANCE_M = 0.4
"""By which a simplified centre-line leaves the mapped one: less than mappers' own accuracy from aerial images."""

Point = tuple[float, float]


class Segment(NamedTuple):
    """A street between two places: nodes in the direction of ``across``, of one way or of several in a row."""

    id: str
    ways: tuple[int, ...]
    nodes: tuple[int, ...]
    across: Carriageway

    @property
    def ends(self) -> tuple[int, int]:
        """The nodes at both ends."""
        return self.nodes[0], self.nodes[-1]


class SegmentGraph(NamedTuple):
    """Segments, where nodes lie (m, x east, y north, and degrees), and which nodes stand for a small ring.

    ``circulating``: ids of segments of larger rings. ``repeated``: how many pieces of street lay on another one.
    """

    segments: tuple[Segment, ...]
    metres: Mapping[int, Point]
    degrees: Mapping[int, Point]
    rings: frozenset[int]
    circulating: frozenset[str]
    repeated: int = 0

    def at(self, node: int) -> list[Segment]:
        """Return the segments that end at a node; a loop twice."""
        return [segment for segment in self.segments for end in segment.ends if end == node]


class _Places:
    """Nodes in degrees and in metres about the extract's middle."""

    def __init__(self, extract: Extract, used: Iterable[int]) -> None:
        self.degrees = {node: (extract.nodes[node][0], extract.nodes[node][1]) for node in used}
        longitudes, latitudes = zip(*self.degrees.values(), strict=True)
        middle = (min(longitudes) + max(longitudes)) / 2, (min(latitudes) + max(latitudes)) / 2
        self.origin = round(middle[0], 6), round(middle[1], 6)
        self._project = Proj(
            proj="tmerc", lon_0=self.origin[0], lat_0=self.origin[1], k=1, x_0=0, y_0=0, datum="WGS84", units="m"
        )
        self.metres: dict[int, Point] = {
            node: self._project(*degrees) for node, degrees in sorted(self.degrees.items())
        }

    def add(self, node: int, at_m: Point) -> None:
        """Add a node that the extract does not have."""
        longitude, latitude = self._project(*at_m, inverse=True)
        self.metres[node], self.degrees[node] = at_m, (round(longitude, 8), round(latitude, 8))


def graph_of(extract: Extract, *, metric: bool) -> tuple[SegmentGraph, tuple[float, float]]:
    """Return the graph of an extract's streets, and longitude and latitude of the origin of its metres.

    The extract has one street at least. ``metric``: whether guessed limits are in km/h.
    """
    ways = [way for way in extract.ways.values() if len(way.nodes) > 1 and is_street(way.tags)]
    places = _Places(extract, sorted({node for way in ways for node in way.nodes}))
    refuse_too_wide((f"way {way.id}", (places.metres[node] for node in way.nodes)) for way in ways)
    rings, moved = _small_rings(ways, places)
    lines = [(way, nodes) for way in ways for nodes in _outside_of_rings(way.nodes, moved, places)]
    joints = _joints([nodes for _, nodes in lines])
    pieces = [
        Segment(str(way.id), (way.id,), part, carriageway(way.tags, metric=metric))
        for way, nodes in lines
        for part in _cut(nodes, joints)
    ]
    different = _different(pieces)
    segments = _named(tuple(_simplified(segment, places) for segment in _joined(different)))
    circulating = frozenset(
        segment.id
        for segment in segments
        if any(extract.ways[way].tags.get("junction") in {"roundabout", "circular"} for way in segment.ways)
    )
    repeated = len(pieces) - len(different)
    return SegmentGraph(segments, places.metres, places.degrees, frozenset(rings), circulating, repeated), places.origin


def _small_rings(ways: Sequence[OsmWay], places: _Places) -> tuple[list[int], dict[int, int]]:
    """Return a new node for each small ring, and for each node of such a ring the new one."""
    of_rings = [way for way in ways if way.tags.get("junction") in {"roundabout", "circular"}]
    groups: list[set[int]] = []
    for way in of_rings:
        touching = [group for group in groups if not group.isdisjoint(way.nodes)]
        groups = [group for group in groups if group.isdisjoint(way.nodes)]
        groups.append(set(way.nodes).union(*touching))
    rings: list[int] = []
    moved: dict[int, int] = {}
    for group in sorted(groups, key=min):
        points = [places.metres[node] for node in sorted(group)]
        low, high = ([extreme(point[axis] for point in points) for axis in (0, 1)] for extreme in (min, max))
        centre = (low[0] + high[0]) / 2, (low[1] + high[1]) / 2
        if len(group) < 4 or max(math.dist(centre, point) for point in points) > SMALL_RING_M:
            continue
        number = -1 - len(rings)
        rings.append(number)
        places.add(number, centre)
        moved.update(dict.fromkeys(group, number))
    return rings, moved


def _outside_of_rings(nodes: Sequence[int], moved: Mapping[int, int], places: _Places) -> list[tuple[int, ...]]:
    """Return the runs of a way outside of small rings; a run that touches one leads straight to its middle."""
    runs: list[list[int]] = [[]]
    for node in nodes:
        ring = moved.get(node)
        if ring is None:
            runs[-1].append(node)
        elif runs[-1] and runs[-1] != [ring]:
            runs[-1].append(ring)
            runs.append([ring])
        else:
            runs[-1] = [ring]
    found = []
    for run in runs:
        for is_last in (False, True):
            run[:] = _straightened(run[::-1] if is_last else run, places)
            run[:] = run[::-1] if is_last else run
        if len(run) > 1:
            found.append(tuple(run))
    return found


def _straightened(run: list[int], places: _Places) -> list[int]:
    """Return a run without the nodes that are near the ring at its beginning, if it begins at one."""
    if not run or run[0] >= 0:
        return run
    centre = places.metres[run[0]]
    near = 1
    while near < len(run) - 1 and math.dist(places.metres[run[near]], centre) < STRAIGHT_TO_RING_M:
        near += 1
    return [run[0], *run[near:]]


def _joints(lines: Iterable[tuple[int, ...]]) -> frozenset[int]:
    """Return the nodes where more or fewer than two pieces of street end."""
    count: dict[int, int] = defaultdict(int)
    for nodes in lines:
        for node in nodes:
            count[node] += 2
        count[nodes[0]] -= 1
        count[nodes[-1]] -= 1
    return frozenset(node for node, ends in count.items() if ends != 2)


def _cut(nodes: tuple[int, ...], joints: frozenset[int]) -> list[tuple[int, ...]]:
    """Return the parts of a line between joints; a part that ends where it begins is halved."""
    cuts = [0, *(place for place in range(1, len(nodes) - 1) if nodes[place] in joints), len(nodes) - 1]
    parts = []
    for first, last in pairwise(cuts):
        part = nodes[first : last + 1]
        if part[0] == part[-1]:
            half = len(part) // 2
            parts += [part[: half + 1], part[half:]] if len(part) > 3 else []
        else:
            parts.append(part)
    return parts


def _different(pieces: list[Segment]) -> list[Segment]:
    """Return the pieces without repeats: pieces through the nodes of an earlier one, as of a way mapped twice."""
    found: dict[tuple[int, ...], Segment] = {}
    for piece in pieces:
        found.setdefault(min(piece.nodes, piece.nodes[::-1]), piece)
    return list(found.values())


def mirrored(across: Carriageway) -> Carriageway:
    """Return the same street seen in the other direction."""
    return across._replace(
        forward=across.backward,
        backward=across.forward,
        parking=across.parking[::-1],
        sidewalk=across.sidewalk[::-1],
        cycling=across.cycling[::-1],
    )


def _joined(pieces: list[Segment]) -> list[Segment]:
    """Return the pieces, with those joined that go on in each other where no third one ends and nothing changes."""
    ending: dict[int, list[int]] = defaultdict(list)
    alive: dict[int, Segment] = dict(enumerate(pieces))
    for number, piece in alive.items():
        for end in piece.ends:
            ending[end].append(number)
    for node in sorted(ending):
        if len(ending[node]) != 2 or ending[node][0] == ending[node][1]:
            continue
        one, other = sorted(ending[node])
        before, after = alive[one], alive[other]
        if before.nodes[-1] != node:
            before = before._replace(nodes=before.nodes[::-1], across=mirrored(before.across))
        if after.nodes[0] != node:
            after = after._replace(nodes=after.nodes[::-1], across=mirrored(after.across))
        if before.across != after.across or before.nodes[0] == after.nodes[-1]:
            continue
        ways = before.ways + tuple(way for way in after.ways if way not in before.ways)
        alive[one] = before._replace(nodes=before.nodes + after.nodes[1:], ways=ways)
        del alive[other]
        far = after.nodes[-1]
        ending[far] = [one if number == other else number for number in ending[far]]
        ending[node] = []
    return list(alive.values())


def _simplified(segment: Segment, places: _Places) -> Segment:
    """Return the segment without nodes that lie within ``TOLERANCE_M`` of the line through the others."""
    line = LineString([places.metres[node] for node in segment.nodes])
    kept = set(line.simplify(TOLERANCE_M, preserve_topology=False).coords)
    nodes = segment.nodes
    inner = [node for node in nodes[1:-1] if places.metres[node] in kept]
    return segment._replace(nodes=(nodes[0], *inner, nodes[-1]))


def _named(segments: tuple[Segment, ...]) -> tuple[Segment, ...]:
    """Return the segments with ids of their own: the way's, and a number where a way has several."""
    count: dict[str, int] = defaultdict(int)
    for segment in segments:
        count[segment.id] += 1
    place: dict[str, int] = defaultdict(int)
    found = []
    for segment in segments:
        place[segment.id] += 1
        suffix = f".{place[segment.id]}" if count[segment.id] > 1 else ""
        found.append(segment._replace(id=f"{segment.id}{suffix}"))
    return tuple(found)
