"""Reads what stands along a road: <signals>, <objects>, and <controller>."""

import re

from lxml.etree import _Element as Element

from linden.maps.opendrive.limits import FARTHEST_CORNER_M, MOST_CORNERS, MapError, refuse_beyond
from linden.maps.opendrive.reading.attributes import line_of, number, number_or, user_data, whole, within
from linden.maps.opendrive.roadside import (
    SPEED_LIMIT_TYPE,
    Controller,
    Corner,
    InertialPose,
    RoadObject,
    Signal,
    SignalReference,
    Validity,
)

# ObjectParser.cpp; the number begins at the seventh character, or the fourteenth in "Speed_STATIC_30"
_SPEED_STENCIL = re.compile(r"[Ss]peed_(?:STATIC_)?(\d+(?:\.\d+)?)")


def read_signals(signals: Element | None) -> tuple[Signal, ...]:
    """Return the signals that stand at a road, from its <signals>."""
    return () if signals is None else tuple(_signal(node) for node in signals.iterchildren("signal"))


def read_signal_references(signals: Element | None) -> tuple[SignalReference, ...]:
    """Return the references of a road to signals that stand elsewhere, from its <signals>."""
    if signals is None:
        return ()
    return tuple(
        SignalReference(
            signal_id=node.get("id", ""),
            s_m=number(node, "s"),
            t_m=number_or(node, "t", 0.0),
            orientation=node.get("orientation", "none"),
            validities=_validities(node),
        )
        for node in signals.iterchildren("signalReference")
    )


def read_objects(objects: Element | None) -> tuple[RoadObject, ...]:
    """Return the objects of a road, whatever their type, from its <objects>."""
    return () if objects is None else tuple(_object(node) for node in objects.iterchildren("object"))


def read_speed_stencils(objects: Element | None) -> tuple[Signal, ...]:
    """Return the speed limits that RoadRunner writes as objects named ``Speed_30``; LibCarla takes them for signs."""
    if objects is None:
        return ()
    return tuple(
        _speed_sign(node)
        for node in objects.iterchildren("object")
        if _SPEED_STENCIL.fullmatch(node.get("name", "")) and node.get("id")
    )


def read_controllers(root: Element) -> tuple[Controller, ...]:
    """Return the map's controllers in the order of the file."""
    return tuple(
        Controller(
            id=node.get("id", ""),
            name=node.get("name", ""),
            sequence=int(number_or(node, "sequence", 0.0)),
            signals=tuple(control.get("signalId", "") for control in node.iterchildren("control")),
        )
        for node in root.iterchildren("controller")
    )


def _signal(node: Element) -> Signal:
    get = node.get
    if not get("id"):
        raise MapError("a <signal> has no id; lights and signs are known by it", line_of(node))
    inertial = node.find("positionInertial")
    value = get("value")
    return Signal(
        id=get("id", ""),
        name=get("name", ""),
        s_m=number(node, "s"),
        t_m=number(node, "t"),
        z_offset_m=number_or(node, "zOffset", 0.0),
        heading_offset_rad=number_or(node, "hOffset", 0.0),
        pitch_rad=number_or(node, "pitch", 0.0),
        roll_rad=number_or(node, "roll", 0.0),
        orientation=get("orientation", "none"),
        is_dynamic=get("dynamic", "no").lower() == "yes",
        country=get("country", ""),
        type=get("type", ""),
        subtype=get("subtype", ""),
        value=number(node, "value") if value and value != "none" else None,
        unit=get("unit", ""),
        height_m=number_or(node, "height", 0.0),
        width_m=number_or(node, "width", 0.0),
        text=get("text", ""),
        validities=_validities(node),
        inertial=None if inertial is None else _inertial(inertial),
        source_line=line_of(node),
    )


def _speed_sign(node: Element) -> Signal:
    match = _SPEED_STENCIL.fullmatch(node.get("name", ""))
    assert match is not None
    return Signal(
        id=node.get("id", ""),
        name=node.get("name", ""),
        s_m=number(node, "s"),
        t_m=number_or(node, "t", 0.0),
        z_offset_m=number_or(node, "zOffset", 0.0),
        heading_offset_rad=number_or(node, "hdg", 0.0),
        pitch_rad=number_or(node, "pitch", 0.0),
        roll_rad=number_or(node, "roll", 0.0),
        orientation=node.get("orientation", "none"),
        is_dynamic=False,
        country="OpenDRIVE",
        type=SPEED_LIMIT_TYPE,
        subtype=match.group(1),
        value=float(match.group(1)),
        unit="mph",
        height_m=number_or(node, "height", 0.0),
        width_m=number_or(node, "width", 0.0),
        text=match.group(1),
        validities=(),
        inertial=None,
        source_line=line_of(node),
    )


def _inertial(node: Element) -> InertialPose:
    return InertialPose(
        number(node, "x"),
        number(node, "y"),
        number_or(node, "z", 0.0),
        number_or(node, "hdg", 0.0),
        number_or(node, "pitch", 0.0),
        number_or(node, "roll", 0.0),
    )


def _validities(node: Element) -> tuple[Validity, ...]:
    return tuple(Validity(whole(child, "fromLane"), whole(child, "toLane")) for child in node.iterchildren("validity"))


def _object(node: Element) -> RoadObject:
    get = node.get
    return RoadObject(
        id=get("id", ""),
        type=get("type", ""),
        name=get("name", ""),
        s_m=number(node, "s"),
        t_m=number_or(node, "t", 0.0),
        z_offset_m=number_or(node, "zOffset", 0.0),
        heading_rad=number_or(node, "hdg", 0.0),
        length_m=number_or(node, "length", 0.0),
        width_m=number_or(node, "width", 0.0),
        height_m=number_or(node, "height", 0.0),
        radius_m=number_or(node, "radius", 0.0),
        orientation=get("orientation", "none"),
        outline=_outline(node),
        user_data=user_data(node),
        source_line=line_of(node),
    )


def _outline(node: Element) -> tuple[Corner, ...]:
    """Return the corners of an object's first outline (1.4 has <outline>, 1.5 and later <outlines><outline>)."""
    outline = next(node.iter("outline"), None)
    if outline is None:
        return ()
    corners = tuple(_corner(child) for child in outline if child.tag in {"cornerLocal", "cornerRoad"})
    refuse_beyond(len(corners), MOST_CORNERS, "corners in one outline", line_of(node))
    return corners


def _corner(node: Element) -> Corner:
    along_road = node.tag == "cornerRoad"
    first, second, lift = ("s", "t", "dz") if along_road else ("u", "v", "z")
    return Corner(
        first_m=number(node, first) if along_road else within(node, first, -FARTHEST_CORNER_M, FARTHEST_CORNER_M),
        second_m=within(node, second, -FARTHEST_CORNER_M, FARTHEST_CORNER_M),
        z_m=number_or(node, lift, 0.0),
        height_m=number_or(node, "height", 0.0),
        is_along_road=along_road,
    )
