"""OpenDRIVE files as road networks."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

from basu_openscenario.reading.xml_node import read_xml
from basu_openscenario.roads.geometry import Clothoid, Cubic, Curve, cubic_curve
from basu_openscenario.roads.network import Connection, Junction, Network, SignalSpec
from basu_openscenario.roads.road import Lane, LaneSection, Link, Piece, Profile, Road

if TYPE_CHECKING:
    from basu_openscenario.reading.xml_node import Node

UNITS_MPS = {"": 1.0, "m/s": 1.0, "km/h": 1.0 / 3.6, "mph": 0.44704}
"""The units of posted speeds, in m/s."""
LONGEST_M = 1e5
"""A road above this is refused: the longest of public maps has 13 km, and points of each are kept every 2 m."""


def read_network(path: Path) -> Network:
    """Return the road network of an OpenDRIVE file.

    Raises:
        ScenarioError: the file cannot be read, or a road has no geometry.
    """
    root = read_xml(path, "OpenDRIVE")
    network = Network(path)
    for node in root.children("road"):
        road = _road(node)
        if road is None:
            continue
        if road.number in network.roads:
            raise node.fault(f"two roads have the id '{road.number}'; give one another id")
        network.roads[road.number] = road
        signals = node.find("signals")
        for one in () if signals is None else signals.children("signal"):
            network.signals[one.text("id")] = SignalSpec(
                one.text("id"), road.number, one.number("s"), one.text("dynamic", "no") == "yes"
            )
    if not network.roads:
        raise root.fault("the file has no road with a geometry; name another road network")
    for node in root.children("junction"):
        network.junctions[node.text("id")] = _junction(node)
    return network


def _cubic(node: Node, names: str = "abcd", suffix: str = "") -> Cubic:
    """Return the four coefficients of an element."""
    a, b, c, d = (node.number(name + suffix, 0.0) for name in names)
    return a, b, c, d


def _profile(block: Node | None, tag: str, offset: str = "s") -> Profile:
    """Return the pieces of a function that stand in ``block``."""
    if block is None:
        return Profile()
    pieces = [Piece(node.number(offset), _cubic(node)) for node in block.children(tag)]
    return Profile(tuple(sorted(pieces, key=lambda piece: piece.s_m)))


def _road(node: Node) -> Road | None:
    """Return a road; None where it has no geometry, as placeholders of some files have."""
    plan = node.child("planView")
    curves = tuple(_curve(one) for one in plan.children("geometry"))
    length_m = node.number("length")
    if not curves:
        return None
    if not 0.0 <= length_m <= LONGEST_M:
        raise node.fault(f"a road of {length_m:g} m is not supported; its length must be from 0 to {LONGEST_M:g} m")
    lanes = node.child("lanes")
    links = node.find("link")
    starts = [one.number("s") for one in lanes.children("laneSection")]
    ends = [*starts[1:], length_m]
    sections = tuple(
        _section(one, s_m, end_m) for one, s_m, end_m in zip(lanes.children("laneSection"), starts, ends, strict=True)
    )
    if not sections:
        raise node.fault(f"the road '{node.text('id')}' has no lane section; add one")
    junction = node.text("junction", "-1")
    return Road(
        node.text("id"),
        length_m,
        None if junction == "-1" else junction,
        curves,
        _profile(node.find("elevationProfile"), "elevation"),
        _profile(node.find("lateralProfile"), "superelevation"),
        _profile(lanes, "laneOffset"),
        sections,
        None if links is None else _link(links.find("predecessor")),
        None if links is None else _link(links.find("successor")),
        node.text("rule", "RHT") == "LHT",
        tuple((one.number("s", 0.0), _limit(one.find("speed"))) for one in node.children("type")),
    )


def _limit(node: Node | None) -> float | None:
    """Return a posted speed in m/s; None without a number, such as ``no limit``, or with an unknown unit."""
    try:
        value = math.nan if node is None else float(node.text("max"))
    except ValueError:
        return None
    unit = UNITS_MPS.get("" if node is None else node.text("unit", ""))
    return value * unit if unit is not None and 0.0 < value < math.inf else None


def _link(node: Node | None) -> Link | None:
    """Return what is at an end of a road."""
    if node is None:
        return None
    contact = node.text("contactPoint") if node.has("contactPoint") else None
    return Link(node.text("elementType"), node.text("elementId"), contact)


def _curve(node: Node) -> Curve:
    """Return a piece of a reference line."""
    s_m, length_m = node.number("s"), node.number("length")
    start = (node.number("x"), node.number("y"), node.number("hdg"))
    shape = node.only("userData")
    if shape.tag == "line":
        return Clothoid(s_m, *start, length_m)
    if shape.tag == "arc":
        return Clothoid(s_m, *start, length_m, shape.number("curvature"))
    if shape.tag == "spiral":
        first, last = shape.number("curvStart"), shape.number("curvEnd")
        return Clothoid(s_m, *start, length_m, first, (last - first) / length_m)
    if shape.tag == "poly3":
        return cubic_curve(s_m, start, length_m, (0.0, 1.0, 0.0, 0.0), _cubic(shape), None)
    if shape.tag == "paramPoly3":
        last_p = length_m if shape.text("pRange", "normalized") == "arcLength" else 1.0
        return cubic_curve(s_m, start, length_m, _cubic(shape, suffix="U"), _cubic(shape, suffix="V"), last_p)
    raise shape.fault(f"<{shape.tag}> is not supported as geometry; use line, arc, spiral, poly3 or paramPoly3")


def _section(node: Node, s_m: float, end_m: float) -> LaneSection:
    """Return a section of lanes."""
    lanes: dict[int, Lane] = {}
    for side in node.children("left", "center", "right"):
        for one in side.children("lane"):
            number, links = one.integer("id"), one.find("link")
            ends = [None if links is None else links.find(tag) for tag in ("predecessor", "successor")]
            before, after = (None if end is None else end.integer("id") for end in ends)
            heights = tuple(
                (height.number("sOffset", 0.0), height.number("inner"), height.number("outer"))
                for height in one.children("height")
            )
            width = _profile(one, "width", "sOffset")
            lanes[number] = Lane(number, one.text("type", "none"), width, heights, before, after)
    return LaneSection(s_m, end_m, lanes)


def _junction(node: Node) -> Junction:
    """Return the connections of a junction, in the order of the file."""
    found = []
    for one in node.children("connection"):
        links = {link.integer("from"): link.integer("to") for link in one.children("laneLink")}
        into = "linkedRoad" if one.has("linkedRoad") else "connectingRoad"  # direct junctions have no connecting roads
        if one.has("incomingRoad") and one.has(into):
            found.append(Connection(one.text("incomingRoad"), one.text(into), one.text("contactPoint"), links))
    return Junction(node.text("id"), tuple(found))
