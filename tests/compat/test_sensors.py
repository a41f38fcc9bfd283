"""GNSS and inertial unit through the official client."""

import queue
from itertools import pairwise

import carla
import pytest

from spawn_points import spawn_point

FRAMES = 10


def attached(world: carla.World, name: str, **attributes: str) -> tuple[carla.Sensor, "queue.Queue[carla.SensorData]"]:
    library = world.get_blueprint_library()
    point = spawn_point(world, 100)
    car = world.spawn_actor(library.find("vehicle.tesla.model3"), point)
    for _ in range(40):
        world.tick()
    blueprint = library.find(name)
    for key, value in attributes.items():
        blueprint.set_attribute(key, value)
    sensor = world.spawn_actor(blueprint, carla.Transform(carla.Location(z=1.0)), attach_to=car)
    readings: queue.Queue[carla.SensorData] = queue.Queue()
    sensor.listen(readings.put)
    return sensor, readings


def read(world: carla.World, readings: "queue.Queue[carla.SensorData]", frames: int = FRAMES) -> list[carla.SensorData]:
    """Tick until that many readings have come: the first ticks may pass before the subscription stands."""
    found = []
    for _ in range(10 * frames):
        world.tick()
        try:
            found.append(readings.get(timeout=0.5))
        except queue.Empty:
            continue
        if len(found) == frames:
            return found
    raise AssertionError(f"{len(found)} readings of {frames}")


def test_gnss_agrees_with_the_clients_own_conversion(world) -> None:
    sensor, readings = attached(world, "sensor.other.gnss")
    reading = read(world, readings)[-1]
    expected = world.get_map().transform_to_geolocation(sensor.get_location())
    assert reading.latitude == pytest.approx(expected.latitude, abs=1e-9)
    assert reading.longitude == pytest.approx(expected.longitude, abs=1e-9)
    assert reading.altitude == pytest.approx(sensor.get_location().z, abs=1e-3)
    sensor.stop()


def test_an_inertial_unit_at_rest_feels_gravity(world) -> None:
    sensor, readings = attached(world, "sensor.other.imu")
    reading = read(world, readings)[-1]
    assert reading.accelerometer.z == pytest.approx(9.81, abs=0.05)
    assert reading.gyroscope.length() < 1e-3
    sensor.stop()


def test_measurements_are_in_step_with_the_tick(world) -> None:
    sensor, readings = attached(world, "sensor.other.gnss")
    frames = [reading.frame for reading in read(world, readings)]
    assert frames == list(range(frames[0], frames[0] + FRAMES))
    assert frames[-1] == world.get_snapshot().frame
    sensor.stop()


def test_sensor_tick_thins_the_measurements(world) -> None:
    sensor, readings = attached(world, "sensor.other.gnss", sensor_tick="0.2")
    read(world, readings, 1)
    for _ in range(40):
        world.tick()
    frames = [readings.get(timeout=2.0).frame for _ in range(10)]
    assert {later - earlier for earlier, later in pairwise(frames)} == {4}
    sensor.stop()


def test_noise_has_the_deviation_asked_for(world) -> None:
    sensor, readings = attached(world, "sensor.other.gnss", noise_alt_stddev="2.0", noise_seed="7")
    altitudes = [reading.altitude for reading in read(world, readings, 200)]
    mean = sum(altitudes) / len(altitudes)
    deviation = (sum((value - mean) ** 2 for value in altitudes) / len(altitudes)) ** 0.5
    assert deviation == pytest.approx(2.0, rel=0.2)
    sensor.stop()
