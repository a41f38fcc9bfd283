"""Claims about arrays that become measurements again: there and back is the same."""

from typing import Any

import numpy as np
import pytest

from basu.agents.sensor_file import parse_sensors
from basu_leaderboard.measurements import as_measurement

RNG = np.random.default_rng(5)


def measured(kind: str, data: Any, **fields: Any) -> Any:
    (spec,) = parse_sensors([{"type": kind, "id": "A", **fields}], "s")
    return as_measurement(spec, 12, 0.6, data)


def test_an_image_keeps_its_bytes_and_its_shape() -> None:
    pixels = RNG.integers(0, 255, (6, 8, 4), dtype=np.uint8)
    image = measured("sensor.camera.rgb", pixels, fov=100)
    assert (image.frame, image.timestamp, image.width, image.height, image.fov) == (12, 0.6, 8, 6, 100.0)
    assert np.array_equal(np.frombuffer(image.raw_data, np.uint8).reshape(6, 8, 4), pixels)


def test_a_cloud_is_read_as_carlas_is() -> None:
    points = RNG.random((50, 4), dtype=np.float32)
    cloud = measured("sensor.lidar.ray_cast", points)
    assert len(cloud) == 50
    assert np.array_equal(np.frombuffer(cloud.raw_data, np.float32).reshape(-1, 4), points)


def test_echoes_are_turned_round_again() -> None:
    echoes = measured("sensor.other.radar", np.array([[40.0, 0.1, -0.2, 3.0]]))  # depth, altitude, azimuth, velocity
    (echo,) = echoes
    assert len(echoes) == 1
    assert echo == pytest.approx((3.0, -0.2, 0.1, 40.0))
    assert (echo.depth, echo.velocity) == pytest.approx((40.0, 3.0))


def test_a_fix_and_the_inertia_have_names_again() -> None:
    fix = measured("sensor.other.gnss", np.array([39.99, -82.98, 250.0]))
    assert (fix.latitude, fix.longitude, fix.altitude) == (39.99, -82.98, 250.0)
    inertia = measured("sensor.other.imu", np.arange(7.0))
    assert (inertia.accelerometer.y, inertia.gyroscope.x, inertia.compass) == (1.0, 3.0, 6.0)


def test_what_the_leaderboard_does_not_know_stays_as_it_came() -> None:
    thing = object()
    assert measured("sensor.camera.depth", thing) is thing
