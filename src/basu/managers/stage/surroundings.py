"""Weather, friction and lights that a scenario changes, and gives back."""

from __future__ import annotations

import contextlib
import difflib
import math
from typing import TYPE_CHECKING

import carla

from basu.errors import ScenarioError
from basu.routing.route_weather import WEATHER_FIELDS

if TYPE_CHECKING:
    from collections.abc import Mapping

    from basu.scenarios.stage import Pose

LIGHT_STATES = {
    "Red": carla.TrafficLightState.Red,
    "Yellow": carla.TrafficLightState.Yellow,
    "Green": carla.TrafficLightState.Green,
    "Off": carla.TrafficLightState.Off,
}
TRIGGER_HEIGHT_M = 3.0  # of the box in which wheels feel the friction


class Surroundings:
    """Of one scenario."""

    def __init__(self, world: carla.World) -> None:
        self._world = world
        self._weather_before: carla.WeatherParameters | None = None
        self._patches: list[carla.Actor] = []
        self._lights: dict[str, carla.TrafficLight] = {}

    def set_weather(self, values: Mapping[str, float]) -> None:
        """Change fields of the weather.

        Raises:
            ScenarioError: weather has no such field.
        """
        weather = self._world.get_weather()
        if self._weather_before is None:
            self._weather_before = self._world.get_weather()
        self._world.set_weather(changed(weather, values))

    def set_friction(self, pose: Pose, radius_m: float, friction: float) -> None:
        """Make a square of the road slippery, ``radius_m`` to each side."""
        blueprint = self._world.get_blueprint_library().find("static.trigger.friction")
        blueprint.set_attribute("friction", str(friction))
        for axis, half_m in (("x", radius_m), ("y", radius_m), ("z", TRIGGER_HEIGHT_M)):
            blueprint.set_attribute(f"extent_{axis}", str(100.0 * half_m))  # CARLA's boxes are in cm here
        place = carla.Transform(
            carla.Location(pose.x_m, pose.y_m, pose.z_m), carla.Rotation(yaw=math.degrees(pose.yaw_rad))
        )
        self._patches.append(self._world.spawn_actor(blueprint, place))

    def set_light(self, landmark_id: str, state: str) -> None:
        """Let a traffic light show a state; all lights stand still until they are given back, as CARLA's freeze has it.

        Raises:
            ScenarioError: there is no such light or state.
        """
        if state not in LIGHT_STATES:
            raise ScenarioError(f"a traffic light cannot show '{state}'; it shows {', '.join(LIGHT_STATES)}")
        light = self._lights.get(landmark_id) or self._world.get_traffic_light_from_opendrive_id(landmark_id)
        if light is None:
            raise ScenarioError(f"the map has no traffic light whose OpenDRIVE signal is '{landmark_id}'")
        if not self._lights:
            light.freeze(True)
        self._lights[landmark_id] = light
        light.set_state(LIGHT_STATES[state])

    def give_back(self) -> None:
        """Leave everything as it was; where the simulator is gone, so is all this."""
        with contextlib.suppress(RuntimeError):
            for patch in self._patches:
                patch.destroy()
            if self._weather_before is not None:
                self._world.set_weather(self._weather_before)
            for light in self._lights.values():
                light.freeze(False)
                light.reset_group()
        self._patches, self._weather_before = [], None
        self._lights.clear()


def changed(weather: carla.WeatherParameters, values: Mapping[str, float]) -> carla.WeatherParameters:
    """``weather`` with some of its fields changed, in place.

    Raises:
        ScenarioError: weather has no such field.
    """
    for name, value in values.items():
        if name not in WEATHER_FIELDS:
            close = difflib.get_close_matches(name, WEATHER_FIELDS, 1)
            hint = f"did you mean '{close[0]}'?" if close else f"it has {', '.join(WEATHER_FIELDS)}"
            raise ScenarioError(f"weather has no '{name}'; {hint}")
        setattr(weather, name, value)
    return weather
