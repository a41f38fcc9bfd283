"""An OpenDRIVE document's text. Every number is written with fixed digits, so equal values give equal bytes.

Lengths are written to 1 µm, angles and curvatures to 1 nrad and 1e-9/m. Element order follows the 1.4 schema.
"""

from lxml import etree

from linden_maps.streets.curves import Path
from linden_maps.streets.document import (
    Cubic,
    Document,
    EdgeHeights,
    JunctionRecord,
    LaneRecord,
    Mark,
    Object,
    RoadRecord,
    Signal,
    SignalReference,
)
from linden_maps.streets.street_facts import Speed


def text(document: Document) -> bytes:
    """Return the document as OpenDRIVE text (UTF-8)."""
    root = etree.Element("OpenDRIVE")
    corners = [(piece.start.x_m, piece.start.y_m) for road in document.roads for piece in road.path]
    header = _add(
        root,
        "header",
        revMajor=1,
        revMinor=4,
        name=document.name,
        version="1.00",
        date="",
        north=_metres(max(y for _, y in corners)),
        south=_metres(min(y for _, y in corners)),
        east=_metres(max(x for x, _ in corners)),
        west=_metres(min(x for x, _ in corners)),
        vendor="linden map build",
    )
    _add(header, "geoReference").text = etree.CDATA(document.geo_reference)
    _add_notes(header, document.notes)
    for road in document.roads:
        _add_road(root, road)
    for controller in document.controllers:
        element = _add(root, "controller", id=controller.id, name=controller.name, sequence=0)
        for signal in controller.signals:
            _add(element, "control", signalId=signal, type="")
    for junction in document.junctions:
        _add_junction(root, junction)
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8", pretty_print=True)


def _add(parent: etree._Element, tag: str, **attributes: str | float) -> etree._Element:
    return etree.SubElement(parent, tag, {key: str(value) for key, value in attributes.items()})


def _add_notes(parent: etree._Element, notes: tuple[tuple[str, str], ...]) -> None:
    for code, value in notes:
        _add(parent, "userData", code=code, value=value)


def _metres(value: float) -> str:
    return _fixed(value, 6)


def _fixed(value: float, digits: int) -> str:
    """Return the number with that many digits after the point, without closing noughts and never as -0."""
    found = f"{value:.{digits}f}".rstrip("0").rstrip(".")
    return "0" if found in {"-0", ""} else found


def _cubic(cubic: Cubic, s_key: str) -> dict[str, str]:
    found = {s_key: _metres(cubic.s_m)}
    for key, value in zip("abcd", cubic[1:], strict=True):
        found[key] = _fixed(value, 12)
    return found


def _add_road(root: etree._Element, road: RoadRecord) -> None:
    length_m = sum(piece.length_m for piece in road.path)
    element = _add(root, "road", name=road.name, length=_metres(length_m), id=road.id, junction=road.junction)
    link = _add(element, "link")
    for tag, end in (("predecessor", road.predecessor), ("successor", road.successor)):
        if end is not None:
            contact = {} if end.contact is None else {"contactPoint": end.contact}
            _add(link, tag, elementType=end.element, elementId=end.id, **contact)
    if road.speed is not None:  # the 1.4 schema has whole numbers here, and fractions at lanes
        whole = max(1, round(road.speed.value))
        _add(_add(element, "type", s=0, type="town"), "speed", max=whole, unit=road.speed.unit)
    _add_plan(element, road.path)
    profile = _add(element, "elevationProfile")
    for cubic in road.elevation:
        _add(profile, "elevation", **_cubic(cubic, "s"))
    _add(element, "lateralProfile")
    _add_lanes(element, road)
    if road.objects:
        parent = _add(element, "objects")
        for thing in road.objects:
            _add_object(parent, thing)
    if road.signals or road.references:
        parent = _add(element, "signals")
        for signal in road.signals:
            _add_signal(parent, signal)
        for reference in road.references:
            _add_reference(parent, reference)
    _add_notes(element, road.notes)


def _add_plan(parent: etree._Element, path: Path) -> None:
    plan = _add(parent, "planView")
    s_m = 0.0
    for piece in path:
        x_m, y_m, heading_rad = piece.start
        geometry = _add(
            plan,
            "geometry",
            s=_metres(s_m),
            x=_metres(x_m),
            y=_metres(y_m),
            hdg=_fixed(heading_rad, 9),
            length=_metres(piece.length_m),
        )
        if piece.curvature_per_m:
            _add(geometry, "arc", curvature=_fixed(piece.curvature_per_m, 9))
        else:
            _add(geometry, "line")
        s_m += piece.length_m


def _add_lanes(parent: etree._Element, road: RoadRecord) -> None:
    lanes = _add(parent, "lanes")
    for cubic in road.axis:
        _add(lanes, "laneOffset", **_cubic(cubic, "s"))
    section = _add(lanes, "laneSection", s=0)
    if road.left:
        side = _add(section, "left")
        for lane in reversed(road.left):
            _add_lane(side, lane, road.speed)
    centre = _add(_add(section, "center"), "lane", id=0, type="none", level="false")
    _add_mark(centre, road.centre)
    if road.right:
        side = _add(section, "right")
        for lane in road.right:
            _add_lane(side, lane, road.speed)


def _add_lane(parent: etree._Element, lane: LaneRecord, speed: Speed | None) -> None:
    element = _add(parent, "lane", id=lane.id, type=lane.kind, level="false")
    link = _add(element, "link")
    if lane.predecessor is not None:
        _add(link, "predecessor", id=lane.predecessor)
    if lane.successor is not None:
        _add(link, "successor", id=lane.successor)
    for cubic in lane.widths:
        _add(element, "width", **_cubic(cubic, "sOffset"))
    _add_mark(element, lane.mark)
    if lane.kind == "driving" and speed is not None:  # SUMO's netconvert reads no speed of a road
        _add(element, "speed", sOffset=0, max=_fixed(speed.value, 3), unit=speed.unit)
    flat = (EdgeHeights(0.0, lane.height_m, lane.height_m),) if lane.height_m else ()
    for heights in lane.heights or flat:
        inner, outer = _metres(heights.inner_m), _metres(heights.outer_m)
        _add(element, "height", sOffset=_metres(heights.s_m), inner=inner, outer=outer)


def _add_mark(parent: etree._Element, mark: Mark) -> None:
    _add(
        parent,
        "roadMark",
        sOffset=0,
        type=mark.kind,
        weight="standard",
        color=mark.color,
        width="0" if mark.kind == "none" else "0.12",
        laneChange=mark.lane_change,
    )


def _add_object(parent: etree._Element, thing: Object) -> None:
    us, vs = [u for u, _ in thing.outline], [v for _, v in thing.outline]
    element = _add(
        parent,
        "object",
        id=thing.id,
        name=thing.name,
        type=thing.kind,
        s=_metres(thing.s_m),
        t=_metres(thing.t_m),
        zOffset=0,
        validLength=0,
        orientation="none",
        hdg=_fixed(thing.heading_rad, 9),
        pitch=0,
        roll=0,
        length=_metres(max(us) - min(us)),
        width=_metres(max(vs) - min(vs)),
        height=_metres(thing.height_m),
    )
    outline = _add(element, "outline")
    for u_m, v_m in thing.outline:
        _add(outline, "cornerLocal", u=_metres(u_m), v=_metres(v_m), z=0, height=_metres(thing.height_m))
    _add_notes(element, (("confidence", thing.confidence), *thing.notes))


def _add_signal(parent: etree._Element, signal: Signal) -> None:
    along = signal.lanes[0] < 0
    unit = {} if signal.unit is None else {"unit": signal.unit}
    element = _add(
        parent,
        "signal",
        id=signal.id,
        name=signal.name,
        s=_metres(signal.s_m),
        t=_metres(signal.t_m),
        zOffset=0,
        orientation="+" if along else "-",
        hOffset="0" if along else "3.141592654",
        pitch=0,
        roll=0,
        dynamic="yes" if signal.dynamic else "no",
        country="US",
        type=signal.kind,
        subtype=signal.subtype,
        value=_fixed(signal.value, 3),
        **unit,
        height="2.85",
        width="0.75",
    )
    _add(element, "validity", fromLane=signal.lanes[0], toLane=signal.lanes[1])
    _add_notes(element, (("confidence", signal.confidence),))


def _add_reference(parent: etree._Element, reference: SignalReference) -> None:
    element = _add(parent, "signalReference", s=0, t=0, id=reference.signal, orientation="+")
    _add(element, "validity", fromLane=reference.lanes[0], toLane=reference.lanes[1])


def _add_junction(root: etree._Element, junction: JunctionRecord) -> None:
    element = _add(root, "junction", name=junction.name, id=junction.id)
    for number, connection in enumerate(junction.connections):
        child = _add(
            element,
            "connection",
            id=number,
            incomingRoad=connection.incoming,
            connectingRoad=connection.connecting,
            contactPoint="start",
        )
        for source, target in connection.lanes:
            _add(child, "laneLink", **{"from": source, "to": target})
    for high, low in junction.priorities:
        _add(element, "priority", high=high, low=low)
    for controller in junction.controllers:
        _add(element, "controller", id=controller, type="", sequence=0)
    _add_notes(element, junction.notes)
