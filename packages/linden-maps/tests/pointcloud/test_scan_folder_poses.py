"""Claims about files of poses."""

import math
from pathlib import Path

import numpy as np
import pytest

from linden.errors import UserError
from linden_maps.pointcloud.drive import SensorPlace
from linden_maps.pointcloud.scan_folder import pose_line, read_poses, write_poses


def test_a_pose_comes_back_as_it_was_written(tmp_path: Path) -> None:
    file = tmp_path / "poses.txt"
    poses = [SensorPlace(10.5, -2000.25, 245.0, heading).map_from_sensor for heading in (0.0, 1.0, math.pi, -2.5)]
    write_poses(file, [pose_line(f"{number}", pose) for number, pose in enumerate(poses)])
    for pose, again in zip(poses, read_poses(file, ["0", "1", "2", "3"]), strict=True):
        np.testing.assert_allclose(again, pose, atol=1e-9)


def test_a_quaternion_turns_as_ros_means_it(tmp_path: Path) -> None:
    file = tmp_path / "tum.txt"
    half = math.sqrt(0.5)  # a quarter turn about x: y becomes z; given twice as long, which means the same
    file.write_text(f"# stamp tx ty tz qx qy qz qw\n\n1700000000.5 1 2 3 {2 * half} 0 0 {2 * half}\n")
    (pose,) = read_poses(file, ["1700000000.5"])
    np.testing.assert_allclose(pose @ [0.0, 1.0, 0.0, 1.0], [1.0, 2.0, 4.0], atol=1e-12)


def test_twelve_numbers_are_a_matrix_for_each_file_in_turn(tmp_path: Path) -> None:
    file = tmp_path / "kitti.txt"
    file.write_text("1 0 0 5 0 1 0 6 0 0 1 7\n0 -1 0 0 1 0 0 0 0 0 1 0\n")
    first, second = read_poses(file, ["a", "b"])
    assert first[:, 3].tolist() == [5.0, 6.0, 7.0]
    np.testing.assert_allclose(second @ [1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0])


def test_a_file_that_cannot_be_read_or_written_gets_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"cannot read .*none\.txt"):
        read_poses(tmp_path / "none.txt", [])
    with pytest.raises(UserError, match=r"cannot write .*poses\.txt: No such file"):
        write_poses(tmp_path / "none" / "poses.txt", [])


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "holds no pose"),
        ("# only a remark\n", "holds no pose"),
        ("a 0 0 0 0 0 0 1\n", "holds no pose for 1 of 2 scans, the first being b"),
        ("a 0 0 0 0 0 0 1\nb 0 0 0 0 0 0\n", "line 2: a pose is a name and 7 numbers"),
        ("a 0 0 0 0 0 0 1\nb 0 0 nan 0 0 0 1\n", "line 2: a pose is a name and 7 numbers, or 12 numbers, all finite"),
        ("a 0 0 0 0 0 0 1\nb 0 0 up 0 0 0 1\n", "line 2: could not convert"),
        ("a 0 0 0 0 0 0 0\nb 0 0 0 0 0 0 1\n", "line 1: the quaternion is zero"),
        ("1 0 0 5 0 1 0 6 0 0 1 7\n", "holds 1 poses for 2 scans"),
    ],
)
def test_missing_and_wrong_poses_get_a_sentence(text: str, told: str, tmp_path: Path) -> None:
    file = tmp_path / "poses.txt"
    file.write_text(text)
    with pytest.raises(UserError, match=told):
        read_poses(file, ["a", "b"])
