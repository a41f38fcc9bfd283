"""Claims about writing PCD files."""

from pathlib import Path

import numpy as np
import pytest

from linden.errors import UserError
from linden_maps.pointcloud.cloud import Cloud
from linden_maps.pointcloud.pcd_reading import clouds_of, header_of
from linden_maps.pointcloud.pcd_writing import PcdWriter

POINTS = np.array([[1.5, -2.25, 3.0], [1e4, 0.125, -7.5]])


def test_a_file_says_what_pcl_says_of_its_own(tmp_path: Path) -> None:
    file = tmp_path / "a.pcd"
    with PcdWriter(file, "a remark") as writer:
        writer.write(Cloud(POINTS))
    head = file.read_bytes()[:-24].decode().splitlines()  # 24: two points of three floats
    assert head[0] == "# .PCD v0.7 - Point Cloud Data file format"
    assert head[1].split() == ["#", "a", "remark"]
    assert head[2:] == [
        "VERSION 0.7",
        "FIELDS x y z",
        "SIZE 4 4 4",
        "TYPE F F F",
        "COUNT 1 1 1",
        "WIDTH 2",
        "HEIGHT 1",
        "VIEWPOINT 0 0 0 1 0 0 0",
        "POINTS 2",
        "DATA binary",
    ]
    np.testing.assert_array_equal(np.frombuffer(file.read_bytes()[-24:], "<f4").reshape(2, 3), POINTS)


def test_clouds_written_one_after_the_other_are_one_file(tmp_path: Path) -> None:
    file = tmp_path / "a.pcd"
    with PcdWriter(file, "", labelled=True) as writer:
        for number in range(11):  # the number of points has two digits in the end, one before
            writer.write(Cloud(POINTS + number, np.array([number, 7], np.uint32)))
    assert header_of(file).points == writer.points == 22
    (cloud,) = clouds_of(file)
    np.testing.assert_array_equal(cloud.points_m, np.concatenate([POINTS + number for number in range(11)]))
    assert cloud.label is not None
    assert cloud.label[::2].tolist() == list(range(11))


def test_a_file_without_a_point_is_a_file(tmp_path: Path) -> None:
    with PcdWriter(tmp_path / "a.pcd", ""):
        pass
    assert header_of(tmp_path / "a.pcd").points == 0


def test_a_writer_that_breaks_off_leaves_what_was_there_before(tmp_path: Path) -> None:
    file = tmp_path / "a.pcd"
    file.write_bytes(b"old")

    def broken_off() -> None:
        with PcdWriter(file, "") as writer:
            writer.write(Cloud(POINTS))
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        broken_off()
    assert file.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [file]


def test_a_place_that_cannot_be_written_gets_a_sentence_before_any_work(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"cannot write .*: No such file or directory; name a file in a folder"):
        PcdWriter(tmp_path / "none" / "a.pcd", "")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="only Linux has a device that is always full")
def test_a_full_disk_gets_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "a.pcd.part").symlink_to("/dev/full")
    with (
        pytest.raises(UserError, match=r"cannot write .*No space left on device; name a file in a folder"),
        PcdWriter(tmp_path / "a.pcd", "") as writer,
    ):
        writer.write(Cloud(np.zeros((100_000, 3))))
    assert list(tmp_path.iterdir()) == []
