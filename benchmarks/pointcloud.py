"""Whether the memory of a point cloud map grows with the number of scans, and how fast its voxel filter is.

    python benchmarks/pointcloud.py [--places 300] [--points 5000000] [--peer-python PYTHON]

First Linden's streets are driven around one place, ever more often the same way: resident memory and the filter's own
tables after each drive. Then points over 400 m x 400 m of ground are filtered to cells of 0.2 m: ours in clouds of
100,000, a sort of all of them at once in numpy, and Open3D's filter, where the Python named has the package.
Seconds are of the processor, all threads together.
"""

import argparse
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
import psutil
from numpy.typing import NDArray

from linden.maps.cache import MapCache
from linden.maps.library import HOME_MAP, MapLibrary
from linden.maps.opendrive.parse import parse
from linden.scenery.map_mesh_cache import standing_of
from linden.sensors.casting.choose import caster_of
from linden.simulation.surroundings import scenery_of
from linden_maps.pointcloud.cloud import Cloud, in_map
from linden_maps.pointcloud.drive import Lidar, drive, places_along
from linden_maps.pointcloud.voxels import VoxelGrid

F64 = NDArray[np.float64]
VOXEL_M = 0.2
DRIVES = (1, 2, 4, 8)
PEER = """
import sys, time, numpy, open3d
points = numpy.load(sys.argv[1])
cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(points))
began = time.process_time()
print(len(cloud.voxel_down_sample(float(sys.argv[2])).points), time.process_time() - began)
"""


def repeated_drives(places: int) -> None:
    """Print memory after each number of drives along the same places."""
    cache = MapCache.of_user()
    world_map = MapLibrary((), cache.read).load(HOME_MAP)
    standing = standing_of(world_map, scenery_of(world_map).scene, cache)
    caster = caster_of(standing, [])
    along = places_along(parse(world_map.text), 5.0, 2.4)[:places]
    process = psutil.Process()
    print("scans   points M  cells M  tables MiB  resident MiB  CPU ms/scan")
    with tempfile.TemporaryDirectory() as folder:
        grid, done, came = VoxelGrid(VOXEL_M, Path(folder)), 0, 0
        for drives in DRIVES:
            began_s, before = time.process_time(), done
            while done < drives * len(along):
                for scan in drive(along, Lidar(), caster, standing):
                    cloud = in_map(scan)
                    grid.add(cloud)
                    came += len(cloud.points_m)
                done += len(along)
            each_ms = (time.process_time() - began_s) * 1e3 / (done - before)
            resident = process.memory_info().rss / 2**20
            tables = grid.bytes_in_memory / 2**20
            print(
                f"{done:5} {came / 1e6:10.1f} {grid.cells / 1e6:8.2f} {tables:11.0f} {resident:13.0f} {each_ms:12.1f}"
            )


def filters(count: int, peer: str | None) -> None:
    """Print what filters take on the same points."""
    dice = np.random.default_rng(1)
    points = dice.uniform(0.0, 400.0, (count, 3)) * (1.0, 1.0, 0.001)
    print(f"\n{count / 1e6:.0f} M points over 400 m x 400 m, cells of {VOXEL_M} m\n{'':12} M points/s  cells")
    for name, work in (("ours", ours), ("numpy sort", sorted_whole)):
        work(points[:1000])  # compiled
        began_s = time.process_time()
        cells = work(points)
        print(f"{name:12} {count / 1e6 / (time.process_time() - began_s):9.2f}  {cells:,}")
    if peer is None:
        print("Open3D       not asked: --peer-python names a Python that has open3d")
        return
    with tempfile.TemporaryDirectory() as folder:
        np.save(file := Path(folder) / "points.npy", points)
        told = subprocess.run([peer, "-c", PEER, file, str(VOXEL_M)], capture_output=True, text=True, check=True)
    cells, took_s = told.stdout.split()
    print(f"{'Open3D':12} {count / 1e6 / float(took_s):9.2f}  {int(cells):,}")


def ours(points: F64) -> int:
    with tempfile.TemporaryDirectory() as folder:
        grid = VoxelGrid(VOXEL_M, Path(folder))
        for start in range(0, len(points), 100_000):
            grid.add(Cloud(points[start : start + 100_000]))
        return sum(len(cloud.points_m) for cloud in grid.clouds())


def sorted_whole(points: F64) -> int:
    cell = np.floor(points / VOXEL_M).astype(np.int64)
    key = (cell[:, 2] << 42) + (cell[:, 1] << 21) + cell[:, 0]
    order = np.argsort(key, kind="stable")
    starts = np.flatnonzero(np.diff(key[order], prepend=-1))
    means = np.add.reduceat(points[order], starts, axis=0) / np.diff(np.append(starts, len(key)))[:, None]
    return len(means)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--places", type=int, default=300)
    parser.add_argument("--points", type=int, default=5_000_000)
    parser.add_argument("--peer-python", metavar="PYTHON")
    arguments = parser.parse_args()
    repeated_drives(arguments.places)
    filters(arguments.points, arguments.peer_python)


if __name__ == "__main__":
    main()
