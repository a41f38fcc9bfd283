"""Scans brought together into one file: transformed, and filtered by a voxel grid or merely put one after the other."""

import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import NamedTuple

from linden_maps.pointcloud.cloud import Scan, in_map
from linden_maps.pointcloud.pcd_writing import PcdWriter
from linden_maps.pointcloud.voxels import VoxelGrid


class Merged(NamedTuple):
    """How many points came, and how many are in the file."""

    came: int
    written: int


def working_folder() -> "tempfile.TemporaryDirectory[str]":
    """Return a folder for a merger's cells, which is gone when the context is left."""
    return tempfile.TemporaryDirectory(prefix="linden-voxels-")


def merge(
    scans: Iterable[Scan], writer: PcdWriter, voxel_m: float, folder: Path, progress: Callable[[int], object]
) -> Merged:
    """Write the points of all scans in the map's frame; where ``voxel_m`` is positive, one for each cell of that width.

    Memory does not grow with the number of scans: cells wait in ``folder``. ``progress`` receives the amount of work
    behind each scan.

    Raises:
        UserError: a scan cannot be read, or the file not be written.
    """
    came = 0
    grid = VoxelGrid(voxel_m, folder) if voxel_m > 0.0 else None
    for scan in scans:
        cloud = in_map(scan)
        came += len(cloud.points_m)
        if grid is None:
            writer.write(cloud)
        else:
            grid.add(cloud)
        progress(scan.amount)
    if grid is not None:
        for cloud in grid.clouds():
            writer.write(cloud)
    return Merged(came, writer.points)
