"""CARLA's frames as ROS's: held against the official client's own matrices and against turning things by hand."""

import math

import carla
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linden_ros2 import frames

MIRROR = np.diag([1.0, -1.0, 1.0])
any_angle = st.floats(-math.pi, math.pi)
up_or_down = st.floats(-1.5, 1.5)


def matrix(turn: frames.Quaternion) -> np.ndarray:
    """Columns are the axes of the turned frame."""
    return np.array([frames.rotated(turn, axis) for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))]).T


def client_s(roll_rad: float, pitch_rad: float, yaw_rad: float) -> np.ndarray:
    """The rotation that the official client computes, in CARLA's axes."""
    roll, pitch, yaw = map(math.degrees, (roll_rad, pitch_rad, yaw_rad))
    return np.array(carla.Transform(carla.Location(), carla.Rotation(pitch, yaw, roll)).get_matrix())[:3, :3]


@given(any_angle, up_or_down, any_angle)
def test_an_attitude_is_the_client_s_rotation_with_y_mirrored(roll: float, pitch: float, yaw: float) -> None:
    expected = MIRROR @ client_s(roll, pitch, yaw) @ MIRROR
    assert matrix(frames.attitude(roll, pitch, yaw)) == pytest.approx(expected, abs=2e-6)  # the client has floats


@given(any_angle, up_or_down, any_angle)
def test_angles_lead_back(roll: float, pitch: float, yaw: float) -> None:
    again = frames.attitude(*frames.angles(frames.attitude(roll, pitch, yaw)))
    assert abs(float(np.dot(again, frames.attitude(roll, pitch, yaw)))) == pytest.approx(1.0)


@pytest.mark.parametrize("axis", range(3))
def test_an_angular_velocity_turns_points_the_same_way_in_both_frames(axis: int) -> None:
    """v = w x r in components, in CARLA's axes and in ROS's: each is the other's mirror image."""
    spin, arm = np.eye(3)[axis], np.array([0.3, -0.7, 0.2])
    moving = np.cross(spin, arm)
    assert np.cross(frames.axial(*spin), frames.vector(*arm)) == pytest.approx(np.array(frames.vector(*moving)))


def test_a_turn_to_the_right_has_a_negative_yaw_rate() -> None:
    assert frames.axial(0.0, 0.0, 1.0) == (0.0, 0.0, -1.0)
    assert frames.attitude(0.0, 0.0, math.radians(90.0)) == pytest.approx((0.0, 0.0, -math.sqrt(0.5), math.sqrt(0.5)))


def test_an_optical_frame_looks_along_z_with_y_down() -> None:
    assert matrix(frames.OPTICAL) == pytest.approx(np.array([[0, 0, 1], [-1, 0, 0], [0, -1, 0]]))


def test_what_is_turned_out_is_turned_back_in() -> None:
    turn = frames.attitude(0.1, -0.2, 2.0)
    assert frames.in_body(turn, frames.rotated(turn, (1.0, 2.0, 3.0))) == pytest.approx((1.0, 2.0, 3.0))


def test_a_pose_moves_back_along_its_own_axis() -> None:
    facing_south = frames.Pose((10.0, 5.0, 0.0), frames.attitude(0.0, 0.0, math.radians(90.0)))
    assert frames.moved_back(facing_south, 1.5).position_m == pytest.approx((10.0, 6.5, 0.0))


def test_points_are_copied_and_turned_around() -> None:
    measured = np.array([[1.0, 2.0, 3.0, 0.5]], dtype=np.float32)
    assert frames.points(measured).tolist() == [[1.0, -2.0, 3.0, 0.5]]
    assert measured.tolist() == [[1.0, 2.0, 3.0, 0.5]]


def test_a_focal_length_has_the_picture_s_edge_at_half_the_field_of_view() -> None:
    assert frames.focal_length_px(800, 90.0) == pytest.approx(400.0)
    assert math.degrees(math.atan(320 / frames.focal_length_px(640, 70.0))) == pytest.approx(35.0)
    with pytest.raises(ValueError, match="180"):
        frames.focal_length_px(800, 180.0)
