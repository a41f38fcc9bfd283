"""The radar against motions whose closing speeds are known."""

import math

import numpy as np
import pytest

from fakes.solids import at, box, described, floor, instances, look_at, seen_of
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.scenery.mesh import join
from linden.sensors.devices.radar import MOST_RAYS, Detections, Radar

WALL = box((0.5, 100.0, 100.0), centre_m=(20.5, 0.0, 0.0))


def detected(seen, pose: Transform = Transform(), **known) -> Detections:  # noqa: B008 - frozen
    chosen = {"points_per_second": 20_000, **known.pop("chosen", {})}
    return Radar(described("sensor.other.radar", **chosen)).measure(look_at(seen, pose, **known))


def directions(found: Detections) -> np.ndarray:
    level = np.cos(found.altitude_rad)
    return np.column_stack(
        [level * np.cos(found.azimuth_rad), level * np.sin(found.azimuth_rad), np.sin(found.altitude_rad)]
    )


def test_a_wall_is_as_far_as_it_is_along_each_ray() -> None:
    found = detected(seen_of(WALL, [], instances()))
    assert len(found.depth_m) == 2_000
    np.testing.assert_allclose(found.depth_m * directions(found)[:, 0], 20.0, atol=1e-3)
    assert not found.velocity_mps.any()


def test_what_recedes_has_a_positive_velocity_and_what_comes_a_negative() -> None:
    body, away = [box((1.0, 20.0, 20.0))], (3.0, 0.0, 0.0)
    moving = instances((0, 5, at(20.0, 0.0, 0.0)), velocity=away)
    found = detected(seen_of(join([]), body, moving))
    np.testing.assert_allclose(found.velocity_mps, 3.0 * directions(found)[:, 0], atol=1e-4)
    found = detected(seen_of(join([]), body, moving), velocity_mps=np.array([8.0, 0.0, 0.0]))
    np.testing.assert_allclose(found.velocity_mps, -5.0 * directions(found)[:, 0], atol=1e-4)


def test_driving_ahead_the_road_comes_at_the_cosine_of_its_angle() -> None:
    seen, speed = seen_of(floor(), [], instances()), np.array([10.0, 0.0, 0.0])
    found = detected(seen, Transform(Vector3D(0.0, 0.0, 1.0)), velocity_mps=speed)
    assert len(found.depth_m) > 300
    np.testing.assert_allclose(found.velocity_mps, -10.0 * directions(found)[:, 0], atol=1e-4)
    np.testing.assert_allclose(found.depth_m * np.sin(found.altitude_rad), -1.0, atol=1e-3)


def test_a_body_that_turns_on_the_spot_comes_on_one_side_and_recedes_on_the_other() -> None:
    moving = instances((0, 5, at(20.0, 0.0, 0.0)), turning=(0.0, 0.0, 2.0))
    found = detected(seen_of(join([]), [box((0.001, 20.0, 20.0))], moving))
    sideways_m = found.depth_m * directions(found)[:, 1]
    # 2 rad/s about the vertical, clockwise from above: what lies to the right goes back (x falls as y grows)
    np.testing.assert_allclose(found.velocity_mps, -2.0 * sideways_m * directions(found)[:, 0], atol=0.05)


def test_rays_stay_in_the_cone_and_reach_as_far_as_its_end() -> None:
    chosen = {"horizontal_fov": 40, "vertical_fov": 10, "range": 19.9}
    assert len(detected(seen_of(WALL, [], instances()), chosen=chosen).depth_m) == 0
    found = detected(seen_of(WALL, [], instances()), chosen={**chosen, "range": 20.1})
    assert len(found.depth_m) == 2_000  # those at the edge go further than 20.1 m: the range is measured ahead
    assert np.abs(found.azimuth_rad).max() <= math.radians(20.0) + 1e-6
    assert np.abs(np.tan(found.altitude_rad) / np.cos(found.azimuth_rad)).max() <= math.tan(math.radians(5.0)) + 1e-2
    assert np.abs(found.azimuth_rad).max() > math.radians(18.0)


def test_azimuth_grows_to_the_right_and_altitude_upwards_whichever_way_it_is_mounted() -> None:
    right_of_it = seen_of(box((0.1, 0.1, 0.1), centre_m=(10.0, 1.0, 0.5)), [], instances())
    found = detected(right_of_it)
    assert len(found.depth_m)
    assert (found.azimuth_rad > 0.0).all()
    assert (found.altitude_rad > 0.0).all()
    rolled = detected(right_of_it, Transform(rotation=Rotation(roll=180.0)))
    assert (rolled.azimuth_rad < 0.0).all()
    assert (rolled.altitude_rad < 0.0).all()


def test_the_same_measurement_repeats_and_the_next_one_differs() -> None:
    seen = seen_of(WALL, [], instances())
    first, again, later = detected(seen), detected(seen), detected(seen, number=1)
    assert all(np.array_equal(one, other) for one, other in zip(first, again, strict=True))
    assert not np.array_equal(first.azimuth_rad, later.azimuth_rad)
    assert detected(seen, chosen={"noise_seed": 4}).azimuth_rad[0] != pytest.approx(first.azimuth_rad[0])


def test_a_measurement_of_any_time_has_a_number_of_points_that_fits_into_memory() -> None:
    found = detected(seen_of(WALL, [], instances()), interval_s=1e6, chosen={"points_per_second": 20_000_000})
    assert 0 < len(found.depth_m) <= MOST_RAYS
