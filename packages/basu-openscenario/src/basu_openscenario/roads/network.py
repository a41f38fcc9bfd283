"""A road network: roads, junctions, the next road along a lane, paths between places, the nearest road."""

from __future__ import annotations

import heapq
import itertools
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from basu_openscenario.roads.road import Road

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from basu_openscenario.roads.road import Link

DRIVING = frozenset(
    {"driving", "entry", "exit", "offRamp", "onRamp", "connectingRamp", "bidirectional", "mwyEntry", "mwyExit"}
)
"""Types of lanes that vehicles belong to."""
WALKING = DRIVING | {"sidewalk", "walking"}
"""Types of lanes that pedestrians belong to."""
SAMPLE_M = 2.0
"""Distance of the samples by which the nearest road is found, before it is refined."""
OTHER_ROAD_M = 3.0
"""How much nearer a road must be than the present one, where no lane connects them."""
NEXT_ROAD_M = 1e-3
"""How much nearer a road must be than the present one, where a lane of the present road leads into it."""


CANDIDATES_M = 60.0
"""Roads with a sample that is farther than the nearest one by less than this are compared exactly."""


class Samples(NamedTuple):
    """Points of the reference lines of all roads: (N, 3) of x, y and s in m, one road after the other."""

    roads: list[str]
    starts: NDArray[np.intp]
    """The index of the first point of each road."""
    points: NDArray[np.float64]
    tree: Any
    """A `scipy.spatial.cKDTree` of x and y."""


class Connection(NamedTuple):
    """A way through a junction: from a road onto a connecting road, lane by lane."""

    incoming: str
    connecting: str
    contact: str
    lanes: dict[int, int]


class Junction(NamedTuple):
    """A junction."""

    number: str
    connections: tuple[Connection, ...]


class SignalSpec(NamedTuple):
    """A signal beside a road."""

    number: str
    road: str
    s_m: float
    is_dynamic: bool


class Entry(NamedTuple):
    """Where a lane goes on: the next road, whether at its start, and the lane there; 0 where none continues."""

    road: Road
    at_start: bool
    lane: int


class Step(NamedTuple):
    """A road on a path: how it is entered and by which lane."""

    road: str
    at_start: bool
    lane: int


class PathFound(NamedTuple):
    """A path between two places: its signed length in m, and the roads that are entered on it."""

    length_m: float
    steps: tuple[Step, ...]


@dataclass(slots=True)
class Network:
    """A road network."""

    path: Path
    roads: dict[str, Road] = field(default_factory=dict)
    junctions: dict[str, Junction] = field(default_factory=dict)
    signals: dict[str, SignalSpec] = field(default_factory=dict)
    _samples: Samples | None = None

    def exits(self, road: Road, lane: int, *, at_end: bool) -> list[Entry]:
        """Return where a lane goes on at an end of its road, in the order of the file.

        Args:
            road: the road that is left.
            lane: its lane there.
            at_end: whether it is left at its end, otherwise at its start.
        """
        link = road.successor if at_end else road.predecessor
        if link is None:
            return []
        if link.kind == "junction":
            return self._through(road, lane, link)
        following = self.roads.get(link.number)
        if following is None:
            return []
        here = road.section(road.length_m if at_end else 0.0).lanes.get(lane)
        continued = None if here is None else here.successor if at_end else here.predecessor
        return [Entry(following, link.contact == "start", continued or 0)]

    def _through(self, road: Road, lane: int, link: Link) -> list[Entry]:
        """Return the connecting roads of a junction that a lane reaches."""
        junction = self.junctions.get(link.number)
        found = []
        for connection in () if junction is None else junction.connections:
            following = self.roads.get(connection.connecting)
            if connection.incoming == road.number and lane in connection.lanes and following is not None:
                found.append(Entry(following, connection.contact == "start", connection.lanes[lane]))
        return found

    def lane_through(self, road: Road, lane: int, s_from_m: float, s_to_m: float) -> int:
        """Return the lane of the same road that a lane becomes at another s; 0 where it ends."""
        sections = list(road.sections)
        start, stop = sections.index(road.section(s_from_m)), sections.index(road.section(s_to_m))
        step = 1 if stop > start else -1
        for index in range(start, stop, step):
            here = sections[index].lanes.get(lane)
            following = None if here is None else here.successor if step > 0 else here.predecessor
            if not following:
                return 0
            lane = following
        return lane

    def paths(self, road: Road, lane: int, s_m: float, *, forwards: bool, longest_m: float) -> Iterator[PathFound]:
        """Yield the roads that can be reached along lanes, nearest first, with the distance to the point of entry.

        The first one is the road itself, with a negative distance to its start where ``forwards``.
        """
        count = itertools.count()
        left_m = road.length_m - s_m if forwards else s_m
        edge_s = road.length_m if forwards else 0.0
        lane_there = self.lane_through(road, lane, s_m, edge_s)
        queue: list[tuple[float, int, Road, int, bool, tuple[Step, ...]]] = []
        heapq.heappush(queue, (left_m, next(count), road, lane_there, forwards, ()))
        seen: set[tuple[str, bool]] = set()
        while queue:
            reached_m, _, here, lane_here, at_end, steps = heapq.heappop(queue)
            if reached_m > longest_m:
                return
            for entry in self.exits(here, lane_here, at_end=at_end) if lane_here else ():
                key = (entry.road.number, entry.at_start)
                if key in seen:
                    continue
                seen.add(key)
                further = (*steps, Step(entry.road.number, entry.at_start, entry.lane))
                yield PathFound(reached_m, further)
                far_s = entry.road.length_m if entry.at_start else 0.0
                near_s = 0.0 if entry.at_start else entry.road.length_m
                onwards = self.lane_through(entry.road, entry.lane, near_s, far_s) if entry.lane else 0
                item = (reached_m + entry.road.length_m, next(count), entry.road, onwards, entry.at_start, further)
                heapq.heappush(queue, item)

    def nearest(
        self, x_m: float, y_m: float, z_m: float | None = None, near: tuple[str, float] | None = None, lane: int = 0
    ) -> tuple[Road, float, float]:
        """Return the road at a point of the world, s along it and t to its left, in m.

        Args:
            x_m: of the point.
            y_m: of the point.
            z_m: of the point; None: roads of all heights count alike.
            near: the present road and s, which is kept where several roads overlap.
            lane: the present lane.
        """
        numbers, starts, samples, tree = self._sampled()
        reach_m = float(tree.query((x_m, y_m))[0]) + CANDIDATES_M
        close = np.array(tree.query_ball_point((x_m, y_m), reach_m), dtype=np.intp)
        best: tuple[float, Road, float, float] | None = None
        gaps = np.hypot(samples[close, 0] - x_m, samples[close, 1] - y_m)
        candidates = _nearest_of_each(np.searchsorted(starts, close, side="right") - 1, gaps, close)
        if near is not None:
            candidates.sort(key=lambda candidate: numbers[candidate[0]] != near[0])  # the present road first
        for which, index in candidates:
            road = self.roads[numbers[which]]
            added_m = 0.0
            if near is not None and road.number != near[0]:
                if best is not None and best[0] <= NEXT_ROAD_M:
                    break  # each further road has a larger score
                added_m = NEXT_ROAD_M if self._follows(near[0], lane, road) else OTHER_ROAD_M
                if best is not None and best[0] <= added_m:
                    continue
            score, s_m, t_m = self._distance(road, float(samples[index, 2]), x_m, y_m, z_m)
            if best is None or score + added_m < best[0] - 1e-9:
                best = score + added_m, road, s_m, t_m
        assert best is not None, "a network has a road"
        return best[1:]

    def _follows(self, number: str, lane: int, road: Road) -> bool:
        """Return whether a lane of a road goes on into another road."""
        here = self.roads[number]
        entries = [*self.exits(here, lane, at_end=True), *self.exits(here, lane, at_end=False)]
        return any(entry.road is road for entry in entries)

    def _distance(
        self, road: Road, s_m: float, x_m: float, y_m: float, z_m: float | None
    ) -> tuple[float, float, float]:
        """Return how far a point is from a road's surface, with s and t of its foot, from a first guess of s."""
        over_m = 0.0
        for _ in range(12):
            line = road.line(s_m)
            dx, dy = x_m - line.x_m, y_m - line.y_m
            along = dx * math.cos(line.h_rad) + dy * math.sin(line.h_rad)
            plan_m = -dx * math.sin(line.h_rad) + dy * math.cos(line.h_rad)
            t_m, shift_m = road.from_plan(s_m, plan_m)
            along -= shift_m
            stretch = max(1.0 - line.curvature_per_m * plan_m, 0.2)
            wanted = s_m + along / stretch
            held = min(max(wanted, 0.0), road.length_m)
            over_m = abs(wanted - held)
            moved, s_m = abs(held - s_m), held
            if moved < 1e-9:
                break
        right, left = road.section(s_m).edges_m(s_m)
        from_centre = t_m - road.lane_offset.value(s_m)
        beside_m = max(from_centre - left, right - from_centre, 0.0)
        score = math.hypot(beside_m, over_m)
        if z_m is not None:
            height_m = abs(z_m - road.point(s_m, t_m).z_m)
            score += height_m if height_m > 2.0 else 0.0
        return score, s_m, t_m

    def samples_within(self, x_m: float, y_m: float, radius_m: float) -> list[int]:
        """Return the samples of all reference lines within a radius, `SAMPLE_M` apart, in the order of the file."""
        return sorted(self._sampled().tree.query_ball_point((x_m, y_m), radius_m))

    def sample(self, index: int) -> tuple[Road, float]:
        """Return road and s in m of one of the samples."""
        numbers, starts, points, _ = self._sampled()
        return self.roads[numbers[int(np.searchsorted(starts, index, side="right")) - 1]], float(points[index, 2])

    def _sampled(self) -> Samples:
        """Return points of all roads' lines, with a tree that finds the points near another."""
        if self._samples is None:
            numbers, starts = list(self.roads), []
            rows: list[tuple[float, float, float]] = []
            for number in numbers:
                road = self.roads[number]
                starts.append(len(rows))
                steps = max(2, int(road.length_m / SAMPLE_M) + 1)
                for s_m in np.linspace(0.0, road.length_m, steps):
                    line = road.line(float(s_m))
                    rows.append((line.x_m, line.y_m, float(s_m)))
            points = np.array(rows, dtype=np.float64)
            self._samples = Samples(numbers, np.array(starts), points, cKDTree(points[:, :2]))
        return self._samples


def _nearest_of_each(
    roads: NDArray[np.intp], gaps_m: NDArray[np.float64], points: NDArray[np.intp]
) -> list[tuple[int, int]]:
    """Return the index of each road with the nearest of its points, by distance."""
    order = np.argsort(gaps_m, kind="stable")
    _, first = np.unique(roads[order], return_index=True)
    return [(int(roads[order[one]]), int(points[order[one]])) for one in sorted(first)]
