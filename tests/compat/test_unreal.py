"""Claims about what only Unreal could do: it is refused by a sentence, in the client or in the log."""

import carla
import pytest

from servers import RunningServer
from spawn_points import spawn_point


def sensor(world: carla.World) -> carla.Sensor:
    spawned = world.spawn_actor(world.get_blueprint_library().find("sensor.other.imu"), carla.Transform())
    world.tick()
    return spawned


def test_buffers_of_the_renderer_are_refused_with_what_there_is_instead(world: carla.World) -> None:
    imu = sensor(world)
    with pytest.raises(RuntimeError, match=r"textures inside Unreal's renderer.*sensor\.camera\.depth"):
        imu.enable_gbuffers(True)
    imu.enable_gbuffers(False)


def test_without_a_publisher_the_log_says_how_to_start_one(world: carla.World, server: RunningServer) -> None:
    imu = sensor(world)
    imu.enable_for_ros()
    assert not imu.is_enabled_for_ros()
    assert "start it with `linden serve --ros2`, which needs: pip install linden-ros2" in server.log()
    imu.disable_for_ros()


def test_vehicles_to_be_ignored_must_be_vehicles(world: carla.World) -> None:
    imu = sensor(world)
    vehicle = world.spawn_actor(world.get_blueprint_library().find("vehicle.tesla.model3"), spawn_point(world, 0))
    imu.set_ignored_vehicles([vehicle.id])
    expected = rf"set_ignored_vehicles: Actor does not match the expected type\.  Actor Id: {imu.id}"
    with pytest.raises(RuntimeError, match=expected):
        imu.set_ignored_vehicles([imu.id])
    with pytest.raises(RuntimeError, match="could not be found in the registry"):
        imu.set_ignored_vehicles([4_000_000])
