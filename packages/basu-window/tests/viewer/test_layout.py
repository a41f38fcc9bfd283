"""Claims about the way from CARLA's left-handed frame into the right-handed one that is drawn."""

import math

import carla
import numpy as np
import pytest

from basu_window.viewer.layout import Pose, about_the_vertical, shown, turned


def test_south_becomes_negative_north() -> None:
    np.testing.assert_array_equal(shown([[1.0, 2.0, 3.0]]), [[1.0, -2.0, 3.0]])


@pytest.mark.parametrize("degrees", [(0, 0, 90), (10, -20, 30), (-170, 5, 179), (33, 44, -55)])
def test_a_point_of_the_vehicle_is_drawn_where_carla_has_it(degrees: tuple[int, int, int]) -> None:
    roll, pitch, yaw = degrees
    pose = Pose(7.0, -8.0, 9.0, *(math.radians(angle) for angle in degrees))
    transform = carla.Transform(carla.Location(7.0, -8.0, 9.0), carla.Rotation(roll=roll, pitch=pitch, yaw=yaw))
    own = (2.0, 1.0, 0.5)  # ahead, right, up
    there = transform.transform(carla.Location(*own))
    drawn = turned(pose) @ shown(own) + shown(pose[:3])
    np.testing.assert_allclose(drawn, shown((there.x, there.y, there.z)), atol=1e-4)


def test_the_drawn_frame_is_right_handed() -> None:
    assert np.linalg.det(turned(Pose(0, 0, 0, 0.3, -0.2, 2.0))) == pytest.approx(1.0)


def test_a_box_turns_as_its_vehicle_does() -> None:
    yaw = 0.7
    x, y, z, w = about_the_vertical(np.array([yaw]))[0]
    assert (x, y) == (0.0, 0.0)
    forward = (1 - 2 * z * z, 2 * w * z)  # a quaternion about z, applied to the x axis
    np.testing.assert_allclose(forward, turned(Pose(0, 0, 0, 0, 0, yaw))[:2, 0], atol=1e-12)
