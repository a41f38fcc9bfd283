"""Lidars in worlds of planes and boxes, where every point is known in closed form."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fakes.solids import at, box, described, floor, instances, look_at, seen_of
from linden.protocol.values.enums import SemanticTag
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.scenery.mesh import join
from linden.sensors.devices.lidar import Lidar, SemanticLidar
from linden.sensors.devices.lidar.firing_pattern import MOST_RAYS, fire, points_a_channel, read_fan, turned_on

UP_2_M = Transform(Vector3D(0.0, 0.0, 2.0))
WHOLE = {"dropoff_general_rate": 0, "dropoff_intensity_limit": 0, "dropoff_zero_intensity": 0}
"""A lidar that loses nothing."""


def lidar(**chosen: object) -> Lidar:
    return Lidar(described("sensor.lidar.ray_cast", **{"range": 100, **WHOLE, **chosen}))


def semantic(**chosen: object) -> SemanticLidar:
    return SemanticLidar(described("sensor.lidar.ray_cast_semantic", **{"range": 100, **chosen}))


def on_floor():
    return seen_of(floor(), [], instances())


def test_the_floor_lies_where_it_is_to_a_millimetre() -> None:
    sweep = lidar(upper_fov=-5, lower_fov=-60, channels=16, points_per_second=16_000).measure(
        look_at(on_floor(), UP_2_M)
    )
    np.testing.assert_allclose(sweep.points[:, 2], -2.0, atol=1e-3)
    slant = np.linspace(-5.0, -60.0, 16)
    for channel, first in enumerate(np.cumsum([0, *sweep.points_of_channel[:-1]])):
        expected_m = 2.0 / math.tan(math.radians(-slant[channel]))
        assert np.hypot(*sweep.points[first, :2]) == pytest.approx(expected_m, abs=1e-3)


def test_a_wall_lies_in_the_frame_of_a_sensor_that_is_turned_and_tilted() -> None:
    seen = seen_of(box((0.5, 30.0, 30.0), centre_m=(10.5, 0.0, 0.0)), [], instances())
    turned = Transform(Vector3D(1.0, 0.0, 0.0), Rotation(pitch=10.0, yaw=30.0, roll=-20.0))
    sweep = lidar(horizontal_fov=20, upper_fov=5, lower_fov=-5).measure(look_at(seen, turned))
    from linden.geometry import rotation_matrix  # noqa: PLC0415 - only here

    world = sweep.points[:, :3] @ rotation_matrix(turned.rotation).T + np.array(turned.location)
    assert len(world)
    np.testing.assert_allclose(world[:, 0], 10.0, atol=1e-3)


@given(st.integers(1, 128), st.integers(1, 2_000_000), st.sampled_from([0.01, 0.05, 0.1]))
@pytest.mark.unmeasured
def test_each_channel_fires_its_share_of_the_points(channels: int, points_per_s: int, interval_s: float) -> None:
    fan = read_fan(described("sensor.lidar.ray_cast", channels=channels, points_per_second=points_per_s))
    count = points_a_channel(fan, interval_s)
    assert abs(count - points_per_s * interval_s / channels) <= 0.5 + 1e-6
    assert fire(fan, 0.0, interval_s).rays == channels * count


def test_a_measurement_of_any_time_has_a_number_of_points_that_fits_into_memory() -> None:
    fan = read_fan(described("sensor.lidar.ray_cast", channels=4096, points_per_second=20_000_000))
    assert fire(fan, 0.0, 1e6).rays == MOST_RAYS


def test_points_come_channel_by_channel_the_uppermost_first() -> None:
    sweep = lidar(upper_fov=-10, lower_fov=-40, channels=4, points_per_second=4_000).measure(
        look_at(on_floor(), UP_2_M)
    )
    assert sweep.points_of_channel.tolist() == [100] * 4
    reach = np.hypot(sweep.points[:, 0], sweep.points[:, 1]).reshape(4, 100).mean(1)
    assert (np.diff(reach) < 0.0).all()


def test_half_a_turn_a_frame_begins_behind_and_goes_on_where_it_ended() -> None:
    half = lidar(rotation_frequency=5, upper_fov=-20, lower_fov=-20, channels=1, points_per_second=1_000)
    first = half.measure(look_at(on_floor(), UP_2_M))
    second = half.measure(look_at(on_floor(), UP_2_M, number=1))
    yaw = [np.arctan2(sweep.points[:, 1], sweep.points[:, 0]) for sweep in (first, second)]
    assert yaw[0].min() >= -math.pi - 1e-6
    assert yaw[0].max() < 0.0  # over the left, from behind to ahead
    assert yaw[1].min() >= -1e-6
    assert (first.horizontal_rad, second.horizontal_rad) == pytest.approx((math.pi, 0.0))


@settings(max_examples=40)
@given(st.lists(st.sampled_from([0.01, 0.02, 0.05]), max_size=20))
@pytest.mark.unmeasured
def test_where_it_points_does_not_depend_on_listeners(intervals_s: list[float]) -> None:
    fan = read_fan(described("sensor.lidar.ray_cast", rotation_frequency=7, horizontal_fov=180))
    at_deg = 0.0
    for interval_s in intervals_s:
        at_deg = turned_on(fan, at_deg, interval_s)
    distance = abs(at_deg - math.fmod(7 * 180 * sum(intervals_s), 180.0))
    assert min(distance, 180.0 - distance) < 1e-5


def test_beyond_its_range_it_sees_nothing() -> None:
    seen = seen_of(box((0.5, 30.0, 30.0), centre_m=(20.5, 0.0, 0.0)), [], instances())
    level = {"upper_fov": 0, "lower_fov": 0, "channels": 1, "horizontal_fov": 1}
    assert len(lidar(range=19.9, **level).measure(look_at(seen, Transform())).points) == 0
    assert len(lidar(range=20.1, **level).measure(look_at(seen, Transform())).points) > 0


def test_intensity_fades_as_beer_and_lambert_have_it() -> None:
    sweep = lidar(atmosphere_attenuation_rate=0.05, upper_fov=-5, lower_fov=-60).measure(look_at(on_floor(), UP_2_M))
    distance_m = np.linalg.norm(sweep.points[:, :3], axis=1)
    np.testing.assert_allclose(sweep.points[:, 3], np.exp(-0.05 * distance_m), rtol=1e-5)


def test_so_many_points_are_lost_as_the_rates_say() -> None:
    down = {"upper_fov": -89, "lower_fov": -90, "points_per_second": 400_000}
    near = {"atmosphere_attenuation_rate": 0.1}  # at 2 m: 0.819
    all_of_them = len(lidar(**down).measure(look_at(on_floor(), UP_2_M)).points)
    blind = lidar(dropoff_general_rate=0.45, **down)
    assert len(blind.measure(look_at(on_floor(), UP_2_M)).points) == pytest.approx(0.55 * all_of_them, rel=0.03)
    dim = lidar(dropoff_intensity_limit=0.9, dropoff_zero_intensity=0.5, **down, **near)
    share = 0.5 / 0.9 * math.exp(-0.2) + 0.5
    assert len(dim.measure(look_at(on_floor(), UP_2_M)).points) == pytest.approx(share * all_of_them, rel=0.03)


def test_noise_is_along_the_ray_has_its_deviation_and_repeats_with_its_seed() -> None:
    def errors(seed: int, number: int) -> np.ndarray:
        noisy = lidar(noise_stddev=0.05, noise_seed=seed, upper_fov=-40, lower_fov=-40, channels=1)
        points = noisy.measure(look_at(on_floor(), UP_2_M, number=number)).points[:, :3].astype(float)
        slant = np.arctan2(points[:, 2], np.hypot(points[:, 0], points[:, 1]))
        np.testing.assert_allclose(np.degrees(slant), -40.0, atol=1e-3)
        return np.linalg.norm(points, axis=1) - 2.0 / math.sin(math.radians(40.0))

    assert errors(3, 0).std() == pytest.approx(0.05, rel=0.1)
    assert np.array_equal(errors(3, 0), errors(3, 0))
    assert not np.array_equal(errors(3, 0), errors(3, 1))
    assert not np.array_equal(errors(3, 0), errors(4, 0))


def test_the_semantic_lidar_names_actor_and_tag_of_each_point() -> None:
    post = box((0.2, 0.2, 5.0), centre_m=(0.0, 8.0, 0.0), tag=SemanticTag.TRAFFIC_LIGHT, thing=0)
    house = box((2.0, 2.0, 5.0), centre_m=(0.0, -12.0, 0.0), tag=SemanticTag.BUILDINGS, thing=1)
    standing = join([floor(tag=SemanticTag.ROADS), post, house])
    car = instances((0, 77, at(10.0, 0.0, 1.0)))
    seen = seen_of(standing, [box((2.0, 1.0, 1.0), tag=SemanticTag.CAR)], car, object_id=(12, 0x8000_8001))
    points = semantic(upper_fov=0, lower_fov=-20, points_per_second=200_000).measure(look_at(seen, UP_2_M)).points
    of_tag = {int(tag): set(points["object_id"][points["tag"] == tag].tolist()) for tag in np.unique(points["tag"])}
    assert of_tag == {
        SemanticTag.ROADS: {0},
        SemanticTag.BUILDINGS: {0},
        SemanticTag.TRAFFIC_LIGHT: {12},
        SemanticTag.CAR: {77},
    }
    car_points = points[points["tag"] == SemanticTag.CAR]
    assert car_points["xyz"][:, 0].min() == pytest.approx(8.0, abs=1e-3)


def test_the_cosine_is_that_between_ray_and_surface() -> None:
    points = semantic(upper_fov=-10, lower_fov=-80).measure(look_at(on_floor(), UP_2_M)).points
    distance_m = np.linalg.norm(points["xyz"], axis=1)
    np.testing.assert_allclose(points["cos_incidence"], 2.0 / distance_m, rtol=1e-4)


def test_a_lidar_inside_a_body_looks_out_of_it_and_onto_others() -> None:
    moving = instances((0, 1, at(0.0, 0.0, 0.0)), (0, 2, at(10.0, 0.0, 0.0)))
    seen = seen_of(floor(), [box((2.0, 1.0, 1.0), tag=SemanticTag.CAR)], moving)
    level = {"upper_fov": 0, "lower_fov": 0, "channels": 1, "horizontal_fov": 1}
    points = semantic(**level).measure(look_at(seen, Transform(Vector3D(0.0, 0.0, 0.5)))).points
    assert set(points["object_id"].tolist()) == {2}
    np.testing.assert_allclose(points["xyz"][:, 0], 8.0, atol=1e-2)
