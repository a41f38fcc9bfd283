"""The ways along lanelets: sampled from the lanes' edges, joined where lanes go on in each other, simplified.

Error: chords of the samples leave their curve by 2 mm at most (``_REFINED`` times finer than the road mesh), and
simplification leaves out points within ``TOLERANCE_M``; together at most ``STATED_ERROR_M``.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from linden.maps.opendrive.evaluate.pieces import F64, I64
from linden.maps.opendrive.evaluate.strips import sample, sections_before, sections_of
from linden.maps.opendrive.evaluate.tables import Tables
from linden_maps.lanelet2.model import Ids, LaneletMap, LaneletPoint, LaneletWay
from linden_maps.lanelet2.shared import one_line
from linden_maps.lanelet2.simplify import kept_points
from linden_maps.lanelet2.stretches import LaneletNetwork, Side, Stretch

TOLERANCE_M = 0.015
STATED_ERROR_M = 0.02
JOIN_M = 0.3
"""Ends of linked lanes further apart than this are not made one; the link is lost, and reported."""
_REFINED = 4
_SAME_M = 1e-4


class LaneEdge(NamedTuple):
    """How to evaluate one piece of a side: a lane, which of its edges, and where."""

    row: int
    outer: bool
    section: int  # over the whole map
    start_m: float
    end_m: float
    lifted: bool = True  # by the lane's own height above the road


class Laid(NamedTuple):
    """Sides as ways of a map."""

    way_of: dict[Side, int]
    nodes_of: dict[Side, tuple[int, ...]]  # in ascending s
    lost_links: tuple[tuple[int, int], ...]  # pairs of stretches with ends too far apart
    largest_gap_m: float  # that was closed
    shared: frozenset[Side]  # sides of two ways through a junction that became one


class _Samples(NamedTuple):
    """Where along each section to look: refined samples."""

    s_m: F64
    probe_m: F64
    first: I64  # (sections + 1,)


def _places(tables: Tables) -> _Samples:
    samples = sample(tables, sections_of(tables))
    count = int(sections_before(tables)[-1])
    goes_on = np.append(samples.section[1:] == samples.section[:-1], [False])[: len(samples.section)]
    steps = np.where(goes_on, _REFINED, 1)
    begin = np.cumsum(steps) - steps
    origin = np.repeat(np.arange(len(steps)), steps)
    share = (np.arange(len(origin)) - begin[origin]) / steps[origin]
    following = np.minimum(origin + 1, len(steps) - 1)
    s_m = samples.s_m[origin] + np.where(goes_on[origin], samples.s_m[following] - samples.s_m[origin], 0.0) * share
    per_section = np.bincount(samples.section[origin], minlength=count)
    return _Samples(s_m, samples.probe_m[origin], np.concatenate([[0], np.cumsum(per_section)]))


def edges_of_stretch(before: I64, stretch: Stretch) -> dict[Side, tuple[LaneEdge, ...]]:
    """Return how the two sides of a stretch are evaluated; ``before``: the sections before each road's."""
    on_left = (stretch.pieces[0].lane_id > 0) == stretch.forward
    outer, inner = (stretch.left, stretch.right) if on_left else (stretch.right, stretch.left)
    return {
        side: tuple(
            LaneEdge(p.row, is_outer, int(before[stretch.road]) + p.section, p.start_m, p.end_m) for p in stretch.pieces
        )
        for side, is_outer in ((outer, True), (inner, False))
    }


def evaluate(tables: Tables, sides: Iterable[tuple[LaneEdge, ...]]) -> list[F64]:
    """Return the points (N, 3) along each side in ascending s, no two at the same place."""
    places = _places(tables)
    rows, outer, lifted, s_m, probe_m, counts = [], [], [], [], [], []
    for edges in sides:
        count = 0
        for edge in edges:
            low, high = places.first[edge.section], places.first[edge.section + 1]
            inside = places.s_m[low:high]
            begin = low + int(np.searchsorted(inside, edge.start_m, side="right"))
            end = low + int(np.searchsorted(inside, edge.end_m, side="left"))
            s_m.append(np.concatenate([[edge.start_m], places.s_m[begin:end], [edge.end_m]]))
            probe_m.append(places.probe_m[np.clip(np.arange(begin - 1, end + 1), low, max(low, end - 1))])
            rows.append(np.full(end - begin + 2, edge.row))
            outer.append(np.full(end - begin + 2, edge.outer))
            lifted.append(np.full(end - begin + 2, edge.lifted))
            count += end - begin + 2
        counts.append(count)
    if not counts:
        return []
    points = _points(tables, *(np.concatenate(column) for column in (rows, outer, lifted, s_m, probe_m)))
    lines = np.split(points, np.cumsum(counts)[:-1])
    return [_without_repeats(line) for line in lines]


def _points(tables: Tables, row: I64, outer: F64, lifted: F64, s_m: F64, probe_m: F64) -> F64:
    road = tables.lanes["road"][row].astype(np.int64)
    pose = tables.curves.pose(road, s_m, probe_m)
    sides = tables.lane_sides(row, s_m, probe_m)
    t_m = np.where(outer, sides[1], sides[0])
    heights = (tables.heights_inner, tables.heights_outer)
    lift = np.where(outer, heights[1].value(row, s_m, probe_m), heights[0].value(row, s_m, probe_m))
    return np.stack(
        [
            pose.x_m - np.sin(pose.heading_rad) * t_m,
            pose.y_m + np.cos(pose.heading_rad) * t_m,
            tables.elevation.value(road, s_m, probe_m) + np.where(lifted, lift, 0.0),
        ],
        axis=1,
    )


def _without_repeats(line: F64) -> F64:
    apart = np.linalg.norm(np.diff(line, axis=0), axis=1) > _SAME_M
    keep = np.concatenate([[True], apart])
    keep[-1] = True
    if len(line) > 2 and not apart[-1]:
        keep[-2] = False
        keep[0] = True
    kept: F64 = line[keep]
    return kept


@dataclass(slots=True)
class _Joints:
    """Ends of sides that are one node: sets of ends with a mean position."""

    parent: list[int]

    def find(self, end: int) -> int:
        """Return the representative of an end."""
        while self.parent[end] != end:
            self.parent[end] = self.parent[self.parent[end]]
            end = self.parent[end]
        return end

    def join(self, one: int, other: int) -> None:
        """Make two ends one node."""
        low, high = sorted((self.find(one), self.find(other)))
        self.parent[high] = low


def lay(
    tables: Tables, network: LaneletNetwork, kerbs: dict[Side, tuple[LaneEdge, ...]], target: LaneletMap, ids: Ids
) -> Laid:
    """Add the ways of all stretches, and kerbs that bound none, to a map; without tags yet."""
    specs: dict[Side, tuple[LaneEdge, ...]] = {}
    forward: dict[Side, bool] = {}
    before = sections_before(tables)
    for stretch in network.stretches:
        for side, edges in edges_of_stretch(before, stretch).items():
            specs.setdefault(side, edges)
            forward[side] = forward.get(side, False) or stretch.forward
    for side, edges in kerbs.items():
        specs.setdefault(side, edges)
        forward.setdefault(side, True)
    lines = evaluate(tables, specs.values())
    index = {side: number for number, side in enumerate(specs)}
    joints, lost, gap_m = _join(network, index, lines)
    _close(joints, lines)
    same = one_line(network, index, lines, joints.find)
    kept = kept_points(
        np.concatenate(lines) if lines else np.empty((0, 3)),
        np.cumsum([0, *(len(line) for line in lines[:-1])]) if lines else np.empty(0, np.int64),
        TOLERANCE_M,
    )
    way_of: dict[Side, int] = {}
    nodes_of: dict[Side, tuple[int, ...]] = {}
    node_of: dict[int, int] = {}
    begin, sides = 0, list(index)
    for (side, number), line in zip(index.items(), lines, strict=True):
        key = side_key(tables, side)
        chosen = line[kept[begin : begin + len(line)]]
        begin += len(line)
        if number in same:
            first = sides[same[number].number]
            way_of[side], along = way_of[first], nodes_of[first]
            nodes_of[side] = along[::-1] if same[number].turned else along
            continue
        nodes = []
        for nth, point in enumerate(chosen.tolist()):
            end = 2 * number if nth == 0 else 2 * number + 1 if nth == len(chosen) - 1 else -1
            root = joints.find(end) if end >= 0 else -1
            if root >= 0 and root in node_of:
                nodes.append(node_of[root])
                continue
            node = ids.new("node", key, nth)
            target.nodes[node] = LaneletPoint(*point)
            if root >= 0:
                node_of[root] = node
            nodes.append(node)
        way = ids.new("way", key)
        target.ways[way] = LaneletWay(tuple(nodes if forward[side] else nodes[::-1]), {})
        way_of[side], nodes_of[side] = way, tuple(nodes)
    shared = frozenset(sides[each] for number, other in same.items() for each in (number, other.number))
    return Laid(way_of, nodes_of, lost, gap_m, shared)


def side_key(tables: Tables, side: Side) -> str:
    """Return what a side's id depends on."""
    pieces = ";".join(f"{section},{boundary},{start_m:.3f}" for section, boundary, start_m, _ in side.pieces)
    return f"{tables.roads[side.road].id}/{side.family}/{pieces}"


def _join(
    network: LaneletNetwork, index: dict[Side, int], lines: list[F64]
) -> tuple[_Joints, tuple[tuple[int, int], ...], float]:
    """Make one the ends of lanes that follow each other."""
    joints = _Joints(list(range(2 * len(lines))))
    lost, largest_m = [], 0.0
    for number, after in enumerate(network.successors):
        one = network.stretches[number]
        for following in after:
            other = network.stretches[following]
            pairs = [
                (2 * index[a] + one.forward, 2 * index[b] + (not other.forward))
                for a, b in ((one.left, other.left), (one.right, other.right))
            ]
            gap_m = max(float(np.linalg.norm(_end(lines, a) - _end(lines, b))) for a, b in pairs)
            if gap_m > JOIN_M:
                lost.append((number, following))
                continue
            largest_m = max(largest_m, gap_m)
            for a, b in pairs:
                joints.join(a, b)
    return joints, tuple(lost), largest_m


def _end(lines: list[F64], end: int) -> F64:
    place: F64 = lines[end // 2][-1 if end % 2 else 0]
    return place


def _close(joints: _Joints, lines: list[F64]) -> None:
    """Move ends that are one node to their mean."""
    members: dict[int, list[int]] = {}
    for end in range(len(joints.parent)):
        members.setdefault(joints.find(end), []).append(end)
    for ends in members.values():
        if len(ends) > 1:
            mean = np.mean([_end(lines, end) for end in ends], axis=0)
            for end in ends:
                lines[end // 2][-1 if end % 2 else 0] = mean
