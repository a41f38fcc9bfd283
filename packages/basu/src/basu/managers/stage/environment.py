"""Weather, friction and lights that scenarios change, several at a time, and their restoration.

A scenario's changes lie over those of earlier scenarios, and end with it. An ending scenario takes nothing from the
others; the last one to end leaves the world as it was.
"""

from __future__ import annotations

import contextlib
import math
from typing import TYPE_CHECKING, NamedTuple

import carla

from basu.errors import ScenarioError
from basu.managers.base_manager import WorldChanges
from basu.managers.stage.scenario_actors import destroy_actors
from basu.routing.weather import WEATHER_FIELDS, changed

if TYPE_CHECKING:
    from collections.abc import Mapping

    from basu.scenarios.stage import Pose


LIGHT_STATES = {
    "Red": carla.TrafficLightState.Red,
    "Yellow": carla.TrafficLightState.Yellow,
    "Green": carla.TrafficLightState.Green,
    "Off": carla.TrafficLightState.Off,
}


class Wish(NamedTuple):
    """A traffic light with its requested state."""

    light: carla.TrafficLight
    state: carla.TrafficLightState


class SharedWorld:
    """One for a run; scenarios are distinguished by their names."""

    def __init__(self, world: carla.World, changes: WorldChanges | None = None) -> None:
        """``changes`` are the run's: what the route sets is read there, and what scenarios set is written there."""
        self._world, self.changes = world, changes or WorldChanges()
        self._weather: dict[str, dict[str, float]] = {}  # what each asks for, in the order of asking
        self._beneath: carla.WeatherParameters | None = None  # the weather without any scenario
        self._shown: carla.WeatherParameters | None = None  # what was set last
        self._lights: dict[str, dict[str, Wish]] = {}  # likewise, by the OpenDRIVE signal's id

    def ask_weather(self, scenario: str, values: Mapping[str, float]) -> None:
        """Change fields of the weather.

        Raises:
            ScenarioError: weather has no such field.
        """
        changed(carla.WeatherParameters(), values)
        if not self._weather:
            self._beneath = self.changes.weather or self._world.get_weather()
        self._weather.setdefault(scenario, {}).update(values)
        self._show_weather()

    def keep_up(self) -> None:
        """Lay the scenarios' weather over that of the route, where the route has set it meanwhile."""
        if self._weather and self.changes.weather is not self._shown:
            self._beneath = self.changes.weather
            self._show_weather()

    def ask_light(self, scenario: str, landmark_id: str, state: str) -> None:
        """Let a traffic light show a state; all lights stand still until they are given back, as CARLA's freeze has it.

        Raises:
            ScenarioError: there is no such light or state.
        """
        if state not in LIGHT_STATES:
            raise ScenarioError(f"a traffic light cannot show '{state}'; it shows {', '.join(LIGHT_STATES)}")
        light = self._world.get_traffic_light_from_opendrive_id(landmark_id)
        if light is None:
            raise ScenarioError(f"the map has no traffic light with the OpenDRIVE signal '{landmark_id}'")
        if not self._lights:
            light.freeze(True)
        wishes = self._lights.setdefault(scenario, {})
        wishes[landmark_id] = Wish(light, LIGHT_STATES[state])
        light.set_state(LIGHT_STATES[state])

    def give_back(self, scenario: str) -> None:
        """Undo the changes of one of them; where the simulator is gone, so is all this."""
        weather, lights = self._weather.pop(scenario, None), self._lights.pop(scenario, {})
        with contextlib.suppress(RuntimeError):
            if weather is not None:
                self._show_weather()
            for landmark_id, wish in lights.items():
                others = [wishes[landmark_id] for wishes in self._lights.values() if landmark_id in wishes]
                if others:
                    wish.light.set_state(others[-1].state)
                else:
                    wish.light.reset_group()
            if lights and not self._lights:
                next(iter(lights.values())).light.freeze(False)

    def _show_weather(self) -> None:
        """Set the weather beneath with the changes of all scenarios."""
        assert self._beneath is not None, "a scenario has changed the weather"
        weather = carla.WeatherParameters(**{name: getattr(self._beneath, name) for name in WEATHER_FIELDS})
        for values in self._weather.values():
            changed(weather, values)
        self._world.set_weather(weather)
        self._shown = self.changes.weather = weather


TRIGGER_HEIGHT_M = 3.0  # of the box in which wheels feel the friction


class Surroundings:
    """The changes of one ``scenario``; it shares weather and lights with the others of its run."""

    def __init__(self, client: carla.Client, world: carla.World, shared: SharedWorld, scenario: str) -> None:
        self._client, self._world, self._shared, self._scenario = client, world, shared, scenario
        self._patches: list[carla.Actor] = []

    def set_weather(self, values: Mapping[str, float]) -> None:
        """Change fields of the weather.

        Raises:
            ScenarioError: weather has no such field.
        """
        self._shared.ask_weather(self._scenario, values)

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
        """Let a traffic light show a state and stay so.

        Raises:
            ScenarioError: there is no such light or state.
        """
        self._shared.ask_light(self._scenario, landmark_id, state)

    def give_back(self) -> None:
        """Leave everything as it was; where the simulator is gone, so is all this."""
        destroy_actors(self._client, self._patches)
        self._patches = []
        self._shared.give_back(self._scenario)
