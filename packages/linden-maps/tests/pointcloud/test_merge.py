"""Claims about scans brought together."""

from pathlib import Path

import numpy as np
import pytest

from linden_maps.pointcloud.cloud import HERE, Cloud, Scan
from linden_maps.pointcloud.merge import merge
from linden_maps.pointcloud.pcd_reading import clouds_of
from linden_maps.pointcloud.pcd_writing import PcdWriter

SCANS = [Scan(HERE, Cloud(np.array([[0.05, 0.05, 0.05], [x, 1.0, 1.0]]) + 0.01), 1) for x in (1.0, 2.0, 3.0)]


@pytest.mark.parametrize(("voxel_m", "written"), [(0.0, 6), (0.1, 4), (100.0, 1)])
def test_one_point_is_left_of_each_cell_and_all_where_there_are_none(
    voxel_m: float, written: int, tmp_path: Path
) -> None:
    told: list[int] = []
    with PcdWriter(tmp_path / "a.pcd", "") as writer:
        merged = merge(iter(SCANS), writer, voxel_m, tmp_path, told.append)
    assert merged == (6, written)
    assert told == [1, 1, 1]
    assert sum(len(cloud.points_m) for cloud in clouds_of(tmp_path / "a.pcd")) == written


def test_scans_are_taken_one_at_a_time(tmp_path: Path) -> None:
    asked: list[str] = []

    def scans():
        for scan in SCANS:
            asked.append("scan")
            yield scan

    with PcdWriter(tmp_path / "a.pcd", "") as writer:
        merge(scans(), writer, 0.1, tmp_path, lambda _amount: asked.append("done"))
    assert asked == ["scan", "done"] * 3
