"""Claims about oddities of the official client that look like the server's; docs/supported.md lists them."""

import carla
import pytest

from every_method.outcome import RECORD, from_json
from spawn_points import spawn_point


def test_a_torque_is_sent_as_an_angular_impulse() -> None:
    record = from_json(RECORD.read_text("utf-8"))
    assert record["Actor.add_torque"].functions == ("add_actor_angular_impulse",)


def test_freezing_one_light_freezes_all(world: carla.World) -> None:
    lights = list(world.get_actors().filter("traffic.traffic_light"))
    lights[0].freeze(True)
    world.tick()
    assert len(lights) > 1
    assert all(light.is_frozen() for light in lights)
    lights[0].freeze(False)


def test_a_command_for_lamps_that_is_given_an_actor_knows_on_and_off_only(world: carla.World) -> None:
    car = world.spawn_actor(world.get_blueprint_library().find("vehicle.lincoln.mkz_2020"), spawn_point(world, 0))
    world.tick()
    fog = carla.VehicleLightState.Fog
    assert int(carla.command.SetVehicleLightState(car, fog).light_state) == 1
    assert int(carla.command.SetVehicleLightState(car.id, fog).light_state) == int(fog)


def test_map_layers_that_are_joined_are_no_map_layers() -> None:
    assert not isinstance(carla.MapLayer.Buildings | carla.MapLayer.Walls, carla.MapLayer)


def test_telemetry_that_a_script_makes_forgets_its_drag() -> None:
    assert carla.VehicleTelemetryData(drag=2.0).drag == pytest.approx(0.0)
