"""Rows of lanes: the middles of road lanelets in steps of about a metre, with how they lead into each other."""

import math
from collections import defaultdict
from typing import NamedTuple

import numpy as np

from linden.maps.opendrive.evaluate.pieces import F64
from linden_maps.lanelet2.model import Bounds, LaneletMap, bounds_of
from linden_maps.polylines import lengths, resampled

STEP_M = 1.0
"""Length of a row, as in towns of Autoware's own maps."""
MOST_LINKS = 4
"""Predecessors and successors that a row has room for."""
_BENT_PER_M = 1.0 / 300.0
"""From this curvature on a piece is not straight; bounds are known to 2 cm, which hides less over 8 m."""
_SHARP_PER_M = 0.02
_WIDE_M, _NARROW_M = 4.0, 2.0


class Course(NamedTuple):
    """A road lanelet as a row of places; all (N,) or (N, 3), from its start to its end."""

    lanelet: int
    middle: F64
    left_m: F64  # from the middle to the left bound
    right_m: F64
    cant_percent: F64  # positive where the left side lies higher
    bounds: Bounds

    @property
    def rows(self) -> int:
        """How many rows of lane.csv it makes."""
        return len(self.middle) - 1


class CourseGraph(NamedTuple):
    """Which courses lead into which, and which lie beside each other; by place in the list of courses."""

    successors: tuple[tuple[int, ...], ...]
    predecessors: tuple[tuple[int, ...], ...]
    number: tuple[int, ...]  # of the lane from the left, from 1
    lane_count: tuple[int, ...]  # of lanes beside each other
    section: tuple[int, ...]  # the same for lanes beside each other, from 1
    changes: tuple[bool, ...]  # whether the lane may be left to either side
    lost: int  # links beyond the four that a row has room for


def courses_of(lanelet_map: LaneletMap) -> list[Course]:
    """Return the courses of all road lanelets, in the order of the map."""
    found = []
    for number, relation in lanelet_map.lanelets("road"):
        bounds = bounds_of(lanelet_map, relation)
        left, right = (np.array([lanelet_map.nodes[node][:3] for node in side]) for side in bounds)
        length_m = (lengths(left)[-1] + lengths(right)[-1]) / 2.0
        count = max(2, round(length_m / STEP_M) + 1)
        left, right = resampled(left, count), resampled(right, count)
        middle = (left + right) / 2.0
        left_m = np.hypot(*(left - middle)[:, :2].T)
        right_m = np.hypot(*(right - middle)[:, :2].T)
        cant = 100.0 * (left - right)[:, 2] / np.maximum(left_m + right_m, 1e-3)
        found.append(Course(number, middle, left_m, right_m, cant, bounds))
    return found


def graph_of(lanelet_map: LaneletMap, courses: list[Course]) -> CourseGraph:
    """Join courses as Lanelet2 does: one follows another where both sides go on at the same nodes."""
    starts: dict[tuple[int, int], list[int]] = defaultdict(list)
    for nth, course in enumerate(courses):
        starts[course.bounds.left[0], course.bounds.right[0]].append(nth)
    successors, lost = [], 0
    predecessors: list[list[int]] = [[] for _ in courses]
    for nth, course in enumerate(courses):
        after = starts.get((course.bounds.left[-1], course.bounds.right[-1]), [])
        ranked = sorted(after, key=lambda other: (abs(_turn(course, courses[other])), other))
        kept = [other for other in ranked if other != nth and len(predecessors[other]) < MOST_LINKS][:MOST_LINKS]
        lost += len([other for other in ranked if other != nth]) - len(kept)
        successors.append(tuple(kept))
        for other in kept:
            predecessors[other].append(nth)
    left_of, right_of, changes = _beside(lanelet_map, courses)
    number, count, section = _numbered(len(courses), left_of, right_of)
    return CourseGraph(tuple(successors), tuple(map(tuple, predecessors)), number, count, section, changes, lost)


def _beside(lanelet_map: LaneletMap, courses: list[Course]) -> tuple[dict[int, int], dict[int, int], tuple[bool, ...]]:
    """Return the courses to the left and right of each that go the same way, and which may be left for these."""
    lefts = {course.bounds.left: nth for nth, course in enumerate(courses)}
    rights = {course.bounds.right: nth for nth, course in enumerate(courses)}
    left_of = {nth: rights[course.bounds.left] for nth, course in enumerate(courses) if course.bounds.left in rights}
    right_of = {nth: lefts[course.bounds.right] for nth, course in enumerate(courses) if course.bounds.right in lefts}

    def open_to(nth: int, role: str, beside: dict[int, int]) -> bool:
        way = lanelet_map.relations[courses[nth].lanelet].refs(role)[0]
        return nth in beside and lanelet_map.ways[way].tags.get("lane_change") == "yes"

    changes = tuple(open_to(nth, "left", left_of) or open_to(nth, "right", right_of) for nth in range(len(courses)))
    return left_of, right_of, changes


def _numbered(
    total: int, left_of: dict[int, int], right_of: dict[int, int]
) -> tuple[tuple[int, ...], tuple[int, ...], tuple[int, ...]]:
    """Return each course's lane number from the left, how many lanes there are, and the section they share."""
    number, count, section = [0] * total, [0] * total, [0] * total
    sections = 0
    for nth in range(total):
        if section[nth]:
            continue
        lanes = [nth]
        while lanes[0] in left_of and left_of[lanes[0]] not in lanes:
            lanes.insert(0, left_of[lanes[0]])
        while lanes[-1] in right_of and right_of[lanes[-1]] not in lanes:
            lanes.append(right_of[lanes[-1]])
        sections += 1
        for at, lane in enumerate(lanes, start=1):
            number[lane], count[lane], section[lane] = at, len(lanes), sections
    return tuple(number), tuple(count), tuple(section)


def headings(course: Course) -> F64:
    """Return the direction of each row, rad clockwise from north."""
    step = np.diff(course.middle, axis=0)
    clockwise: F64 = np.arctan2(step[:, 0], step[:, 1])
    return clockwise


def curvatures(course: Course) -> F64:
    """Return the curvature at the start of each row in 1/m, positive to the right (clockwise); 0 where straight."""
    wide, narrow = (_curvature(course.middle, reach) for reach in (_WIDE_M, _NARROW_M))
    bent = np.where(np.abs(narrow) > _SHARP_PER_M, narrow, wide)
    curvature: F64 = np.where(np.abs(bent) > _BENT_PER_M, bent, 0.0)[:-1]
    return curvature


def _curvature(line: F64, reach_m: float) -> F64:
    """Return the curvature of the circle through each point and those some way before and behind it (clockwise)."""
    count = len(line)
    steps = max(1, round(reach_m / max(lengths(line)[-1] / (count - 1), 1e-6)))
    if count < 3:
        return np.zeros(count)
    steps = min(steps, (count - 1) // 2)
    at = np.clip(np.arange(count), steps, count - 1 - steps)
    a, b, c = (line[at + shift, :2] for shift in (-steps, 0, steps))
    cross = (b - a)[:, 0] * (c - b)[:, 1] - (b - a)[:, 1] * (c - b)[:, 0]
    sizes = np.linalg.norm(b - a, axis=1) * np.linalg.norm(c - b, axis=1) * np.linalg.norm(c - a, axis=1)
    curvature: F64 = -2.0 * cross / np.maximum(sizes, 1e-9)
    return curvature


def _turn(course: Course, following: Course) -> float:
    """Return how far a course turns, rad clockwise, from the end of the one before it."""
    return math.remainder(headings(following)[-1] - headings(course)[-1], math.tau)


def junction_flag(courses: list[Course], graph: CourseGraph, nth: int, *, first: bool, last: bool) -> int:
    """Return JCT of a row: 1, 2 where it branches to the left, right; 3, 4 where it merges from there; 5 for both.

    The first successor (FLID) is the straightest; the flag says where the next one goes. Predecessors likewise.
    """
    after = graph.successors[nth] if last else ()
    before = graph.predecessors[nth] if first else ()
    if len(after) > 1 and len(before) > 1:
        return 5
    if len(after) > 1:
        main, branch = (_turn(courses[nth], courses[other]) for other in after[:2])
        return 2 if branch > main else 1
    if len(before) > 1:
        own = headings(courses[nth])[0]
        main, branch = (math.remainder(own - headings(courses[other])[0], math.tau) for other in before[:2])
        return 3 if branch > main else 4
    return 0
