"""Claims about frames: AlpaSim's axes are right-handed, and its rig lies below the rear axle."""

import math

import numpy as np
import pytest
from carla_driver_interface.geometry import Pose

from basu.agents.sensor_file import parse_sensors
from basu.records.motion import VehicleMotion
from basu_alpasim.frames import camera_in_rig, dynamic_state, origin_of, rig_pose

AXLE_M = 1.4


def motion(**values: float) -> VehicleMotion:
    """Return a motion that is 0 but for these values."""
    return VehicleMotion(**(dict.fromkeys(VehicleMotion._fields, 0.0) | values))


def test_the_rig_lies_behind_the_origin_and_y_points_left() -> None:
    rig = rig_pose(motion(x_m=10.0, y_m=5.0, z_m=2.0, yaw_rad=math.pi / 2), AXLE_M)  # CARLA: southwards
    assert rig.position == pytest.approx([10.0, -5.0 + AXLE_M, 2.0])
    assert rig.yaw == pytest.approx(-math.pi / 2)


def test_a_pitch_upwards_lifts_the_x_axis() -> None:
    rig = rig_pose(motion(pitch_rad=0.1), AXLE_M)
    assert rig.rotation.apply([1.0, 0.0, 0.0]) == pytest.approx([math.cos(0.1), 0.0, math.sin(0.1)])


def test_a_roll_to_the_right_lowers_the_right_side() -> None:
    assert rig_pose(motion(roll_rad=0.1), AXLE_M).rotation.apply([0.0, -1.0, 0.0])[2] < 0.0


@pytest.mark.parametrize("yaw_rad", [-3.0, -1.0, 0.0, 0.5, 2.5])
def test_the_origin_comes_back_from_its_rig(yaw_rad: float) -> None:
    found = origin_of(rig_pose(motion(x_m=-7.0, y_m=300.0, z_m=9.0, yaw_rad=yaw_rad), AXLE_M), AXLE_M)
    assert found == pytest.approx((-7.0, 300.0, yaw_rad))


def test_the_velocity_is_that_of_the_rear_axle() -> None:
    # a circle to the left about the rear axle's line: the origin slips outwards, the rear axle does not
    yaw_rad, spin, speed = 0.7, -0.3, 5.0
    across = AXLE_M * spin
    moving = motion(
        yaw_rad=yaw_rad,
        velocity_x_mps=speed * math.cos(yaw_rad) - across * math.sin(yaw_rad),
        velocity_y_mps=speed * math.sin(yaw_rad) + across * math.cos(yaw_rad),
        angular_velocity_z_radps=spin,
    )
    state = dynamic_state(moving, AXLE_M)
    found = state.linear_velocity
    assert (found.x, found.y, found.z) == pytest.approx((speed, 0.0, 0.0), abs=1e-6)
    assert state.angular_velocity.z == pytest.approx(0.3)


def test_a_camera_is_declared_by_its_optical_frame() -> None:
    entry = {"type": "sensor.camera.rgb", "id": "front", "x": 1.0, "y": 0.5, "z": 1.5, "yaw": 90.0}
    (spec,) = parse_sensors([entry], "the test")
    pose: Pose = camera_in_rig(spec, AXLE_M)
    assert pose.position == pytest.approx([1.0 + AXLE_M, -0.5, 1.5])
    optical_axis, down = pose.rotation.apply(np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]))
    assert optical_axis == pytest.approx([0.0, -1.0, 0.0], abs=1e-9)  # 90 degrees clockwise: to the right
    assert down == pytest.approx([0.0, 0.0, -1.0], abs=1e-9)
