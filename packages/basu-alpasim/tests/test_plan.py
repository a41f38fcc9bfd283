"""Claims about trajectories: bad ones are refused with call and time, good ones give a path and speeds."""

import math

import numpy as np
import pytest
from carla_driver_interface.geometry import Pose, Trajectory
from carla_driver_interface.protocol import DriveResponse

from basu.errors import AgentInvalidControlError
from basu_alpasim import plan
from basu_alpasim.frames import OriginPose

AXLE_M, NOW_US = 1.4, 3_200_000
HERE = OriginPose(AXLE_M, 0.0, 0.0)


def response(*poses: tuple[int, float, float, float]) -> DriveResponse:
    """Return an answer with poses of the rig: time in µs, x, y, yaw."""
    placed = [Pose.from_xyz_yaw(x, y, 0.0, yaw) for _, x, y, yaw in poses]
    return DriveResponse(trajectory=Trajectory([each[0] for each in poses], placed).to_proto())


def straight(speed_mps: float, accel_mps2: float = 0.0, *, anchored: bool = True) -> DriveResponse:
    """Return an answer that drives straight on, with or without the present pose."""
    times_s = np.arange(0.0 if anchored else 0.1, 4.05, 0.1)
    along_m = speed_mps * times_s + accel_mps2 * times_s**2 / 2.0
    rows = zip(times_s, along_m, strict=True)
    return response(*((NOW_US + round(t * 1e6), float(x), 0.0, 0.0) for t, x in rows))


def followed(answer: DriveResponse) -> plan.Trajectory:
    """Return the trajectory of an answer."""
    return plan.Trajectory(plan.read_plan(answer, NOW_US, AXLE_M), NOW_US, HERE)


@pytest.mark.parametrize(
    ("answer", "says"),
    [
        (DriveResponse(), "answered drive at 3.20 s with an empty trajectory"),
        (response((NOW_US, 0.0, 0.0, 0.0)), "trajectory that ends at 3.20 s; it needs a pose after"),
        (response((100_000, 0.0, 0.0, 0.0)), "trajectory that ends at 0.10 s"),
        (response((NOW_US + 1, 0.0, 0.0, 0.0), (NOW_US + 1, 1.0, 0.0, 0.0)), "times that do not rise: pose 2"),
        (response((NOW_US + 1, math.nan, 0.0, 0.0)), "x = nan in pose 1; it must be a finite number"),
        (response((NOW_US + 1, 0.0, math.inf, 0.0)), "y = inf in pose 1"),
    ],
)
def test_what_is_no_trajectory_is_refused_with_call_and_time(answer: DriveResponse, says: str) -> None:
    with pytest.raises(AgentInvalidControlError, match=says):
        plan.read_plan(answer, NOW_US, AXLE_M)


def test_a_quaternion_without_length_is_refused() -> None:
    answer = straight(5.0)
    answer.trajectory.poses[3].pose.quat.Clear()
    with pytest.raises(AgentInvalidControlError, match="a quaternion of length 0 in pose 4"):
        plan.read_plan(answer, NOW_US, AXLE_M)


@pytest.mark.parametrize("anchored", [True, False])
def test_speeds_are_those_of_the_poses_with_and_without_the_present_one(anchored: bool) -> None:  # noqa: FBT001
    trajectory = followed(straight(5.0, 2.0, anchored=anchored))
    for after_s in (0.0, 0.05, 0.1, 1.0):
        assert trajectory.speed_mps(3.2 + after_s) == pytest.approx(5.0 + 2.0 * after_s, abs=1e-3)


def test_a_first_pose_far_ahead_makes_no_leap() -> None:
    answer = straight(5.0)
    for entry in answer.trajectory.poses:
        entry.pose.vec.x += 2.0
    assert followed(answer).speed_mps(3.2) == pytest.approx(5.0, abs=1e-3)


def test_the_path_is_that_of_the_origin_and_goes_on_beyond_both_ends() -> None:
    path = followed(straight(5.0)).path
    assert path.find(AXLE_M, 0.0, 0.0).lateral_m == pytest.approx(0.0, abs=1e-6)
    assert path.find(AXLE_M, 1.0, 0.0).lateral_m == pytest.approx(1.0, abs=1e-6)
    assert path.x_m[0] < -10.0
    assert path.x_m[-1] > 30.0


def test_a_route_beside_the_vehicle_is_an_offset_and_no_kink() -> None:
    answer = straight(5.0)
    for entry in list(answer.trajectory.poses)[1:]:
        entry.pose.vec.y = 0.5  # to the left; the present pose stays where the vehicle is
    trajectory = followed(answer)
    place = trajectory.path.find(*HERE)
    assert place.lateral_m == pytest.approx(0.5, abs=1e-3)
    assert place.heading_rad == pytest.approx(0.0, abs=1e-3)


def test_a_trajectory_that_stands_has_the_speed_0_and_a_path() -> None:
    standing = followed(response((NOW_US + 500_000, 0.0, 0.0, 0.3), (NOW_US + 1_000_000, 0.0, 0.0, 0.3)))
    assert standing.speed_mps(3.5) == 0.0
    assert standing.path.heading_rad[10] == pytest.approx(-0.3)


def test_a_single_pose_is_reached_at_its_time() -> None:
    assert followed(response((NOW_US + 2_000_000, 8.0, 0.0, 0.0))).speed_mps(3.3) == pytest.approx(4.0, abs=1e-2)


def test_a_trajectory_backwards_is_not_driven() -> None:
    assert followed(response(*((NOW_US + i * 100_000, -0.5 * i, 0.0, 0.0) for i in range(1, 5)))).speed_mps(3.5) == 0.0
