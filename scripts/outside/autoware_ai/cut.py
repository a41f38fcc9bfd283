"""The part of a content folder's point cloud that lies near a route, for ndt_matching, which keeps the cloud in memory.

    python scripts/outside/autoware_ai/cut.py CONTENTS TOWN.xodr ROUTE.xml OUT [--within M]

CONTENTS is the folder of ``linden map package ... --ros1``. OUT gets the same vector maps, by links, and the part.
"""

import argparse
import sys
from pathlib import Path

import carla
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from basu.routing import plan as joined
from basu.routing.route_file import read_routes

ROWS = 4_000_000  # at a time
CELL_M = 2.0  # points of one cell are kept or left together
POINT = 3 * 4  # bytes: x, y, z


def main() -> int:
    """Cut, and say how much is left."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("contents", type=Path)
    parser.add_argument("opendrive", type=Path)
    parser.add_argument("route", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--within", type=float, default=60.0, metavar="M", help="of the route (default: 60)")
    args = parser.parse_args()
    town = args.opendrive.stem
    carla_map = carla.Map(town, args.opendrive.read_text(encoding="utf-8"))
    way = joined(carla_map, read_routes(args.route)[0]).points_m[::2, :2] * (1.0, -1.0)
    made = args.out / "maps" / "point_cloud_maps"
    made.mkdir(parents=True, exist_ok=True)
    link = args.out / "maps" / "vector_maps"
    if not link.exists():
        link.symlink_to((args.contents / "maps" / "vector_maps").resolve())
    head, points = read_cloud(args.contents / "maps" / "point_cloud_maps" / f"{town}.pcd")
    band = Band(way, args.within)
    kept = [band.of(points[first : first + ROWS]) for first in range(0, len(points), ROWS)]
    count = sum(map(len, kept))
    for word in ("WIDTH", "POINTS"):
        head = head.replace(f"{word} {len(points)}\n", f"{word} {count}\n")
    with (made / f"{town}.pcd").open("wb") as file:
        file.write(head.encode())
        for part in kept:
            file.write(part.tobytes())
    print(f"{count} of {len(points)} points lie within {args.within:g} m of the route")
    return 0


def read_cloud(path: Path) -> tuple[str, NDArray[np.float32]]:
    """The head of one of our clouds, and its points, which stay on the disk."""
    with path.open("rb") as file:
        lines: list[bytes] = []
        while not lines or not lines[-1].startswith(b"DATA"):
            lines.append(file.readline())
        return b"".join(lines).decode(), np.memmap(path, "<f4", "r", offset=file.tell()).reshape(-1, POINT // 4)


class Band:
    """The cells of a grid that lie near a way."""

    def __init__(self, way: NDArray[np.float64], within_m: float) -> None:
        """Find the cells."""
        self._corner = way.min(axis=0) - within_m
        counts = np.ceil((way.max(axis=0) + within_m - self._corner) / CELL_M).astype(int)
        middles = np.stack(np.meshgrid(*(np.arange(count) + 0.5 for count in counts), indexing="ij"), axis=-1)
        away, _ = cKDTree(way).query(middles * CELL_M + self._corner, distance_upper_bound=within_m)
        self._is_near = np.isfinite(away)

    def of(self, points: NDArray[np.float32]) -> NDArray[np.float32]:
        """The points in these cells."""
        cells = np.floor((points[:, :2] - self._corner) / CELL_M).astype(int)
        inside = np.flatnonzero(((cells >= 0) & (cells < self._is_near.shape)).all(axis=1))
        return np.ascontiguousarray(points[inside[self._is_near[tuple(cells[inside].T)]]])


if __name__ == "__main__":
    sys.exit(main())
