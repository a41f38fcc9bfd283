"""Claims about scans that are there already."""

from pathlib import Path

import numpy as np
import pytest

from fakes.pcd_files import pcd
from linden.errors import UserError
from linden_maps.pointcloud.cloud import Cloud, Scan, in_map
from linden_maps.pointcloud.drive import SensorPlace
from linden_maps.pointcloud.scan_folder import kept_scans, recorded

POINT = {"x": np.float32([1.0]), "y": np.float32([2.0]), "z": np.float32([3.0])}
LABELLED = {**POINT, "label": np.uint32([7])}


def merged(folder: Path, poses: Path | None = None) -> list[list[float]]:
    return [point for scan in recorded(folder, poses).scans() for point in in_map(scan).points_m.tolist()]


def test_without_poses_scans_lie_in_the_map_already(tmp_path: Path) -> None:
    for name in ("b", "a"):
        pcd(tmp_path / f"{name}.pcd", {**POINT, "x": np.float32([ord(name)])}, "binary")
    (tmp_path / "notes.md").write_text("not a scan")
    assert merged(tmp_path) == [[97.0, 2.0, 3.0], [98.0, 2.0, 3.0]]  # in the order of their names
    assert not recorded(tmp_path).moved


def test_poses_of_the_folder_are_used_and_others_before_them(tmp_path: Path) -> None:
    pcd(tmp_path / "a.pcd", POINT, "ascii")
    (tmp_path / "poses.txt").write_text("a 10 0 0 0 0 0 1\n")
    (tmp_path / "better.txt").write_text("a 20 0 0 0 0 0 1\n")
    assert merged(tmp_path) == [[11.0, 2.0, 3.0]]
    assert merged(tmp_path, tmp_path / "better.txt") == [[21.0, 2.0, 3.0]]


def test_a_single_file_is_taken_too(tmp_path: Path) -> None:
    assert merged(pcd(tmp_path / "a.pcd", POINT, "binary_compressed")) == [[1.0, 2.0, 3.0]]


def test_labels_are_kept_where_every_file_has_them(tmp_path: Path) -> None:
    pcd(tmp_path / "a.pcd", LABELLED, "binary")
    assert recorded(tmp_path).labelled
    pcd(tmp_path / "b.pcd", POINT, "binary")
    found = recorded(tmp_path)
    assert not found.labelled
    assert found.points == 2
    assert [scan.cloud.label for scan in found.scans()] == [None, None]


def test_a_folder_without_scans_gets_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"holds no \.pcd file"):
        recorded(tmp_path)


def test_kept_scans_come_back_where_they_were(tmp_path: Path) -> None:
    points = np.array([[1.0, 2.0, 3.0], [-4.0, 0.5, 0.0]])
    poses = [SensorPlace(100.0, 50.0, 2.0, 0.5), SensorPlace(-3.0, 7.0, 240.0, -3.0)]
    scans = [Scan(pose.map_from_sensor, Cloud(points * (n + 1), np.uint32([n, 9])), 1) for n, pose in enumerate(poses)]
    assert list(kept_scans(scans, tmp_path / "new")) == scans
    for scan, again in zip(scans, recorded(tmp_path / "new").scans(), strict=True):
        np.testing.assert_allclose(in_map(again).points_m, in_map(scan).points_m, atol=1e-5)
        assert again.cloud.label.tolist() == scan.cloud.label.tolist()


def test_a_folder_that_cannot_be_made_gets_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(UserError, match=r"cannot write to .*file/scans: Not a directory"):
        next(kept_scans([], tmp_path / "file" / "scans"))


def test_scans_of_another_drive_are_not_mixed_with_these(tmp_path: Path) -> None:
    pcd(tmp_path / "000007.pcd", POINT, "binary")
    with pytest.raises(UserError, match="holds scans already; name a new folder"):
        next(kept_scans([], tmp_path))
