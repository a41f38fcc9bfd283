"""Lanelets to make from an OpenDRIVE map, one per lane of a section, also in junctions, and their successors.

A section is cut further where a marking or a speed limit changes, for Lanelet2 has one of each along a bound.
"""

from collections import defaultdict
from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from linden.maps.opendrive.evaluate.tables import Tables, tables_of
from linden.maps.opendrive.links import is_forward, lane_links
from linden.maps.opendrive.model import Lane, LaneSection, OpenDrive, Road
from linden.protocol.values.enums import LaneType

ROAD, SHOULDER, BICYCLE, WALKWAY = "road", "road_shoulder", "bicycle_lane", "walkway"
DRIVABLE = (
    LaneType.DRIVING | LaneType.BIDIRECTIONAL | LaneType.ENTRY | LaneType.EXIT | LaneType.OFF_RAMP | LaneType.ON_RAMP
)
_SUBTYPES = (
    (DRIVABLE, ROAD),
    (LaneType.SHOULDER | LaneType.STOP | LaneType.PARKING, SHOULDER),
    (LaneType.BIKING, BICYCLE),
    (LaneType.SIDEWALK, WALKWAY),
)

SHORTEST_CUT_M = 2.0
"""A marking that changes nearer than this to a section's end, or to another change, makes no lanelet of its own."""
ALONE = "shoulders beside no lane"
NARROWEST_M = 0.3
"""A lane that is nowhere wider makes no lanelet."""
SHORTEST_M = 0.05
"""A stretch shorter than this makes no lanelet; what it joins is joined without it."""


_PLACES = 9
"""Where along a piece its width is looked at."""


class LanePiece(NamedTuple):
    """A lane of one section, from ``start_m`` to ``end_m`` along its road."""

    section: int
    lane_id: int
    start_m: float
    end_m: float
    row: int  # of Tables.lanes


class Side(NamedTuple):
    """An edge of lanes, piece by piece: (section, boundary, from, to). Boundary k is the outer edge of lane k."""

    road: int  # index
    family: str  # vehicles and walkways have bounds of their own
    pieces: tuple[tuple[int, int, float, float], ...]


class Stretch(NamedTuple):
    """A lanelet to be."""

    road: int  # index
    subtype: str
    pieces: tuple[LanePiece, ...]  # in the order of s
    forward: bool  # whether its traffic goes towards greater s
    junction_id: int
    left: Side
    right: Side

    @property
    def length_m(self) -> float:
        """Length along the reference line."""
        return sum(piece.end_m - piece.start_m for piece in self.pieces)


class LaneletNetwork(NamedTuple):
    """All lanelets to be, and which road lanelets follow which."""

    stretches: tuple[Stretch, ...]
    successors: tuple[tuple[int, ...], ...]
    left_out: dict[str, int]  # what made no lanelet: reason to count


def subtype_of(kind: LaneType) -> str | None:
    """Return the lanelet subtype of a lane type, None where such lanes make no lanelet."""
    return next((subtype for types, subtype in _SUBTYPES if kind & types), None)


def intersections(network: LaneletNetwork) -> set[int]:
    """Return the junctions that traffic enters from two roads or more; ways of one road alone do not meet."""
    roads: dict[int, set[tuple[int, bool]]] = defaultdict(set)
    for before, after in zip(network.stretches, network.successors, strict=True):
        for following in after:
            junction = network.stretches[following].junction_id
            if junction >= 0 and before.junction_id != junction and before.subtype == ROAD:
                roads[junction].add((before.road, before.forward))
    return {junction for junction, entered in roads.items() if len(entered) > 1}


def network_of(opendrive: OpenDrive) -> LaneletNetwork:
    """Return what lanelets a map makes."""
    tables = tables_of(opendrive)
    left_out: dict[str, int] = {}
    found = [stretch for index, road in enumerate(tables.roads) for stretch in _of_road(tables, index, road)]
    refusals = [_refused(*pair) for pair in zip(found, _widths_m(tables, found), strict=True)]
    for reason in refusals:
        if reason is not None:
            left_out[reason] = left_out.get(reason, 0) + 1
    for nth in _alone(found, refusals):
        refusals[nth] = ALONE
        left_out[ALONE] = left_out.get(ALONE, 0) + 1
    chosen = [nth for nth, stretch in enumerate(found) if refusals[nth] is None or stretch.subtype == ROAD]
    return _joined(opendrive, tables, [(found[nth], refusals[nth] is None) for nth in chosen], left_out)


def _alone(found: list[Stretch], refusals: list[str | None]) -> list[int]:
    """Return the shoulders that share no side with a lanelet of their direction; Autoware wants none (vm-01-16)."""
    users: dict[Side, list[int]] = defaultdict(list)
    for nth, stretch in enumerate(found):
        if refusals[nth] is None:
            users[stretch.left].append(nth)
            users[stretch.right].append(nth)
    return [
        nth
        for nth, stretch in enumerate(found)
        if stretch.subtype == SHOULDER
        and refusals[nth] is None
        and not any(
            other != nth and found[other].forward == stretch.forward
            for side in (stretch.left, stretch.right)
            for other in users[side]
        )
    ]


def _refused(stretch: Stretch, width_m: float) -> str | None:
    """Return why a stretch makes no lanelet, None where it makes one."""
    if stretch.subtype == SHOULDER and stretch.junction_id >= 0:
        return "shoulders inside junctions"
    if stretch.length_m < SHORTEST_M:
        return f"{stretch.subtype} lanes shorter than {SHORTEST_M:g} m"
    return f"{stretch.subtype} lanes narrower than {NARROWEST_M:g} m" if width_m < NARROWEST_M else None


def _widths_m(tables: Tables, stretches: list[Stretch]) -> list[float]:
    """Return the greatest width of each stretch, of nine places in each piece."""
    if not stretches:
        return []
    pieces = [piece for stretch in stretches for piece in stretch.pieces]
    row = np.repeat([piece.row for piece in pieces], _PLACES)
    start_m, end_m = (np.array([getattr(piece, name) for piece in pieces]) for name in ("start_m", "end_m"))
    s_m = (start_m[:, None] + (end_m - start_m)[:, None] * np.linspace(0.0, 1.0, _PLACES)).ravel()
    inner, outer = tables.lane_sides(row, s_m, np.repeat((start_m + end_m) / 2.0, _PLACES))
    first = np.cumsum([0, *(len(stretch.pieces) for stretch in stretches[:-1])])
    widths: list[float] = np.maximum.reduceat(np.abs(outer - inner), _PLACES * first).tolist()
    return widths


def _joined(
    opendrive: OpenDrive, tables: Tables, chosen: list[tuple[Stretch, bool]], left_out: dict[str, int]
) -> LaneletNetwork:
    """Link the stretches of roads; links run through what is too short or too narrow to be a lanelet (False)."""
    found = [stretch for stretch, _ in chosen]
    entry: dict[int, int] = {}
    for number, stretch in enumerate(found):
        if stretch.subtype == ROAD:
            first = stretch.pieces[0 if stretch.forward else -1]
            begins = first.start_m <= tables.lanes["start_m"][first.row]
            ends = first.end_m >= tables.lanes["end_m"][first.row]
            if begins if stretch.forward else ends:
                entry[first.row] = number
    links = lane_links(opendrive)
    after: list[tuple[int, ...]] = []
    for stretch in found:
        last = stretch.pieces[-1 if stretch.forward else 0]
        same = [] if stretch.subtype != ROAD else _next_cut(found, stretch, last, after)
        rows = links.successors[last.row] if stretch.subtype == ROAD and not same else ()
        after.append(tuple(same) or tuple(dict.fromkeys(entry[row] for row in rows if row in entry)))
    kept = [number for number, (_, is_lanelet) in enumerate(chosen) if is_lanelet]
    place = {number: new for new, number in enumerate(kept)}
    successors = tuple(tuple(place[far] for far in _through(number, after, place)) for number in kept)
    return LaneletNetwork(tuple(found[number] for number in kept), successors, left_out)


def _next_cut(found: list[Stretch], stretch: Stretch, last: LanePiece, after: list[tuple[int, ...]]) -> list[int]:
    """Return the stretch that goes on in the same lane of the same section."""
    number = len(after)
    for other in (number + 1, number - 1):
        if 0 <= other < len(found) and found[other].subtype == ROAD and found[other].road == stretch.road:
            first = found[other].pieces[0 if stretch.forward else -1]
            touches = first.start_m == last.end_m if stretch.forward else first.end_m == last.start_m
            if first.row == last.row and touches:
                return [other]
    return []


def _through(number: int, after: list[tuple[int, ...]], place: dict[int, int]) -> list[int]:
    """Return the next stretches that make lanelets."""
    reached: list[int] = []
    waiting, seen = list(after[number]), {number}
    while waiting:
        at = waiting.pop(0)
        if at in seen:
            continue
        seen.add(at)
        if at in place:
            reached.append(at)
        else:
            waiting += after[at]
    return reached


def _of_road(tables: Tables, index: int, road: Road) -> Iterator[Stretch]:
    taken: set[tuple[int, int]] = set()
    for number, section in enumerate(road.sections):
        cuts = _cuts(road, section) if not road.is_in_junction else [section.s_m, section.end_m]
        for lane in section.lanes:
            subtype = subtype_of(lane.type) if lane.id else None
            if subtype is None or (number, lane.id) in taken:
                continue
            chain = _chain(road, number, lane) if road.is_in_junction and subtype == ROAD else [(number, lane.id)]
            taken.update(chain)
            spans = pairwise(cuts) if len(chain) == 1 else [(section.s_m, section.end_m)]
            for start_m, end_m in spans:
                pieces = [
                    LanePiece(
                        at,
                        lane_id,
                        start_m if len(chain) == 1 else road.sections[at].s_m,
                        end_m if len(chain) == 1 else road.sections[at].end_m,
                        tables.lane_row[index, at, lane_id],
                    )
                    for at, lane_id in chain
                ]
                yield _stretch(index, road, subtype, tuple(pieces))


def _stretch(index: int, road: Road, subtype: str, pieces: tuple[LanePiece, ...]) -> Stretch:
    lane_id = pieces[0].lane_id
    forward = is_forward(road, lane_id)
    if subtype == SHOULDER and _is_across_the_axis(road.sections[pieces[0].section], lane_id):
        forward = not forward
    family = "walkway" if subtype == WALKWAY else "road"
    inward = -1 if lane_id > 0 else 1
    inner, outer = (
        Side(index, family, tuple((p.section, p.lane_id + step, p.start_m, p.end_m) for p in pieces))
        for step in (inward, 0)
    )
    on_left = (lane_id > 0) == forward  # whether the outer edge lies to the left of the traffic
    left, right = (outer, inner) if on_left else (inner, outer)
    return Stretch(index, subtype, pieces, forward, road.junction_id, left, right)


def _is_across_the_axis(section: LaneSection, lane_id: int) -> bool:
    """Return whether a shoulder belongs to the traffic across the axis, as the left one of a carriageway does."""
    beside, across = (section.lane(other) for other in (2 * lane_id, -lane_id))
    kinds = [subtype_of(lane.type) if lane is not None else None for lane in (beside, across)]
    return abs(lane_id) == 1 and kinds[1] == ROAD and kinds[0] != ROAD


def _chain(road: Road, number: int, lane: Lane) -> list[tuple[int, int]]:
    """Return the lane and what it goes on as through the later sections of a connecting road."""
    chain = [(number, lane.id)]
    for at in range(number + 1, len(road.sections)):
        after = road.sections[at].lane(lane.successor) if lane.successor else None
        rivals = [other for other in road.sections[at - 1].lanes if after is not None and other.successor == after.id]
        if after is None or len(rivals) != 1 or subtype_of(after.type) != ROAD or after.id * lane.id < 0:
            break
        chain.append((at, after.id))
        lane = after
    return chain


def _cuts(road: Road, section: LaneSection) -> list[float]:
    """Return where a section begins, is cut, and ends."""
    wanted = {
        section.s_m + mark.offset_m
        for lane in section.lanes
        for before, mark in pairwise(lane.marks)
        if (before.type, before.lane_change) != (mark.type, mark.lane_change)
    }
    for lane in section.lanes:
        wanted |= {section.s_m + speed.start_m for speed in lane.speeds[1:]}
    wanted |= {kind.s_m for before, kind in pairwise(road.types) if before.limit_mps != kind.limit_mps}
    cuts = [section.s_m]
    for at_m in sorted(wanted):
        if at_m >= cuts[-1] + SHORTEST_CUT_M and at_m <= section.end_m - SHORTEST_CUT_M:
            cuts.append(at_m)
    return [*cuts, section.end_m]
