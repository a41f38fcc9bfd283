"""Clouds of bags as scans with poses: a wall stands at one place in the map, however the lidar moved."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from basu.cli import main
from basu_ros.bag_file import BagFile
from basu_ros.topics import TF_STATIC
from linden.cli import main as linden_map
from linden_ros2.basic_messages import header, transforms
from linden_ros2.frames import Pose
from linden_ros2.sensor_messages import cloud
from linden_ros2.topic import TF, Message, Topic
from linden_ros2.types import Generation

LAYOUT = (("x", 0, 7), ("y", 4, 7), ("z", 8, 7), ("intensity", 12, 7))
WALL = np.array([(30.1, y, z) for y in np.arange(-2.9, 3.0, 0.4) for z in (0.5, 0.9, 1.3)])  # in the map, mid-cell
LIDAR = Pose((1.0, 0.0, 2.0), tuple(Rotation.from_euler("z", 90, degrees=True).as_quat()))
TIMES_S = (1.0, 1.5, 2.0, 2.5)


def vehicle(t_s: float) -> Pose:
    """4 m/s east, turning left by 10 degrees a second."""
    return Pose((4.0 * t_s, 1.0, 0.2), tuple(Rotation.from_euler("z", 10.0 * t_s, degrees=True).as_quat()))


def matrix(pose: Pose) -> np.ndarray:
    found = np.eye(4)
    found[:3, :3], found[:3, 3] = Rotation.from_quat(pose.attitude).as_matrix(), pose.position_m
    return found


def bag(
    path: Path,
    *,
    generation: Generation = Generation.ROS_2,
    topics: Sequence[str] = ("/lidar",),
    parent: str = "map",
    tf_s: Sequence[float] = TIMES_S,
) -> Path:
    """Return a bag of a lidar that sees the wall."""
    file = BagFile(path, generation)
    file.write(tf_s[0], [Message(TF_STATIC, transforms(file.types, tf_s[0], [("hero", "hero/LIDAR", LIDAR)]))])
    for t_s in sorted({*tf_s, *TIMES_S}):
        if t_s in tf_s:
            file.write(t_s, [Message(TF, transforms(file.types, t_s, [(parent, "hero", vehicle(t_s))]))])
        if t_s in TIMES_S:
            from_map = np.linalg.inv(matrix(vehicle(t_s)) @ matrix(LIDAR))
            seen = (np.c_[WALL, np.ones(len(WALL))] @ from_map.T)[:, :3]
            rows = np.c_[np.r_[seen, [(np.nan, 0.0, 0.0)]], np.ones(len(seen) + 1)].astype("<f4")
            message = cloud(file.types, header(file.types, t_s, "hero/LIDAR"), LAYOUT, rows, step=16)
            file.write(t_s, [Message(Topic(name, "sensor_msgs/msg/PointCloud2"), message) for name in topics])
    file.close()
    return path


@pytest.mark.parametrize("generation", Generation)
def test_a_map_of_the_scans_has_the_wall_at_its_place(generation: Generation, tmp_path: Path) -> None:
    name = "drive.bag" if generation is Generation.ROS_1 else "drive"
    path = bag(tmp_path / name, generation=generation)
    assert main(["ros", "scans", str(path), "-o", str(tmp_path / "scans")]) == 0
    assert len(list((tmp_path / "scans").glob("*.pcd"))) == len(TIMES_S)
    assert _joined(tmp_path) == pytest.approx(WALL[np.lexsort(WALL.T)], abs=1e-4)


def test_a_pose_between_two_transforms_lies_between_them(tmp_path: Path) -> None:
    path = bag(tmp_path / "drive", tf_s=(0.9, 1.1, 1.4, 1.6, 1.9, 2.1))
    assert main(["ros", "scans", str(path), "-o", str(tmp_path / "scans")]) == 0
    assert len(list((tmp_path / "scans").glob("*.pcd"))) == 3  # the last cloud came after the last transform
    assert _joined(tmp_path) == pytest.approx(WALL[np.lexsort(WALL.T)], abs=0.01)


def test_every_second_cloud(tmp_path: Path) -> None:
    path = bag(tmp_path / "drive")
    assert main(["ros", "scans", str(path), "-o", str(tmp_path / "scans"), "--every", "2"]) == 0
    assert sorted(each.name for each in (tmp_path / "scans").iterdir()) == ["000000.pcd", "000002.pcd", "poses.txt"]


def _joined(folder: Path) -> np.ndarray:
    """Return the points of the map that `linden map pointcloud` makes of the scans, one for each point of the wall."""
    target = folder / "map.pcd"
    assert linden_map(["map", "pointcloud", "--from", str(folder / "scans"), "-o", str(target), "--voxel", "0.2"]) == 0
    head, _, data = target.read_bytes().partition(b"DATA binary\n")
    words = {line.split()[0]: line.split()[1:] for line in head.decode().splitlines() if not line.startswith("#")}
    kinds = {"F": "f", "U": "u", "I": "i"}
    row = np.dtype(
        [
            (name, f"<{kinds[kind]}{size}")
            for name, kind, size in zip(words["FIELDS"], words["TYPE"], words["SIZE"], strict=True)
        ]
    )
    rows = np.frombuffer(data, row, int(words["POINTS"][0]))
    points = np.stack([rows[name] for name in "xyz"], axis=1).astype(float)
    return points[np.lexsort(np.round(points, 1).T)]


@pytest.mark.parametrize(
    ("made", "options", "says"),
    [
        ({}, ["--every", "0"], "--every is 0"),
        ({}, ["--topic", "/none"], "has no clouds on /none; it has /lidar"),
        ({"topics": ("/a", "/b")}, [], "several topics with clouds (/a, /b); choose one with --topic"),
        ({"topics": ()}, [], "has no topic with clouds"),
        ({"parent": "odom"}, [], "hero/LIDAR -> hero -> odom ends there; record /tf and /tf_static too"),
        ({"tf_s": (7.0, 8.0)}, [], "within the time of its transforms"),
    ],
)
def test_what_makes_no_map_is_a_sentence(
    made: dict[str, Sequence[str]],
    options: list[str],
    says: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = bag(tmp_path / "drive", **made)  # type: ignore[arg-type]
    assert main(["ros", "scans", str(path), "-o", str(tmp_path / "scans"), *options]) == 2
    assert says in capsys.readouterr().err
    assert sorted(each.name for each in tmp_path.iterdir()) == ["drive"]


def test_a_bag_that_is_none_is_a_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "x.mcap").write_bytes(b"rubbish")
    for name, says in (("x.mcap", "cannot be read"), ("y.mcap", "is not there")):
        assert main(["ros", "scans", str(tmp_path / name), "-o", str(tmp_path / "scans")]) == 2
        assert says in capsys.readouterr().err
