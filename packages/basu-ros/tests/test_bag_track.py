"""Drives in bags, and what is none."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from basu.errors import UserError
from basu_ros.bag_file import BagFile
from basu_ros.bag_track import read_track
from basu_ros.moment import Control, Moment, Motion, Vehicle
from basu_ros.topics import odometry_of
from basu_ros.vehicle_messages import control_message, odometry
from linden_ros2.basic_messages import header
from linden_ros2.topic import Message, Topic, control_of
from linden_ros2.types import Generation

NOBODY = Control()


def bag(
    path: Path, motions: Sequence[tuple[float, Motion]], *topics: str, generation: Generation = Generation.ROS_2
) -> Path:
    """A bag with odometry on each of ``topics``, and CARLA's control at twice its rate."""
    file = BagFile(path, generation)
    for t_s, motion in motions:
        for name in topics:
            message = odometry(file.types, Vehicle("hero"), Moment(t_s, 0, motion, NOBODY), "base_link")
            file.write(t_s, [Message(Topic(name, "nav_msgs/msg/Odometry"), message)])
        file.write(t_s, [Message(control_of("hero"), control_message(file.types, Control(throttle=t_s), t_s))])
    file.close()
    return path


def uphill(t_s: float) -> Motion:
    """5 m/s along a slope, turning right, in CARLA's axes; all columns differ."""
    return Motion(5 * t_s, -2 * t_s, t_s, 0.01, 0.2, 3.1 + t_s, 5.0, -2.0, 1.0, 0, 0, 0, 0.1, 0.2, 0.3)


@pytest.mark.parametrize("generation", Generation)
def test_what_was_written_is_read_back_in_carla_s_axes(generation: Generation, tmp_path: Path) -> None:
    times = [10.0, 10.1, 10.2]
    name = "drive.bag" if generation is Generation.ROS_1 else "drive"
    path = bag(tmp_path / name, [(t, uphill(t - 10.0)) for t in times], "/odom", generation=generation)
    track = read_track(path)
    assert track.t_s == pytest.approx(np.array([0.0, 0.1, 0.2]))
    expected = np.array([uphill(t - 10.0) for t in times])
    assert track.pose == pytest.approx(expected[:, :6])  # the yaw passes pi without a jump
    assert track.velocity_mps == pytest.approx(expected[:, 6:9])
    assert track.spin_radps == pytest.approx(expected[:, 12:])
    assert track.controls[:, 0] == pytest.approx(np.array(times), rel=1e-6)
    assert track.control_t_s == pytest.approx(np.array([0.0, 0.1, 0.2]))


def test_one_of_several_odometries_must_be_named(tmp_path: Path) -> None:
    path = bag(tmp_path / "drive", [(t, uphill(t)) for t in (0.1, 0.2)], "/odom", "/wheels/odom")
    with pytest.raises(UserError, match=r"several topics .*: /odom, /wheels/odom; choose with --odometry"):
        read_track(path)
    assert read_track(path, "/wheels/odom").topic == "/wheels/odom"
    with pytest.raises(
        UserError, match="no topic /lidar of the type nav_msgs/msg/Odometry; it has /odom, /wheels/odom"
    ):
        read_track(path, "/lidar")


def test_a_bag_without_odometry_names_what_it_has(tmp_path: Path) -> None:
    with pytest.raises(
        UserError, match=r"no topic of the type nav_msgs/msg/Odometry.*it has /carla/hero/vehicle_control"
    ):
        read_track(bag(tmp_path / "drive", [(0.1, uphill(0.1))]))


@pytest.mark.parametrize(
    ("times", "says"),
    [((0.5,), "has 1 different times"), ((0.5, 0.5), "has 1 different times"), ((0.1, 2.0), "a gap of 1.9 s")],
)
def test_too_little_is_no_drive(times: tuple[float, ...], says: str, tmp_path: Path) -> None:
    with pytest.raises(UserError, match=says):
        read_track(bag(tmp_path / "drive", [(t, uphill(t)) for t in times], "/odom"))


def test_no_numbers_are_counted(tmp_path: Path) -> None:
    lost = uphill(0.2)._replace(x_m=float("nan"))
    with pytest.raises(UserError, match=r"1 messages of /odom .* hold no numbers"):
        read_track(bag(tmp_path / "drive", [(0.1, uphill(0.1)), (0.2, lost), (0.3, uphill(0.3))], "/odom"))


def test_an_attitude_of_zeros_is_no_attitude(tmp_path: Path) -> None:
    file = BagFile(tmp_path / "drive", Generation.ROS_2)
    for t_s in (0.1, 0.2):
        empty = file.types.message("nav_msgs/msg/Odometry", header=header(file.types, t_s, "map"))
        file.write(t_s, [Message(odometry_of("hero"), empty)])
    file.close()
    with pytest.raises(UserError, match="hold no numbers"):
        read_track(tmp_path / "drive")


@pytest.mark.parametrize("content", [b"", b"\x89MCAP0\r\nrubbish", b"#ROSBAG V2.0\nrubbish"])
def test_what_is_no_bag_is_a_sentence(content: bytes, tmp_path: Path) -> None:
    for name in ("x.mcap", "x.bag"):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(UserError, match=f"the bag .*{name} cannot be read"):
            read_track(tmp_path / name)
    with pytest.raises(UserError, match="is not there"):
        read_track(tmp_path / "none.bag")
