"""Reads cases from ScenarioRunner's XML, with this project's additional elements.

::

    <scenarios>
      <scenario name="pedestrian_crossing_1" type="PedestrianCrossing" town="Linden">
        <place name="Cleveland Ave at 8th Ave" route="true"/>
        <ego_vehicle x="1.0" y="2.0" z="0.5" yaw="90" model="vehicle.easymile.ez10"/>
        <via x="1.0" y="40.0"/> <stop name="8th Ave" x="1.0" y="60.0"/> <destination x="1.0" y="120.0"/>
        <trigger_point x="1.0" y="30.0" z="0.5" yaw="90"/>
        <other_actor x="5.0" y="60.0" yaw="180" model="walker.*" rolename="child"/>
        <weather cloudiness="80" precipitation="60"/>
        <speed value="1.4"/> <ahead low="20" high="35"/> <side among="left opposite"/>
      </scenario>
    </scenarios>

Theirs are <ego_vehicle>, <other_actor>, <weather>, <route> and values as elements of their own. Ours are <place>,
<via>, <stop> (a service stop), <destination>, <trigger_point> and <characteristics>, and ``low``, ``high`` and
``among``, which narrow a parameter at its place. Coordinates are CARLA's: metres, y south, yaw in degrees clockwise.
"""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

from lxml import etree

from basu.errors import ScenarioError
from basu.routing.route_file import RoutePoint, StopMark
from basu.scenarios.stage import EGO
from basu.scenarios.xml_elements import (
    POINT_ATTRIBUTES,
    Case,
    attributes_of,
    complaint,
    ego_of,
    only,
    other_of,
    parts_of,
    pose_of,
    text_of,
    values_of,
    weather_of,
    where,
)

if TYPE_CHECKING:
    from pathlib import Path

    from basu.scenarios.stage import Pose
    from basu.scenarios.xml_elements import GivenActor


ONCE = ("ego_vehicle", "route", "destination", "trigger_point", "weather", "place", "characteristics")
RESERVED = frozenset({*ONCE, "other_actor", "via", "stop"})  # no parameter can be called so
NAME = re.compile(r"[A-Za-z0-9._-]+")  # of a case: it names a folder, and ':' begins what is sampled
AT_THE_EGO_M = 2.0  # a first way point so near to the ego is where it stands


def read_cases(path: Path) -> tuple[Case, ...]:
    """Every case of a file, in its order. Types and parameters are checked where classes are known (``library``).

    Raises:
        ScenarioError: the file cannot be read or is no scenario XML, an element lacks what it needs or has what is
            not read, or two cases have one name.
    """
    root = _root(path)
    elements = [root] if root.tag == "scenario" else [part for part in parts_of(root) if part.tag == "scenario"]
    if not elements:
        raise ScenarioError(f"{path}: <{root.tag}> holds no <scenario>; a case is <scenario name type town>")
    cases = tuple(_case(element, path) for element in elements)
    first: dict[str, str] = {}
    for case in cases:
        if case.name in first:
            raise ScenarioError(f"{case.source}: the name '{case.name}' is given in {first[case.name]} already; rename")
        first[case.name] = case.source
    return cases


def _root(path: Path) -> etree._Element:
    """The outermost element of a scenario file."""
    try:
        text = path.read_bytes()
    except OSError as error:
        raise ScenarioError(
            f"the scenario file {path} cannot be read ({error.strerror}); `basu scenario list` shows those of BASU"
        ) from error
    if not text.strip():
        raise ScenarioError(f"the scenario file {path} is empty; it needs <scenarios><scenario name type town>…")
    try:
        root = etree.fromstring(text, etree.XMLParser(resolve_entities=False, no_network=True))
    except etree.XMLSyntaxError as error:
        raise ScenarioError(f"the scenario file {path} is not XML: {error.msg}") from error
    if root.tag in {"routes", "route"}:
        raise ScenarioError(
            f"{path} is a route file (<{root.tag}>); drive it with `basu run --routes {path.name}`, scenarios and all"
        )
    if root.tag not in {"scenarios", "scenario"}:
        kind = "OpenSCENARIO, which is not read; " if root.tag == "OpenSCENARIO" else ""
        raise ScenarioError(
            f"{path}, line {root.sourceline}: the outermost element is <{root.tag}>; {kind}a scenario file is "
            "<scenarios><scenario name type town>…"
        )
    return root


def _case(element: etree._Element, path: Path) -> Case:
    """One ``<scenario>``."""
    only(element, ("name", "type", "town"), path)
    name, kind, town = (text_of(element, attribute, path) for attribute in ("name", "type", "town"))
    if not NAME.fullmatch(name):
        raise complaint(
            element,
            path,
            f"has the name '{name}'; letters, digits, '_', '-' and '.' may stand in it: it names a folder",
        )
    parts = parts_of(element)
    once = {tag: _at_most_one([part for part in parts if part.tag == tag], path) for tag in ONCE}
    ego, trigger, weather, place = (once[tag] for tag in ("ego_vehicle", "trigger_point", "weather", "place"))
    if ego is None:
        raise complaint(
            element, path, f"'{name}' has no <ego_vehicle x y z yaw model/>; it says where the drive begins"
        )
    driver = ego_of(ego, path)
    stated = once["characteristics"]
    if trigger is not None:
        only(trigger, POINT_ATTRIBUTES, path)
    if place is not None:
        only(place, ("name", "route"), path)
    return Case(
        name=name,
        type=kind,
        town=town,
        ego=driver,
        others=_others(parts, path),
        way=_way(once["route"], once["destination"], [part for part in parts if part.tag == "via"], driver, path),
        stops=tuple(_stop(part, path) for part in parts if part.tag == "stop"),
        trigger=None if trigger is None else pose_of(trigger, path, yaw=True),
        weather=None if weather is None else weather_of(weather, path),
        values=values_of([part for part in parts if part.tag not in RESERVED], path),
        characteristics={} if stated is None else attributes_of(stated),
        place="" if place is None else text_of(place, "name", path),
        on_route=place is not None and _yes(place, "route", path),
        source=where(element, path),
    )


def _at_most_one(elements: list[etree._Element], path: Path) -> etree._Element | None:
    """The one there is, None where there is none."""
    if len(elements) > 1:
        words = f"stands {len(elements)} times in one <scenario>; one is read, leave the one that is meant"
        if elements[0].tag == "ego_vehicle":
            words = f"stands {len(elements)} times in one <scenario>; one vehicle is under test here: make it {EGO}'s, "
            words += "and each other one an <other_actor> or a case of its own"
        raise complaint(elements[1], path, words)
    return elements[0] if elements else None


def _others(parts: list[etree._Element], path: Path) -> tuple[GivenActor, ...]:
    """The ``<other_actor>`` elements in their order."""
    return tuple(other_of(part, path) for part in parts if part.tag == "other_actor")


def _stop(element: etree._Element, path: Path) -> StopMark:
    """A service stop, by its name."""
    only(element, ("name", "x", "y", "z"), path)
    name, pose = text_of(element, "name", path), pose_of(element, path, yaw=False)
    return StopMark(id=name, name=name, point=RoutePoint(pose.x_m, pose.y_m, pose.z_m))


def _way(
    route: etree._Element | None,
    destination: etree._Element | None,
    vias: list[etree._Element],
    ego: GivenActor,
    path: Path,
) -> tuple[Pose, ...]:
    """The points after the ego's place: of a ``<route>``, or ``<via>`` and ``<destination>``; none where none is given.

    What ``connection`` a way point of ScenarioRunner's has is not needed: the way between them is found on the map.
    """
    if route is not None and (destination is not None or vias):
        raise complaint(route, path, "and <destination> both say where the ego is bound for; leave one")
    if destination is None and vias:
        raise complaint(vias[0], path, 'is on the way to nowhere; add <destination x="…" y="…"/>')
    if route is None:
        ends = [] if destination is None else [destination]
        for point in (*vias, *ends):
            only(point, ("x", "y", "z"), path)
        return tuple(pose_of(point, path, yaw=False) for point in (*vias, *ends))
    for point in parts_of(route):
        only(point, (*POINT_ATTRIBUTES, "connection"), path)
    points = [pose_of(part, path, yaw=False) for part in parts_of(route) if part.tag in {"waypoint", "position"}]
    if points and math.hypot(points[0].x_m - ego.pose.x_m, points[0].y_m - ego.pose.y_m) < AT_THE_EGO_M:
        points = points[1:]
    if not points:
        raise complaint(route, path, "has no way point behind the ego's place; it needs one <waypoint x y z/> or more")
    return tuple(points)


def _yes(element: etree._Element, name: str, path: Path) -> bool:
    """An attribute that is true or false; false where it is absent."""
    text = element.get(name, "false")
    if text not in {"true", "false"}:
        raise complaint(element, path, f"has {name}='{text}'; write true or false")
    return text == "true"
