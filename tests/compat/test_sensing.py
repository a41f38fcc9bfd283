"""Lidars, radar and obstacle detector as the official client receives them."""

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import carla
import numpy as np
import pytest

from spawn_points import spawn_point

RANGE_M = 60


@pytest.fixture
def ego(world: carla.World) -> carla.Actor:
    """A car that stands, handbrake on."""
    car = world.spawn_actor(world.get_blueprint_library().find("vehicle.tesla.model3"), spawn_point(world, 0))
    car.apply_control(carla.VehicleControl(hand_brake=True))
    world.tick(60.0)  # from now on the client knows where it is
    return car


def ahead(world: carla.World, actor: carla.Actor, distance_m: float, type_id: str) -> carla.Actor:
    pose = actor.get_transform()
    place = pose.location + pose.get_forward_vector() * distance_m
    place.z += 0.3
    return world.spawn_actor(world.get_blueprint_library().find(type_id), carla.Transform(place, pose.rotation))


@contextmanager
def listening(
    world: carla.World,
    ego: carla.Actor,
    type_id: str,
    read: Callable[[carla.SensorData], object],
    place: carla.Location,
    **chosen: object,
) -> Iterator[list]:
    """What a sensor on ``ego`` sends, as plain values: the client's own objects must not outlive their episode."""
    blueprint = world.get_blueprint_library().find(type_id)
    for name, value in chosen.items():
        blueprint.set_attribute(name, str(value))
    sensor = world.spawn_actor(blueprint, carla.Transform(place), attach_to=ego)
    got: list = []
    sensor.listen(lambda data: got.append((data.frame, read(data))))
    try:
        yield got
    finally:
        sensor.stop()
        for _ in range(3):
            world.tick()
        sensor.destroy()


def until(world: carla.World, got: list, count: int) -> None:
    for _ in range(200):
        if len(got) >= count:
            return
        world.tick(60.0)
    pytest.fail(f"{len(got)} measurements after 200 frames, expected {count}")


def test_a_whole_turn_of_the_lidar_comes_in_step_and_lies_about_the_car(world: carla.World, ego: carla.Actor) -> None:
    def read(data: carla.LidarMeasurement):
        points = np.frombuffer(data.raw_data, np.float32).reshape(-1, 4).copy()
        counts = [data.get_point_count(channel) for channel in range(data.channels)]
        return counts, points, data.transform.location.z, data.horizontal_angle

    lidar = {
        "channels": 16,
        "points_per_second": 64_000,
        "rotation_frequency": 20,
        "range": RANGE_M,
        "dropoff_general_rate": 0,
    }
    with listening(world, ego, "sensor.lidar.ray_cast", read, carla.Location(z=2.4), **lidar) as got:
        until(world, got, 3)
    frames = [frame for frame, _ in got]
    assert np.diff(frames).tolist() == [1] * (len(got) - 1)
    counts, points, height_m, angle = got[-1][1]
    assert len(counts) == 16
    assert sum(counts) == len(points) > 1_000
    assert max(counts) <= 200
    assert angle == pytest.approx(0.0, abs=1e-6)
    assert np.linalg.norm(points[:, :3], axis=1).max() <= RANGE_M + 1e-3
    down = points[points[:, 2] < -2.0]
    assert np.median(down[:, 2]) == pytest.approx(-height_m + ego.get_location().z, abs=0.3)


def test_the_semantic_lidar_knows_the_car_ahead_by_its_id(world: carla.World, ego: carla.Actor) -> None:
    other = ahead(world, ego, 10.0, "vehicle.audi.tt")

    def read(data: carla.SemanticLidarMeasurement):
        return [(point.object_idx, point.object_tag, point.point.x, point.cos_inc_angle) for point in data]

    with listening(
        world, ego, "sensor.lidar.ray_cast_semantic", read, carla.Location(z=2.0), range=RANGE_M, rotation_frequency=20
    ) as got:
        until(world, got, 2)
    mine = [point for point in got[-1][1] if point[0] == other.id]
    assert len(mine) > 5
    assert {tag for _, tag, _, _ in mine} <= {int(carla.CityObjectLabel.Car)}
    assert all(10.0 - 2.6 < x < 10.0 + 2.6 for _, _, x, _ in mine)
    assert all(0.0 <= cosine <= 1.0 for *_, cosine in got[-1][1])
    assert int(carla.CityObjectLabel.Roads) in {tag for _, tag, _, _ in got[-1][1]}


def test_the_radar_reads_how_fast_the_car_ahead_goes_away(world: carla.World, ego: carla.Actor) -> None:
    other = ahead(world, ego, 12.0, "vehicle.audi.tt")
    other.enable_constant_velocity(carla.Vector3D(x=4.0))

    def read(data: carla.RadarMeasurement):
        return [(ray.velocity, ray.azimuth, ray.altitude, ray.depth) for ray in data]

    with listening(
        world,
        ego,
        "sensor.other.radar",
        read,
        carla.Location(x=2.4, z=0.7),
        horizontal_fov=8,
        vertical_fov=4,
        points_per_second=4000,
    ) as got:
        until(world, got, 12)  # until it has come down onto the street
    speed_mps = other.get_velocity().length()
    assert speed_mps == pytest.approx(4.0, rel=0.02)
    on_car = [ray for ray in got[-1][1] if 5.0 < ray[3] < 11.5]
    assert len(on_car) > 20
    for velocity, azimuth, altitude, _ in on_car:
        assert velocity == pytest.approx(speed_mps * math.cos(azimuth) * math.cos(altitude), abs=0.2)


def test_the_obstacle_detector_names_what_is_ahead(world: carla.World, ego: carla.Actor) -> None:
    other = ahead(world, ego, 10.0, "vehicle.audi.tt")

    def read(data: carla.ObstacleDetectionEvent):
        return data.other_actor.id, data.other_actor.type_id, data.distance

    with listening(
        world, ego, "sensor.other.obstacle", read, carla.Location(x=1.0, z=0.9), distance=20, hit_radius=0.3
    ) as got:
        until(world, got, 2)
    actor_id, type_id, distance_m = got[-1][1]
    assert (actor_id, type_id) == (other.id, "vehicle.audi.tt")
    assert distance_m == pytest.approx(10.0 - 2.1 - 1.0 - 0.3, abs=0.5)


def test_with_a_sensor_tick_the_lidar_comes_seldom_and_brings_all_points_since(
    world: carla.World, ego: carla.Actor
) -> None:
    def read(data: carla.SemanticLidarMeasurement):
        return data.timestamp, len(data)

    down = {"channels": 1, "upper_fov": -30, "points_per_second": 10_000, "range": RANGE_M}
    with listening(
        world, ego, "sensor.lidar.ray_cast_semantic", read, carla.Location(z=2.4), sensor_tick=0.2, **down
    ) as got:
        until(world, got, 3)
    times_s = [time_s for _, (time_s, _) in got]
    assert np.diff(times_s).tolist() == pytest.approx([0.2] * (len(got) - 1))
    assert got[-1][1][1] == 2_000
