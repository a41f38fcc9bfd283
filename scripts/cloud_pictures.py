"""Draws a labelled point cloud map: the whole of it from above, and a close-up from a roof.

    linden map pointcloud Linden -o linden.pcd --labels
    python scripts/cloud_pictures.py linden.pcd [--folder docs/images]

Needs no viewer and no display: points are put into pixels, what is nearer over what is farther.
"""

import argparse
import math
from pathlib import Path
from typing import NamedTuple

import matplotlib.image
import numpy as np
from matplotlib import colormaps
from numpy.typing import NDArray

from linden.pointcloud.pcd_reading import clouds_of
from linden.values.enums import SemanticTag

F64 = NDArray[np.float64]
Picture = NDArray[np.uint8]

BACKGROUND = np.array([10, 12, 16])
WHOLE_PIXELS = 1300
FINER = 2  # pixels drawn for each that is kept, so that thin things count for what they are
GROUND_CELL_M = 8.0
TALLEST_M = 9.0  # what is higher above the ground has the last colour


class View(NamedTuple):
    """A camera among the points: where it is in the map, m, and where it looks, degrees."""

    x_m: float
    y_m: float
    above_m: float  # the lowest point near it
    heading_deg: float  # counter-clockwise from east
    down_deg: float
    width: int = 1400
    height: int = 700
    fov_deg: float = 70.0
    far_m: float = 260.0


def read(file: Path) -> tuple[F64, NDArray[np.uint32]]:
    """Return all points and their labels.

    Raises:
        SystemExit: the cloud has none.
    """
    clouds = list(clouds_of(file))
    if any(cloud.label is None for cloud in clouds):
        raise SystemExit(f"{file} has no labels; make it with --labels")
    return np.concatenate([cloud.points_m for cloud in clouds]), np.concatenate([cloud.label for cloud in clouds])


def above_ground(points: F64) -> F64:
    """Return how high (N,) each point is over the lowest one of its neighbourhood, m."""
    cell = np.floor((points[:, :2] - points[:, :2].min(axis=0)) / GROUND_CELL_M).astype(np.int64)
    number = cell[:, 0] * (cell[:, 1].max() + 1) + cell[:, 1]
    lowest = np.full(number.max() + 1, np.inf)
    np.minimum.at(lowest, number, points[:, 2])
    height: F64 = points[:, 2] - lowest[number]
    return height


def colours(height_m: F64, label: NDArray[np.uint32]) -> Picture:
    """Return (N, 3): streets in greys, lines white, everything else by its height."""
    share = np.clip(height_m / TALLEST_M, 0.0, 1.0)
    found = (colormaps["turbo"](0.12 + 0.85 * share)[:, :3] * 255.0).astype(np.uint8)
    for tag, colour in (
        (SemanticTag.ROADS, (92, 96, 112)),
        (SemanticTag.ROAD_LINES, (255, 250, 225)),
        (SemanticTag.SIDEWALKS, (150, 146, 140)),
        (SemanticTag.TERRAIN, (34, 62, 50)),
    ):
        found[label == tag] = colour
    return found


def whole(points: F64, height_m: F64, colour: Picture) -> Picture:
    """Return everything from above, north being up; the highest point of a pixel is the one that is seen."""
    low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    metres = (high - low).max() / (WHOLE_PIXELS * FINER)
    column, row = np.floor((points[:, :2] - low) / metres).astype(np.int64).T
    across, down = (int(size / metres) // FINER * FINER + FINER for size in high - low)
    sheet = np.empty((down, across, 3), np.uint8)
    sheet[:] = BACKGROUND
    order = np.argsort(height_m, kind="stable")
    sheet[down - 1 - row[order], column[order]] = colour[order]
    print(f"from above: {metres * FINER:.2f} m a pixel, {high[0] - low[0]:.0f} m x {high[1] - low[1]:.0f} m")
    return sheet.reshape(down // FINER, FINER, across // FINER, FINER, 3).mean(axis=(1, 3)).astype(np.uint8)


def close_up(points: F64, colour: Picture, view: View) -> Picture:
    """Return what a camera among the points sees of them."""
    apart = points - (view.x_m, view.y_m, 0.0)
    near = np.flatnonzero((np.abs(apart[:, :2]) < view.far_m).all(axis=1))
    apart, colour = apart[near], colour[near]
    at_foot = np.hypot(apart[:, 0], apart[:, 1]) < 15.0
    apart[:, 2] -= apart[at_foot, 2].min() + view.above_m
    yaw, down = math.radians(view.heading_deg), math.radians(view.down_deg)
    ahead = np.array([math.cos(yaw) * math.cos(down), math.sin(yaw) * math.cos(down), -math.sin(down)])
    right = np.array([math.sin(yaw), -math.cos(yaw), 0.0])
    depth, across, up = apart @ ahead, apart @ right, apart @ np.cross(right, ahead)
    seen = np.flatnonzero((depth > 4.0) & (depth < view.far_m))
    seen = seen[np.argsort(-depth[seen], kind="stable")]
    focal = 0.5 * view.width / math.tan(math.radians(0.5 * view.fov_deg))
    column = 0.5 * view.width + focal * across[seen] / depth[seen]
    row = 0.5 * view.height - focal * up[seen] / depth[seen]
    half = np.clip(0.5 * 0.2 * focal / depth[seen], 0.5, 4.0)  # a point stands for a cell of 0.2 m
    fade = np.clip(1.15 - depth[seen] / view.far_m, 0.15, 1.0)[:, None]
    shown = (colour[seen] * fade + BACKGROUND * (1.0 - fade)).astype(np.uint8)
    sheet = np.empty((view.height, view.width, 3), np.uint8)
    sheet[:] = BACKGROUND
    for r, c, h, tint in zip(row.tolist(), column.tolist(), half.tolist(), shown, strict=True):
        sheet[max(0, int(r - h)) : max(0, int(r + h) + 1), max(0, int(c - h)) : max(0, int(c + h) + 1)] = tint
    return sheet


def main() -> None:
    """Write both pictures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path)
    parser.add_argument("--folder", type=Path, default=Path("docs/images"))
    parser.add_argument("--at", type=float, nargs=4, default=(0.0, 0.0, 14.0, 40.0), metavar=("X", "Y", "UP", "DEG"))
    arguments = parser.parse_args()
    points, label = read(arguments.file)
    height_m = above_ground(points)
    colour = colours(height_m, label)
    view = View(*arguments.at, 18.0)
    for name, sheet in (
        ("pointcloud-map.jpg", whole(points, height_m, colour)),
        ("pointcloud-close.jpg", close_up(points, colour, view)),
    ):
        matplotlib.image.imsave(arguments.folder / name, sheet, pil_kwargs={"quality": 84, "optimize": True})
        print(f"{arguments.folder / name}: {sheet.shape[1]} x {sheet.shape[0]}")


if __name__ == "__main__":
    main()
