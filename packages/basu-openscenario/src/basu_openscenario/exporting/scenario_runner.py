"""Cases in the form that CARLA's ScenarioRunner 0.9.16 reads, which is OpenSCENARIO 1.0 with rules of its own.

It takes no file of a later version, no variables and no identifiers of OpenDRIVE for lights. It looks at a condition
with a delay after the delay, not for the moment so long ago; such delays become events, or are refused.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

import carla
from scenariogeneration import xosc

from basu.errors import ScenarioError
from basu.files import write_bytes
from basu_openscenario.exporting import timed_trajectory
from basu_openscenario.exporting.conditions import ExportedTest
from basu_openscenario.exporting.storyboard import LIGHTS, StoryboardWriter

if TYPE_CHECKING:
    from basu_openscenario.exporting.conditions import Tests
    from basu_openscenario.exporting.motions import Motion
    from basu_openscenario.exporting.phases import Guard

RENAMED = {"VariableDeclarations": "ParameterDeclarations", "VariableDeclaration": "ParameterDeclaration"}
RENAMED |= {"VariableAction": "ParameterAction"}
"""Elements that version 1.0 has under another name."""
ATTRIBUTES = {"variableType": "parameterType", "variableRef": "parameterRef", "model3d": "model"}
"""Attributes that it has under another name."""
VALUES = {
    ("priority", "override"): "overwrite",
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


class ScenarioRunnerWriter(StoryboardWriter):
    """Writes the storyboard without moments that lie some time ago."""

    def _begin(self, motion: Motion, before: str) -> Tests:
        """Return the tests for the begin of a motion; one after another begins when the event of that is over."""
        if motion.late_s and motion.guard is not None:
            return ((_over(self._event_of(before)),),)
        return super()._begin(motion, before)

    def _leaves(self, motion: Motion, name: str) -> Tests:
        """Return the tests for the departure of an actor, which follows its last motion."""
        if motion.guard is not None:
            return ((_over(self._event_of(name)),),)
        return super()._leaves(motion, name)

    def _light_due(self, guard: Guard | None, later_s: float) -> Tests:
        """Return the tests for a change of a light.

        Raises:
            ScenarioError: it comes some time after a trigger.
        """
        if guard is not None and later_s > self.case.step_s:
            raise ScenarioError("a light that changes some time after a trigger has no counterpart in ScenarioRunner")
        return super()._light_due(guard, later_s)

    def _event_of(self, name: str) -> str:
        """Return an event of a motion.

        Raises:
            ScenarioError: the actor stands in that part, so that there is no event.
        """
        if name not in self.begins_s:
            raise ScenarioError("a wait of some time after a trigger has no counterpart in ScenarioRunner")
        return name


def _over(event: str) -> ExportedTest:
    """Return the test whether an event is over."""
    done = xosc.StoryboardElementState.completeState
    return ExportedTest(None, xosc.StoryboardElementStateCondition(xosc.StoryboardElementType.event, event, done))


def adapt(root: ET.Element, town: carla.Map) -> None:
    """Change a scenario to what ScenarioRunner reads: version 1.0, heights, lights, controllers and the map's name.

    Args:
        root: of the document in version 1.2; changed in place.
        town: the map that the server has.

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
        actor.append(_controller(actor.get("entityRef", "")))


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


def _controller(actor: str) -> ET.Element:
    """Return the action that gives an actor the controller beside the file."""
    action = ET.Element("PrivateAction")
    both = ET.SubElement(action, "ControllerAction")
    controller = ET.SubElement(ET.SubElement(both, "AssignControllerAction"), "Controller", {"name": f"of {actor}"})
    ET.SubElement(ET.SubElement(controller, "Properties"), "Property", {"name": "module", "value": CONTROLLER})
    override = ET.SubElement(both, "OverrideControllerValueAction")
    for control in CONTROLS:
        ET.SubElement(override, control, {"value": "0", "active": "false"})
    ET.SubElement(override, "Gear", {"number": "0", "active": "false"})
    return action
