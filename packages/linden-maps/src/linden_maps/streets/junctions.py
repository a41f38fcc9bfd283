"""The inside of a junction: paths of all allowed turns, kerbs round the corners, priorities."""

import math
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from shapely import LineString, MultiPolygon, Point, Polygon, convex_hull, is_valid, polygons, unary_union

from linden_maps.streets.cross_section import KERB_M
from linden_maps.streets.curves import Path, Pose, joined, length, moved, pose_at, sampled, turned_back, wrapped
from linden_maps.streets.document import Connection, Cubic, LaneRecord, Link, Mark, RoadRecord, eased, value
from linden_maps.streets.network import Leg
from linden_maps.streets.roads import blended, contact, strips
from linden_maps.streets.street_facts import slower

SHARES_OF_ROOM = (1.0, 0.9, 0.8, 0.7)  # for the arc of a turn; a tighter one keeps further off the kerb
KERB_TOUCHED_M2 = 0.005
SHOULDER_STEP_M = 2.0  # between the widths given for the paved rest of a corner
SHOULDER_REACH_M = 15.0
STRAIGHT_RAD = math.radians(35)
"""Up to this change of heading a way through a junction counts as straight on."""


class Turn(NamedTuple):
    """One lane's way through a junction. The path is the lane's middle, so that distances along it are those driven."""

    come: Leg
    lane_in: int
    go: Leg
    lane_out: int
    path: Path
    widths: tuple[Cubic, ...]


def turns(legs: tuple[Leg, ...]) -> tuple[Turn, ...]:
    """Return a path for each way a lane may go: no turning back, and no lane left without a way on or a way in."""
    found = []
    for come, lane_in, go, lane_out in lane_pairs(legs):
        ways = (_direct(legs[come], lane_in, legs[go], lane_out, share) for share in SHARES_OF_ROOM)
        turn = next(ways)
        if go == (come + 1) % len(legs):  # no turn lies further to the right: the kerb is beside this way
            kerb = _kerb_strip(corner_kerb(legs[come], legs[go]))
            turn = next((way for way in (turn, *ways) if not _touches(way, kerb)), turn)
        found.append(turn)
    return tuple(found)


def lane_pairs(legs: tuple[Leg, ...]) -> list[tuple[int, int, int, int]]:
    """Return (leg, lane) to (leg, lane) for all ways through a junction, in the order of the legs."""
    pairs: list[tuple[int, int, int, int]] = []
    for come, leg in enumerate(legs):
        ins = leg.view.driving(right=True)
        for go in _others(come, len(legs)):
            outs = legs[go].view.driving(right=False)
            pairs += [(come, a, go, b) for a, b in _lanes_of_turn(_turn_rad(leg, legs[go]), ins, outs)]
    pairs += _without_way_on(legs, pairs)
    pairs += _without_way_in(legs, pairs)
    return sorted(pairs, key=lambda pair: (pair[0], (pair[2] - pair[0]) % len(legs), abs(pair[1]), abs(pair[3])))


def pose_in(leg: Leg, lane: int) -> Pose:
    """Return where the middle of an incoming lane meets the junction, looking into it."""
    return moved(leg.pose, left_m=leg.view.middle_m(lane, right=True))


def pose_out(leg: Leg, lane: int) -> Pose:
    """Return where the middle of an outgoing lane leaves the junction, looking out."""
    return turned_back(moved(leg.pose, left_m=leg.view.middle_m(lane, right=False)))


def turn_road(number: int, junction: int, turn: Turn, road_ids: tuple[int, int]) -> RoadRecord:
    """Return the connecting road of a turn: one driving lane, its middle on the path (half its width is the offset)."""
    lane = LaneRecord(
        id=-1, kind="driving", widths=turn.widths, mark=Mark(), predecessor=turn.lane_in, successor=turn.lane_out
    )
    return RoadRecord(
        id=number,
        name=turn.go.street.name,
        junction=junction,
        path=turn.path,
        predecessor=Link("road", road_ids[0], contact(turn.come.end)),
        successor=Link("road", road_ids[1], contact(turn.go.end)),
        speed=slower(turn.come.street.speed_limit, turn.go.street.speed_limit),
        elevation=(),
        axis=tuple(Cubic(w.s_m, w.a / 2, w.b / 2, w.c / 2, w.d / 2) for w in turn.widths),
        left=(),
        right=(lane,),
        centre=Mark(),
    )


def corner_kerb(come: Leg, go: Leg) -> Path:
    """Return the kerb's face from the right side of one leg to the next leg counter-clockwise."""
    begin = moved(come.pose, left_m=come.view.kerb_m(right=True))
    return joined(begin, turned_back(moved(go.pose, left_m=go.view.kerb_m(right=False))))


def surface(ways: tuple[Turn, ...]) -> Polygon | MultiPolygon:
    """Return the ground that the lanes of a junction's turns cover."""
    pieces = [piece for turn in ways for piece in _pieces_covered(turn)]
    found = unary_union(pieces) if pieces else Polygon()  # one-way streets may all lead away from each other
    assert isinstance(found, (Polygon, MultiPolygon)), "lanes cover an area"
    return found


def corner_road(
    number: int,
    junction: int,
    legs: tuple[Leg, Leg],
    road_ids: tuple[int, int],
    driven: Polygon | MultiPolygon,
    kerb: Path | None = None,
) -> RoadRecord:
    """Return kerb, verge and sidewalk from the right side of one leg to the next leg counter-clockwise.

    What lies between the kerb and the ``driven`` surface is paved too: a shoulder on the left of the kerb line, which
    may be given where it is not the shortest.
    """
    come, go = legs
    path = kerb or corner_kerb(come, go)
    found = blended(come.view.raised(right=True), go.view.raised(right=False))
    return RoadRecord(
        id=number,
        name=f"{come.street.name}, corner",
        junction=junction,
        path=path,
        predecessor=Link("road", road_ids[0], contact(come.end)),
        successor=Link("road", road_ids[1], contact(go.end)),
        speed=slower(come.street.speed_limit, go.street.speed_limit),
        elevation=(),
        axis=(),
        left=_shoulder(path, driven),
        right=strips(found, -1, length(path)),
        centre=Mark("curb"),
    )


def _shoulder(path: Path, driven: Polygon | MultiPolygon) -> tuple[LaneRecord, ...]:
    """Return the lane between a kerb line and the driven surface on its left, none where they touch all along."""
    total_m = length(path)
    count = math.ceil(total_m / SHOULDER_STEP_M)
    stations = [total_m * i / count for i in range(count + 1)]
    # 5 cm inside the ends: there the look across would run along the edge of the driven surface
    gaps_m = [_gap(pose_at(path, min(max(s, 0.05), total_m - 0.05)), driven) for s in stations]
    if max(gaps_m) < 0.1:
        return ()
    widths = tuple(
        Cubic(s, gap, (gap_after - gap) / (after - s))
        for s, after, gap, gap_after in zip(stations, stations[1:], gaps_m, gaps_m[1:], strict=False)
    )
    return (LaneRecord(id=1, kind="shoulder", widths=widths),)


def _gap(pose: Pose, driven: Polygon | MultiPolygon) -> float:
    """Return how far the driven surface lies to the left of a pose, 0 where it does not within ``SHOULDER_REACH_M``."""
    far = moved(pose, left_m=SHOULDER_REACH_M)
    across = LineString([pose[:2], far[:2]]).intersection(driven)
    return 0.0 if across.is_empty else round(across.distance(Point(*pose[:2])), 3)


def connection(record: RoadRecord) -> Connection:
    """Return the junction's entry for a connecting road."""
    assert record.predecessor is not None
    lanes = tuple((lane.predecessor, lane.id) for lane in record.right if lane.predecessor is not None)
    return Connection(record.predecessor.id, record.id, lanes)


def conflicting(one: Turn, other: Turn) -> bool:
    """Return whether two turns of different legs cross or end in the same lane."""
    if one.come.end == other.come.end:
        return False
    if (one.go.end, one.lane_out) == (other.go.end, other.lane_out):
        return True
    return bool(_line(one.path).intersects(_line(other.path)))


def _pieces_covered(turn: Turn) -> list[Polygon]:
    """Return the ground under a turn's lane, metre by metre (as one outline it could cross itself).

    Where a path turns within half the lane's width, the lane's inner side runs backwards. A metre of it then crosses
    itself. GEOS overlays no such ring, so the hull of its corners stands for it.
    """
    total_m = length(turn.path)
    count = math.ceil(total_m)
    sides = []
    for i in range(count + 1):
        pose, half_m = pose_at(turn.path, total_m * i / count), value(turn.widths, total_m * i / count) / 2
        sides.append((moved(pose, left_m=half_m)[:2], moved(pose, left_m=-half_m)[:2]))
    corners = [(left, right, right_after, left_after) for (left, right), (left_after, right_after) in pairwise(sides)]
    found: NDArray[np.object_] = np.asarray(polygons(np.array(corners)))
    hulls: NDArray[np.object_] = np.asarray(convex_hull(found))
    pieces: list[Polygon] = np.where(is_valid(found), found, hulls).tolist()
    return [piece for piece in pieces if piece.area > 0.0]


@lru_cache(256)
def _line(path: Path) -> LineString:
    """Return a path as a line; the turns of a junction are compared with each other."""
    return LineString(np.array(sampled(path, 2.0))[:, :2])


def _kerb_strip(kerb: Path) -> Polygon:
    """Return the ground of the kerbstones on the right of a kerb line."""
    face, back = ([pose[:2] for pose in sampled(kerb, 0.25, left_m=-m)] for m in (0.01, KERB_M))
    return Polygon([*face, *reversed(back)]).buffer(0.0)


def _touches(turn: Turn, kerb: Polygon) -> bool:
    """Return whether the lane of a turn lies on the kerb."""
    shared_m2 = sum(piece.intersection(kerb).area for piece in _pieces_covered(turn) if piece.intersects(kerb))
    return bool(shared_m2 > KERB_TOUCHED_M2)


def _direct(come: Leg, lane_in: int, go: Leg, lane_out: int, share: float) -> Turn:
    """Return the shortest smooth way between two lanes, its width changing evenly."""
    path = joined(pose_in(come, lane_in), pose_out(go, lane_out), share)
    widths_m = come.view.lane(lane_in).width_m, go.view.lane(lane_out).width_m
    return Turn(come, lane_in, go, lane_out, path, (eased(0.0, length(path), widths_m),))


def _turn_rad(come: Leg, go: Leg) -> float:
    return wrapped(go.pose.heading_rad + math.pi - come.pose.heading_rad)


def _others(leg: int, count: int) -> list[int]:
    return [(leg + step) % count for step in range(1, count)]


def _lanes_of_turn(turn_rad: float, ins: tuple[int, ...], outs: tuple[int, ...]) -> list[tuple[int, int]]:
    """Return which lanes a turn joins: left from and into the innermost, right the outermost, straight one to one."""
    if not ins or not outs:
        return []
    if turn_rad > STRAIGHT_RAD:
        return [(ins[0], outs[0])]
    if turn_rad < -STRAIGHT_RAD:
        return [(ins[-1], outs[-1])]
    count = min(len(ins), len(outs))
    return list(zip(ins[-count:], outs[-count:], strict=True))


def _without_way_on(legs: tuple[Leg, ...], pairs: list[tuple[int, int, int, int]]) -> list[tuple[int, int, int, int]]:
    """Return a way for each incoming lane that has none: as straight on as can be."""
    served = {pair[:2] for pair in pairs}
    found = []
    for come, leg in enumerate(legs):
        goals = [go for go in _others(come, len(legs)) if legs[go].view.driving(right=False)]
        for place, lane in enumerate(leg.view.driving(right=True)):
            if (come, lane) not in served and goals:
                go = min(goals, key=lambda other: (abs(_turn_rad(leg, legs[other])), other))
                outs = legs[go].view.driving(right=False)
                found.append((come, lane, go, outs[min(place, len(outs) - 1)]))
    return found


def _without_way_in(legs: tuple[Leg, ...], pairs: list[tuple[int, int, int, int]]) -> list[tuple[int, int, int, int]]:
    """Return a way into each outgoing lane that has none: from as straight ahead as can be."""
    served = {pair[2:] for pair in pairs}
    found = []
    for go, leg in enumerate(legs):
        sources = [come for come in _others(go, len(legs)) if legs[come].view.driving(right=True)]
        for place, lane in enumerate(leg.view.driving(right=False)):
            if (go, lane) not in served and sources:
                come = min(sources, key=lambda other: (abs(_turn_rad(legs[other], leg)), other))
                ins = legs[come].view.driving(right=True)
                found.append((come, ins[min(place, len(ins) - 1)], go, lane))
    return found
