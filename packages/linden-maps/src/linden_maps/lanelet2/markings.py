"""Lanelet2 tags of lanelet bounds (type, subtype, lane change), from OpenDRIVE's lanes and road marks.

Tags as Lanelet2 and autoware_lanelet2_extension have them. Inside junctions bounds are ``virtual`` or ``road_border``,
as Autoware wants them there (vm-03-03).
"""

from linden.maps.opendrive.evaluate.tables import Tables
from linden.maps.opendrive.model import Lane, RoadMark
from linden_maps.lanelet2.model import Tags
from linden_maps.lanelet2.stretches import ROAD, SHOULDER, WALKWAY, LaneletNetwork, Side, Stretch

KERB_M = 0.03
"""A step in height from this on is a kerb."""
_PAINT = {
    "solid": "solid",
    "broken": "dashed",
    "solid solid": "solid_solid",
    "solid broken": "solid_dashed",
    "broken solid": "dashed_solid",
    "broken broken": "dashed",
    "botts dots": "dashed",
}
KERB = {"type": "road_border", "subtype": "curbstone"}


def tags_of_sides(tables: Tables, network: LaneletNetwork) -> dict[Side, Tags]:
    """Return the tags of every side's way."""
    users: dict[Side, list[Stretch]] = {}
    for stretch in network.stretches:
        for side in (stretch.left, stretch.right):
            users.setdefault(side, []).append(stretch)
    return {side: _tags(tables, side, found) for side, found in users.items()}


def _tags(tables: Tables, side: Side, users: list[Stretch]) -> Tags:
    if users[0].subtype == WALKWAY:
        return {"type": "virtual"}
    section, boundary, start_m, end_m = max(side.pieces, key=lambda piece: piece[3] - piece[2])
    in_section = tables.roads[side.road].sections[section]
    mark = mark_at(in_section.lane(boundary), (start_m + end_m) / 2.0 - in_section.s_m)
    beside = [in_section.lane(number) for number in beside_boundary(boundary)]
    roads = [user for user in users if user.subtype == ROAD]
    shared = {"lane_change": "yes" if _is_between(roads) and _allows(mark) else "no"}
    if mark.type == "curb" or is_step(beside):
        return {**KERB, **shared}
    if users[0].junction_id >= 0:
        return {"type": "virtual", **shared}
    if _is_border(users, mark):
        return {"type": "road_border", **shared}
    if mark.type not in _PAINT:
        return {"type": "virtual", **shared}
    tags = {"type": "line_thick" if mark.weight == "bold" else "line_thin", "subtype": _PAINT[mark.type], **shared}
    return {**tags, "color": mark.colour} if mark.colour in {"yellow", "white"} else tags


def _is_border(users: list[Stretch], mark: RoadMark) -> bool:
    """Return whether a road ends at a side; so do both of two shoulders of opposite directions (vm-01-16)."""
    if len(users) == 1:
        return users[0].subtype != ROAD or mark.type not in _PAINT
    return all(user.subtype == SHOULDER for user in users) and users[0].forward != users[1].forward


def mark_at(lane: Lane | None, along_m: float) -> RoadMark:
    """Return the marking on a lane's outer edge, none where there is none."""
    marks = [mark for mark in (lane.marks if lane else ()) if mark.offset_m <= along_m + 1e-6]
    return marks[-1] if marks else RoadMark(0.0, "none", "standard", "standard", 0.0, None)


def beside_boundary(boundary: int) -> tuple[int, int]:
    """Return the ids of the lanes on either side of a boundary."""
    return (1, -1) if boundary == 0 else (boundary, boundary + (1 if boundary > 0 else -1))


def is_step(beside: list[Lane | None]) -> bool:
    """Return whether one of two lanes lies higher than the other; where there is one only, than the road.

    A lane lies higher with both its edges: one that leans to a side, as on a junction on a slope, has no step.
    """
    heights = [
        max((min(height.inner_m, height.outer_m) for height in lane.heights), default=0.0) if lane else 0.0
        for lane in beside
    ]
    return abs(heights[0] - heights[1]) >= KERB_M


def _is_between(roads: list[Stretch]) -> bool:
    return len(roads) == 2 and roads[0].forward == roads[1].forward


def _allows(mark: RoadMark) -> bool:
    """Return whether a marking lets lanes be changed in both directions; Lanelet2's tag knows no other."""
    if mark.lane_change in {"both", "none", "increase", "decrease"}:
        return mark.lane_change == "both"
    return mark.type.startswith("broken")
