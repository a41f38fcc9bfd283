"""Roads between junctions as OpenDRIVE records: lanes and their marks, height, and the bends where two roads meet."""

import math
from itertools import zip_longest
from typing import NamedTuple

from linden_maps.streets.cross_section import KERB_HEIGHT_M, PAVED, RAISED, Lane, Section
from linden_maps.streets.curves import Path, Pose, joined, length, pose_at, turned_back
from linden_maps.streets.document import Cubic, LaneRecord, Link, Mark, RoadRecord, eased, value
from linden_maps.streets.network import End, Leg
from linden_maps.streets.street_facts import AnyGround, Street, slower

KINDS = ("driving", "biking", "parking", "shoulder", "border", "none", "sidewalk")  # from the axis outward

Numbered = tuple[tuple[int, Lane], ...]
HeightAndSlope = tuple[float, float]


class Touch(NamedTuple):
    """What one end of a road touches: the link, and for each lane the one it goes on in (none at a junction)."""

    link: Link
    lanes: dict[int, int]


class Strip(NamedTuple):
    """A lane of a road that joins two others: its width at both ends (0 where it is missing) and its neighbours."""

    kind: str
    widths_m: tuple[float, float]
    before: int | None
    after: int | None


def height(ground: AnyGround, pose: Pose) -> float:
    """Return the ground's height in m under a pose."""
    return ground.height_m(pose.x_m, pose.y_m)


def slope(ground: AnyGround, pose: Pose) -> float:
    """Return the ground's rise per metre along a pose's heading."""
    east, north = ground.rise(pose.x_m, pose.y_m)
    return north * math.sin(pose.heading_rad) + east * math.cos(pose.heading_rad)


def elevation(
    ground: AnyGround,
    path: Path,
    ends: tuple[HeightAndSlope | None, HeightAndSlope | None],
    lifts_m: tuple[float, float] = (0.0, 0.0),
) -> tuple[Cubic, ...]:
    """Return the height along a path: on the ground, but at the given height and slope where it meets a junction.

    A slope is the rise per metre along the path. ``None`` stands for an end where the ground goes on. ``lifts_m``: how
    far both ends lie above the ground.
    """
    total_m = length(path)
    ramp_m = min(ground.profile.ramp_m, total_m / 2)
    middle_m = total_m - 2 * ramp_m
    count = round(middle_m / ground.profile.knot_m) + 1 if middle_m > 1.0 else 0
    knots = [0.0, *(ramp_m + middle_m * i / max(count, 1) for i in range(count + 1)), total_m]
    if not count:
        knots = [0.0, total_m]
    poses = [pose_at(path, s) for s in knots]
    points = [(height(ground, pose), slope(ground, pose)) for pose in poses]
    if lifts_m != (0.0, 0.0):
        rise = eased(0.0, total_m, lifts_m)
        points = [
            (z + value((rise,), s), g + s * (2 * rise.c + 3 * rise.d * s))
            for s, (z, g) in zip(knots, points, strict=True)
        ]
    for index, end in ((0, ends[0]), (-1, ends[1])):
        if end is not None:
            points[index] = end
    return tuple(
        eased(s, after - s, (z, z_after), (g, g_after))
        for s, after, (z, g), (z_after, g_after) in zip(knots, knots[1:], points, points[1:], strict=False)
    )


def street_road(number: int, street: Street, section: Section, path: Path, heights: tuple[Cubic, ...]) -> RoadRecord:
    """Return the record of a street's road, not linked yet."""
    busy = street.street_class in {"arterial", "collector"}
    centre = Mark("solid solid" if busy else "broken", "yellow") if section.left[0].kind == "driving" else _CURB
    return RoadRecord(
        id=number,
        name=street.name,
        junction=-1,
        path=path,
        predecessor=None,
        successor=None,
        speed=street.speed_limit,
        elevation=heights,
        axis=(Cubic(0.0, section.axis_m),),
        left=_lanes(section.left, 1),
        right=_lanes(section.right, -1),
        centre=centre,
        notes=(("street", street.id), ("class", street.street_class), *street.confidences),
    )


def linked(road: RoadRecord, before: Touch | None, after: Touch | None) -> RoadRecord:
    """Return the road with what its ends touch."""
    lanes_before = before.lanes if before else {}
    lanes_after = after.lanes if after else {}

    def told(lanes: tuple[LaneRecord, ...]) -> tuple[LaneRecord, ...]:
        return tuple(
            lane._replace(predecessor=lanes_before.get(lane.id), successor=lanes_after.get(lane.id)) for lane in lanes
        )

    return road._replace(
        predecessor=before.link if before else None,
        successor=after.link if after else None,
        left=told(road.left),
        right=told(road.right),
    )


def bend(
    number: int, legs: tuple[Leg, Leg], road_ids: tuple[int, int], ground: AnyGround, lift_m: float = 0.0
) -> RoadRecord:
    """Return the road that goes on from one road into another where just two meet, so far above the ground."""
    come, go = legs
    path = joined(come.pose, turned_back(go.pose))
    total_m = length(path)
    right = blended(come.view.right, go.view.left)
    left = blended(come.view.left, go.view.right)
    return RoadRecord(
        id=number,
        name=come.street.name,
        junction=-1,
        path=path,
        predecessor=Link("road", road_ids[0], contact(come.end)),
        successor=Link("road", road_ids[1], contact(go.end)),
        speed=slower(come.street.speed_limit, go.street.speed_limit),
        elevation=elevation(ground, path, (None, None), (lift_m, lift_m)),
        axis=(eased(0.0, total_m, (come.view.axis_m, -go.view.axis_m)),),
        left=strips(left, 1, total_m),
        right=strips(right, -1, total_m),
        centre=Mark("broken", "yellow"),
        notes=(("street", come.street.id), *come.street.confidences),
    )


def touches_of_bend(record: RoadRecord) -> tuple[Touch, Touch]:
    """Return what the roads before and after a bend touch: its start and its end, lane by lane."""
    lanes = record.right + record.left
    return (
        Touch(
            Link("road", record.id, "start"),
            {lane.predecessor: lane.id for lane in lanes if lane.predecessor is not None},
        ),
        Touch(
            Link("road", record.id, "end"), {lane.successor: lane.id for lane in lanes if lane.successor is not None}
        ),
    )


def contact(end: End) -> str:
    """Return OpenDRIVE's word for that end of a road."""
    return "end" if end.at_end else "start"


def blended(before: Numbered, after: Numbered) -> tuple[Strip, ...]:
    """Pair the lanes of two roads' sides kind by kind, from the axis out; what has no partner narrows to nothing."""
    found = []
    for kind in KINDS:
        ours = [(number, lane.width_m) for number, lane in before if lane.kind == kind]
        theirs = [(number, lane.width_m) for number, lane in after if lane.kind == kind]
        for one, other in zip_longest(ours, theirs):
            widths = (one[1] if one else 0.0, other[1] if other else 0.0)
            found.append(Strip(kind, widths, one[0] if one else None, other[0] if other else None))
    return tuple(found)


def strips(found: tuple[Strip, ...], sign: int, over_m: float) -> tuple[LaneRecord, ...]:
    """Return the lane records of one side, from the axis outward; ``sign`` is -1 on the right."""
    kinds = [strip.kind for strip in found]
    return tuple(
        LaneRecord(
            id=sign * (i + 1),
            kind=strip.kind,
            widths=(eased(0.0, over_m, strip.widths_m),),
            mark=_outer_mark(strip.kind, kinds[i + 1 : i + 2]),
            predecessor=strip.before,
            successor=strip.after,
            height_m=KERB_HEIGHT_M if strip.kind in RAISED else 0.0,
        )
        for i, strip in enumerate(found)
    )


_CURB = Mark("curb", "standard")


def _lanes(side: tuple[Lane, ...], sign: int) -> tuple[LaneRecord, ...]:
    kinds = [lane.kind for lane in side]
    return tuple(
        LaneRecord(
            id=sign * (i + 1),
            kind=lane.kind,
            widths=(Cubic(0.0, lane.width_m),),
            mark=_outer_mark(lane.kind, kinds[i + 1 : i + 2]),
            height_m=KERB_HEIGHT_M if lane.kind in RAISED else 0.0,
        )
        for i, lane in enumerate(side)
    )


def _outer_mark(kind: str, following: list[str]) -> Mark:
    """Return the mark between a lane and the next one outward."""
    if kind in PAVED and following == ["border"]:
        return _CURB
    if kind == "driving" and following == ["driving"]:
        return Mark("broken", "white", "both")
    if kind == "driving" and following:
        return Mark("solid", "white")
    return Mark()
