"""Traffic lights and signs; lamps of streets and houses, and their manager."""

from typing import Any

import carla
import pytest

from every_method.call import Call
from every_method.calls.actors import after
from every_method.entries import fields
from every_method.stage import Stage

WARM = carla.Color(255, 200, 100)


def manager(stage: Stage) -> carla.LightManager:
    """The manager of the scene's lamps."""
    return stage.once("manager", stage.world.get_lightmanager)


def lamps(stage: Stage) -> list[carla.Light]:
    """The lamps of the scene."""
    found: list[carla.Light] = manager(stage).get_all_lights()
    return found


def lamp(stage: Stage) -> carla.Light:
    """One of them."""
    return lamps(stage)[0]


def flushed(stage: Stage, change: Any) -> None:
    """Change lamps; the client sends what has changed with its next tick."""
    change()
    stage.pass_frame()


def timed(stage: Stage, name: str) -> bool:
    """Whether a light takes another duration."""
    getattr(stage.light, f"set_{name}_time")(7.0)
    stage.tick(1)
    return bool(getattr(stage.light, f"get_{name}_time")() == pytest.approx(7.0))


def state(_: Stage) -> carla.LightState:
    """How a lamp shines."""
    return carla.LightState(50.0, WARM, carla.LightGroup.Street, True)


CALLS: dict[str, Call] = {
    "TrafficSign.trigger_volume": lambda s: s.light.trigger_volume.extent.x > 0.0,
    "TrafficLight.__str__": lambda s: "traffic.traffic_light" in str(s.light),
    "TrafficLight.state": lambda s: isinstance(s.light.state, carla.TrafficLightState),
    "TrafficLight.get_state": lambda s: s.light.get_state() == s.light.state,
    "TrafficLight.set_state": lambda s: after(
        s,
        lambda: s.light.set_state(carla.TrafficLightState.Yellow),
        lambda: s.light.state == carla.TrafficLightState.Yellow,
    ),
    "TrafficLight.get_green_time": lambda s: s.light.get_green_time() > 0.0,
    "TrafficLight.set_green_time": lambda s: timed(s, "green"),
    "TrafficLight.get_yellow_time": lambda s: s.light.get_yellow_time() > 0.0,
    "TrafficLight.set_yellow_time": lambda s: timed(s, "yellow"),
    "TrafficLight.get_red_time": lambda s: s.light.get_red_time() > 0.0,
    "TrafficLight.set_red_time": lambda s: timed(s, "red"),
    "TrafficLight.get_elapsed_time": lambda s: s.light.get_elapsed_time() >= 0.0,
    "TrafficLight.freeze": lambda s: after(s, lambda: s.light.freeze(True), s.light.is_frozen),
    "TrafficLight.is_frozen": lambda s: s.light.is_frozen(),
    "TrafficLight.reset_group": lambda s: s.light.reset_group(),
    "TrafficLight.get_pole_index": lambda s: s.light.get_pole_index() >= 0,
    "TrafficLight.get_group_traffic_lights": lambda s: (
        s.light.id in {found.id for found in s.light.get_group_traffic_lights()}
    ),
    "TrafficLight.get_affected_lane_waypoints": lambda s: len(s.light.get_affected_lane_waypoints()) > 0,
    "TrafficLight.get_stop_waypoints": lambda s: len(s.light.get_stop_waypoints()) > 0,
    "TrafficLight.get_light_boxes": lambda s: len(s.light.get_light_boxes()) > 0,
    "TrafficLight.get_opendrive_id": lambda s: len(s.light.get_opendrive_id()) > 0,
    "LightState.__init__": lambda _: carla.LightState().active is False,
    **fields("LightState", state, intensity=50.0, color=WARM, group=carla.LightGroup.Street, active=True),
    "LightManager.get_all_lights": lambda s: len(lamps(s)) > 0,
    "LightManager.get_turned_on_lights": lambda s: isinstance(
        manager(s).get_turned_on_lights(carla.LightGroup.Street), list
    ),
    "LightManager.get_turned_off_lights": lambda s: isinstance(
        manager(s).get_turned_off_lights(carla.LightGroup.Street), list
    ),
    "LightManager.turn_on": lambda s: flushed(s, lambda: manager(s).turn_on([lamp(s)])),
    "LightManager.is_active": lambda s: manager(s).is_active([lamp(s)]) == [True],
    "LightManager.turn_off": lambda s: flushed(s, lambda: manager(s).turn_off([lamp(s)])),
    "LightManager.set_active": lambda s: flushed(s, lambda: manager(s).set_active([lamp(s)], [True])),
    "LightManager.set_intensity": lambda s: flushed(s, lambda: manager(s).set_intensity([lamp(s)], 40.0)),
    "LightManager.set_intensities": lambda s: flushed(s, lambda: manager(s).set_intensities([lamp(s)], [30.0])),
    "LightManager.get_intensity": lambda s: manager(s).get_intensity([lamp(s)]) == [30.0],
    "LightManager.set_color": lambda s: flushed(s, lambda: manager(s).set_color([lamp(s)], carla.Color(1, 2, 3))),
    "LightManager.set_colors": lambda s: flushed(s, lambda: manager(s).set_colors([lamp(s)], [WARM])),
    "LightManager.get_color": lambda s: manager(s).get_color([lamp(s)]) == [WARM],
    "LightManager.set_light_group": lambda s: flushed(
        s, lambda: manager(s).set_light_group([lamp(s)], carla.LightGroup.Building)
    ),
    "LightManager.set_light_groups": lambda s: flushed(
        s, lambda: manager(s).set_light_groups([lamp(s)], [carla.LightGroup.Street])
    ),
    "LightManager.get_light_group": lambda s: manager(s).get_light_group([lamp(s)]) == [carla.LightGroup.Street],
    "LightManager.set_light_state": lambda s: flushed(s, lambda: manager(s).set_light_state([lamp(s)], state(s))),
    "LightManager.set_light_states": lambda s: flushed(s, lambda: manager(s).set_light_states([lamp(s)], [state(s)])),
    "LightManager.get_light_state": lambda s: manager(s).get_light_state([lamp(s)])[0].intensity == 50.0,
    "LightManager.set_day_night_cycle": lambda s: manager(s).set_day_night_cycle(False),
    **fields(
        "Light",
        lamp,
        id=lambda number: number >= 0,
        intensity=50.0,
        is_on=True,
        color=WARM,
        light_group=carla.LightGroup.Street,
        light_state=lambda found: found.intensity == 50.0,
        location=lambda place: isinstance(place, carla.Location),
    ),
    "Light.turn_off": lambda s: flushed(s, lambda: lamp(s).turn_off()),
    "Light.turn_on": lambda s: flushed(s, lambda: lamp(s).turn_on()),
    "Light.set_color": lambda s: flushed(s, lambda: lamp(s).set_color(carla.Color(9, 9, 9))),
    "Light.set_intensity": lambda s: flushed(s, lambda: lamp(s).set_intensity(20.0)),
    "Light.set_light_group": lambda s: flushed(s, lambda: lamp(s).set_light_group(carla.LightGroup.Street)),
    "Light.set_light_state": lambda s: flushed(s, lambda: lamp(s).set_light_state(state(s))),
}
