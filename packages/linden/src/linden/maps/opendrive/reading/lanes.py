"""Reads <lanes>: offsets, sections and all that belongs to a lane."""

import logging

from lxml.etree import _Element as Element

from linden.background import checkpoint
from linden.maps.opendrive.limits import MOST_LANES, MapError
from linden.maps.opendrive.model import Cubic, Height, Lane, LaneSection, RoadMark, Speed
from linden.maps.opendrive.reading.attributes import (
    cubic_coefficients,
    line_of,
    number,
    number_or,
    reject,
    speed_mps,
    whole,
)
from linden.protocol.values.enums import LaneType

log = logging.getLogger("linden")

# LibCarla reads lane types in any case and takes anything else for NONE (RoadParser.cpp, StringToLaneType).
_LANE_TYPES = {
    name.lower().replace("_", ""): kind for name, kind in LaneType.__members__.items() if kind is not LaneType.NONE
}
_SIDES = ("left", "center", "right")


def read_lane_offsets(lanes: Element) -> tuple[Cubic, ...]:
    """Return how far the centre lane lies from the reference line along the road."""
    return tuple(Cubic(number(node, "s"), *cubic_coefficients(node)) for node in lanes.iterchildren("laneOffset"))


def read_sections(lanes: Element, road_length_m: float) -> tuple[LaneSection, ...]:
    """Return the lane sections, each ending where the next begins.

    Raises:
        MapError: there is none, or they do not follow one another inside the road.
    """
    nodes = list(lanes.iterchildren("laneSection"))
    if not nodes:
        raise MapError("<lanes> has no <laneSection>; a road needs at least one", line_of(lanes))
    starts = [number(node, "s") for node in nodes]
    ends = [*starts[1:], road_length_m]
    sections = []
    for node, start_m, end_m in zip(nodes, starts, ends, strict=True):
        checkpoint()
        if start_m == end_m:
            log.warning("line %d: a <laneSection> without length at s=%g m is left out", line_of(node), start_m)
            continue
        if not 0.0 <= start_m < end_m:
            raise MapError(
                f"<laneSection> from s={start_m:g} to {end_m:g} m is empty or outside its road of {road_length_m:g} m",
                line_of(node),
            )
        sections.append(LaneSection(s_m=start_m, end_m=end_m, lanes=_lanes_of(node)))
    if not sections:
        raise MapError("no <laneSection> of this road has a length; it needs at least one", line_of(lanes))
    return tuple(sections)


def _lanes_of(section: Element) -> tuple[Lane, ...]:
    """Return a section's lanes from left to right; lane 0 is added where the file has none."""
    lanes = {}
    for side in section:
        if side.tag not in _SIDES:
            continue
        for node in side.iterchildren("lane"):
            lane = _lane(node)
            if abs(lane.id) > MOST_LANES:
                reject(node, "id", f"between -{MOST_LANES} and {MOST_LANES}")
            if lane.id in lanes:
                raise MapError(f"lane {lane.id} stands twice in one <laneSection>", line_of(node))
            lanes[lane.id] = lane
    lanes.setdefault(0, _EMPTY_CENTRE)
    return tuple(lanes[lane_id] for lane_id in sorted(lanes, reverse=True))


def _lane(node: Element) -> Lane:
    widths, borders, marks, speeds, heights = [], [], [], [], []
    links: dict[str, int] = {}
    for child in node:
        match child.tag:
            case "width":
                widths.append(Cubic(number_or(child, "sOffset", 0.0), *cubic_coefficients(child)))
            case "roadMark":
                marks.append(_mark(child))
            case "link":
                links = {neighbour.tag: whole(neighbour, "id") for neighbour in child}
            case "height":
                offset_m = number_or(child, "sOffset", 0.0)
                heights.append(Height(offset_m, number_or(child, "inner", 0.0), number_or(child, "outer", 0.0)))
            case "speed":
                speeds.append(Speed(number_or(child, "sOffset", 0.0), speed_mps(child)))
            case "border":
                borders.append(Cubic(number_or(child, "sOffset", 0.0), *cubic_coefficients(child)))
            case _:
                pass
    return Lane(
        id=whole(node, "id"),
        type=_LANE_TYPES.get((node.get("type") or "").lower(), LaneType.NONE),
        predecessor=links.get("predecessor"),
        successor=links.get("successor"),
        widths=tuple(widths),
        borders=tuple(borders),
        marks=tuple(marks),
        speeds=tuple(speeds),
        heights=tuple(heights),
    )


def _mark(node: Element) -> RoadMark:
    get = node.get
    return RoadMark(
        offset_m=number_or(node, "sOffset", 0.0),
        type=get("type") or "none",
        weight=get("weight") or "standard",
        colour=get("color") or "standard",
        width_m=number_or(node, "width", 0.0),
        lane_change=get("laneChange"),
    )


_EMPTY_CENTRE = Lane(
    id=0,
    type=LaneType.NONE,
    predecessor=None,
    successor=None,
    widths=(),
    borders=(),
    marks=(),
    speeds=(),
    heights=(),
)
