"""Cases in the form that CARLA's ScenarioRunner 0.9.16 reads, which is OpenSCENARIO 1.0 with rules of its own.

It takes no file of a later version, no variables and no identifiers of OpenDRIVE for lights. The storyboard is that of
``ordered_acts``.
"""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

import carla
import numpy as np

from basu.errors import ScenarioError
from basu.files import write_bytes
from basu_openscenario.exporting import timed_trajectory
from basu_openscenario.exporting.storyboard import LIGHTS

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping

RENAMED = {"VariableDeclarations": "ParameterDeclarations", "VariableDeclaration": "ParameterDeclaration"}
RENAMED |= {"VariableAction": "ParameterAction", "VariableCondition": "ParameterCondition"}
"""Elements that version 1.0 has under another name."""
ATTRIBUTES = {"variableType": "parameterType", "variableRef": "parameterRef", "model3d": "model"}
"""Attributes that it has under another name."""
VALUES = {
    ("priority", "override"): "overwrite",
    ("variableType", "int"): "integer",
    ("rule", "greaterOrEqual"): "greaterThan",
    ("rule", "lessOrEqual"): "lessThan",
    ("relativeDistanceType", "euclidianDistance"): "cartesianDistance",
}
"""Values that it has under another name; the rules differ by one moment."""
LATER = {
    "Vehicle": ("mass",),
    "DistanceCondition": ("coordinateSystem", "relativeDistanceType"),
    "RelativeDistanceCondition": ("coordinateSystem",),
}
"""Attributes that came later."""
CONTROLLER = f"{timed_trajectory.__name__.rpartition('.')[2]}.py"
CONTROLS = ("Throttle", "Brake", "Clutch", "ParkingBrake", "SteeringWheel")
"""Of ``OverrideControllerValueAction``, which version 1.0 asks for."""

AGAIN_M = 2.0
"""An actor that comes so near to a place has been there; more than ``timed_trajectory.REACH_M``."""
STEP_M = 0.25
"""How far apart the places are at which roads are looked for below a trajectory."""
BESIDE = (carla.LaneType.Sidewalk, carla.LaneType.Parking, carla.LaneType.Border)
"""The lanes beside the roads, on which things stand."""


def adapt(root: ET.Element, town: carla.Map, passed: Collection[str] = ()) -> None:
    """Change a scenario to what ScenarioRunner reads: version 1.0, heights, lights, controllers and the map's name.

    Args:
        root: of the document in version 1.2; changed in place.
        town: the map that the server has.
        passed: the actors that others pass through.

    Raises:
        ScenarioError: the map has no light of an identifier.
    """
    _to_first_version(root)
    name = town.name.rpartition("/")[2]
    for logic in root.iter("LogicFile"):
        logic.set("filepath", name)
    for place in root.iterfind(".//TeleportAction/Position/WorldPosition"):
        here = carla.Location(float(place.get("x", "nan")), -float(place.get("y", "nan")), 0.0)
        road = town.get_waypoint(here, project_to_road=True, lane_type=carla.LaneType.Any)
        place.set("z", f"{road.transform.location.z:.3f}")
    colours = {lamps: colour for colour, lamps in LIGHTS.items()}
    for light in root.iter("TrafficSignalStateAction"):
        light.set("name", _place_of(light.get("name", ""), town))
        light.set("state", colours[light.get("state", "")])
    for nth, condition in enumerate(root.iter("Condition")):
        condition.set("name", f"{condition.get('name')}, {nth + 1}")  # it takes two of one name for one and the same
    for actor in root.iterfind(".//Init/Actions/Private"):
        name = actor.get("entityRef", "")
        properties = {timed_trajectory.COLLISIONS: "false"} if name in passed else {}
        leaves = _leaves_roads(root, name, town)
        if leaves is not None:
            properties[timed_trajectory.COLLISIONS_END] = f"{leaves[0]:.2f},{leaves[1]:.2f}"
        actor.append(_controller(name, properties))


def _to_first_version(root: ET.Element) -> None:
    """Change a scenario of version 1.2 to one of version 1.0."""
    for header in root.iter("FileHeader"):
        header.set("revMinor", "0")
    for parent in root.findall(".//TrajectoryRef/.."):
        for nth, child in enumerate(parent):
            if child.tag == "TrajectoryRef":
                parent[nth] = child[0]
    for condition in root.iter("DistanceCondition"):
        condition.set("alongRoute", "false")
    for element in root.iter():
        element.tag = RENAMED.get(element.tag, element.tag)
        for name in LATER.get(element.tag, ()):
            element.attrib.pop(name, None)
        for name, value in list(element.items()):
            del element.attrib[name]
            element.set(ATTRIBUTES.get(name, name), VALUES.get((name, value), value))


def write_controller(folder: Path) -> None:
    """Write the controller of the file beside it."""
    write_bytes(folder / CONTROLLER, Path(timed_trajectory.__file__).read_bytes())


def _place_of(landmark: str, town: carla.Map) -> str:
    """Return the place of a light as ScenarioRunner names it.

    Raises:
        ScenarioError: the map has none.
    """
    found = town.get_all_landmarks_from_id(landmark)
    if not found:
        raise ScenarioError(f"the map has no light {landmark}")
    here = found[0].transform.location
    return f"pos={here.x:.2f},{here.y:.2f}"


def _leaves_roads(root: ET.Element, actor: str, town: carla.Map) -> tuple[float, float] | None:
    """Return the place, x and y in m in CARLA's axes, at which an actor leaves the roads for good, or None.

    A rehearsal has no houses, posts, trees and parked cars, so that a body which rolls off the road may go through
    one. For vehicles, pavements, their borders and parking lanes are no part of the roads. A place at which the actor
    has been before, as in a driveway, is none.
    """
    drives = root.find(f".//ScenarioObject[@name='{actor}']/Vehicle") is not None
    places = list(_places_of(root, actor))
    found = len(places)
    for x_m, y_m in reversed(places):
        lane = town.get_waypoint(carla.Location(x_m, y_m, 0.0), project_to_road=False, lane_type=carla.LaneType.Any)
        if lane is not None and not (drives and lane.lane_type in BESIDE):
            break
        found -= 1
    if found == len(places):
        return None
    apart_m = np.hypot(*(np.array(places[: found + 1]) - places[found]).T)
    left = np.flatnonzero(apart_m > AGAIN_M)
    return places[found] if len(left) and (apart_m[: left[-1]] > AGAIN_M).all() else None


def _places_of(root: ET.Element, actor: str) -> Iterator[tuple[float, float]]:
    """Yield the places of an actor's trajectories in order, at most ``STEP_M`` apart, in m in CARLA's axes."""
    for group in root.iter("ManeuverGroup"):
        entity = group.find("Actors/EntityRef")
        if entity is None or entity.get("entityRef") != actor:
            continue
        vertices = [
            (float(place.get("x", "nan")), -float(place.get("y", "nan")))
            for place in group.iterfind(".//Vertex/Position/WorldPosition")
        ]
        for one, other in itertools.pairwise(vertices):
            parts = max(math.ceil(math.dist(one, other) / STEP_M), 1)
            for share in np.arange(parts) / parts:
                yield one[0] + share * (other[0] - one[0]), one[1] + share * (other[1] - one[1])


def _controller(actor: str, own: Mapping[str, str]) -> ET.Element:
    """Return the action that gives an actor the controller beside the file, with further properties."""
    action = ET.Element("PrivateAction")
    both = ET.SubElement(action, "ControllerAction")
    controller = ET.SubElement(ET.SubElement(both, "AssignControllerAction"), "Controller", {"name": f"of {actor}"})
    properties = ET.SubElement(controller, "Properties")
    ET.SubElement(properties, "Property", {"name": "module", "value": CONTROLLER})
    for name, value in own.items():
        ET.SubElement(properties, "Property", {"name": name, "value": value})
    override = ET.SubElement(both, "OverrideControllerValueAction")
    for control in CONTROLS:
        ET.SubElement(override, control, {"value": "0", "active": "false"})
    ET.SubElement(override, "Gear", {"number": "0", "active": "false"})
    return action
