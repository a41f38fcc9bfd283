"""Readers of <junction> and <road>.

A junction has connections, lane links, controllers and priorities. A road has links, types, a reference line and an
elevation. Lanes and objects have readers in files of their own.
"""

import logging

from lxml.etree import _Element as Element

from linden.maps.opendrive.limits import LARGEST_NUMBER, LONGEST_ROAD_M, SHORTEST_ROAD_M, MapError
from linden.maps.opendrive.model import (
    NO_JUNCTION,
    Arc,
    Connection,
    Cubic,
    Geometry,
    Junction,
    ParamPoly3,
    Road,
    RoadLink,
    RoadType,
    Spiral,
    StraightLine,
)
from linden.maps.opendrive.reading.attributes import (
    cubic_coefficients,
    line_of,
    number,
    number_or,
    reject,
    speed_mps,
    user_data,
    whole,
    within,
)
from linden.maps.opendrive.reading.lanes import read_lane_offsets, read_sections
from linden.maps.opendrive.reading.roadside import (
    read_objects,
    read_signal_references,
    read_signals,
    read_speed_stencils,
)

log = logging.getLogger("linden")


def read_junction(node: Element) -> Junction:
    """Return one junction."""
    junction_id = whole(node, "id")
    if junction_id < 0:
        reject(node, "id", "0 or more")
    return Junction(
        id=junction_id,
        name=node.get("name", ""),
        connections=tuple(
            _connection(child) for child in node.iterchildren("connection") if child.get("connectingRoad") is not None
        ),
        controllers=tuple(child.get("id", "") for child in node.iterchildren("controller")),
        priorities=tuple((whole(child, "high"), whole(child, "low")) for child in node.iterchildren("priority")),
        user_data=user_data(node),
        source_line=line_of(node),
    )


def _connection(node: Element) -> Connection:
    return Connection(
        id=node.get("id", ""),
        incoming_road=whole(node, "incomingRoad"),
        connecting_road=whole(node, "connectingRoad"),
        contact=node.get("contactPoint"),
        lane_links=tuple((whole(link, "from"), whole(link, "to")) for link in node.iterchildren("laneLink")),
    )


# An arc of less curvature than this is a line; LibCarla asserts more (Geometry.cpp, GeometryArc).
_STRAIGHT_PER_M = 1e-15


def read_road(node: Element) -> Road | None:
    """Return one road with everything along it; None for a road too short to be looked at, which the log names.

    Editors leave such roads behind, between two junctions that touch. LibCarla reads past them too.
    """
    length_m = within(node, "length", 0.0, LONGEST_ROAD_M)
    if length_m < SHORTEST_ROAD_M:
        log.warning("line %d: road %s is %g m long and is left out", line_of(node), node.get("id"), length_m)
        return None
    parts = {child.tag: child for child in node}
    lanes, link, profile = parts.get("lanes"), parts.get("link"), parts.get("elevationProfile")
    if lanes is None:
        raise MapError(f"road {node.get('id')} has no <lanes>", line_of(node))
    links = {} if link is None else {end.tag: _link(end) for end in link if end.tag in {"predecessor", "successor"}}
    return Road(
        id=_road_id(node),
        name=node.get("name", ""),
        length_m=length_m,
        junction_id=whole(node, "junction") if node.get("junction") else NO_JUNCTION,
        is_right_hand=node.get("rule") != "LHT",
        predecessor=links.get("predecessor"),
        successor=links.get("successor"),
        types=tuple(_road_type(child) for child in node.iterchildren("type")),
        geometries=_reference_line(node, parts.get("planView")),
        elevations=() if profile is None else _elevations(profile),
        lane_offsets=read_lane_offsets(lanes),
        sections=read_sections(lanes, length_m),
        signals=(*read_signals(parts.get("signals")), *read_speed_stencils(parts.get("objects"))),
        signal_references=read_signal_references(parts.get("signals")),
        objects=read_objects(parts.get("objects")),
        user_data=user_data(node) if "userData" in parts else (),
        source_line=line_of(node),
    )


def _road_id(node: Element) -> int:
    road_id = whole(node, "id")
    if road_id < 0:
        reject(node, "id", "0 or more")
    return road_id


def _link(node: Element) -> RoadLink:
    return RoadLink(node.get("elementType") == "junction", whole(node, "elementId"), node.get("contactPoint"))


def _elevations(profile: Element) -> tuple[Cubic, ...]:
    return tuple(Cubic(number(node, "s"), *cubic_coefficients(node)) for node in profile.iterchildren("elevation"))


def _road_type(node: Element) -> RoadType:
    speed = next(node.iterchildren("speed"), None)
    return RoadType(
        number_or(node, "s", 0.0), node.get("type", ""), None if speed is None else speed_mps(speed), speed is not None
    )


def _reference_line(road: Element, plan_view: Element | None) -> tuple[Geometry, ...]:
    nodes = [] if plan_view is None else list(plan_view.iterchildren("geometry"))
    nodes = [node for node in nodes if not _is_empty(node)]
    if not nodes:
        raise MapError(f"road {road.get('id')} has no <planView> with a <geometry> of some length", line_of(road))
    return tuple(
        Geometry(
            s_m=number(node, "s"),
            x_m=number(node, "x"),
            y_m=number(node, "y"),
            heading_rad=number(node, "hdg"),
            length_m=number(node, "length"),
            shape=_shape(node),
        )
        for node in nodes
    )


def _is_empty(geometry: Element) -> bool:
    """Return whether a piece of a reference line has no length; the log names it."""
    length_m = within(geometry, "length", 0.0, LARGEST_NUMBER)
    if length_m == 0.0:
        log.warning("line %d: a <geometry> without length is left out", line_of(geometry))
    return length_m == 0.0


def _shape(geometry: Element) -> StraightLine | Arc | Spiral | ParamPoly3:
    node = next((child for child in geometry if isinstance(child.tag, str)), None)
    match None if node is None else node.tag:
        case "line":
            return StraightLine()
        case "arc":
            assert node is not None
            curvature = number(node, "curvature")
            return Arc(curvature) if abs(curvature) > _STRAIGHT_PER_M else StraightLine()
        case "spiral":
            assert node is not None
            return Spiral(number(node, "curvStart"), number(node, "curvEnd"))
        case "poly3":
            assert node is not None
            return ParamPoly3((0.0, 1.0, 0.0, 0.0), cubic_coefficients(node), number(geometry, "length"))
        case "paramPoly3":
            assert node is not None
            return _param_poly3(node, number(geometry, "length"))
        case other:
            raise MapError(
                f"a <geometry> holds {other or 'nothing'}; known are line, arc, spiral, poly3, paramPoly3",
                line_of(geometry),
            )


def _param_poly3(node: Element, length_m: float) -> ParamPoly3:
    u = tuple(number_or(node, f"{letter}U", 0.0) for letter in "abcd")
    v = tuple(number_or(node, f"{letter}V", 0.0) for letter in "abcd")
    # LibCarla takes anything but "arcLength", a missing pRange too, for "normalized" (MapBuilder.cpp).
    p_end = length_m if node.get("pRange") == "arcLength" else 1.0
    return ParamPoly3((u[0], u[1], u[2], u[3]), (v[0], v[1], v[2], v[3]), p_end)
