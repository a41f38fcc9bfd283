"""Draws a labelled point cloud map: the whole of it and its middle from above, and a close-up from a roof.

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

from linden.protocol.values.enums import SemanticTag
from linden_maps.pointcloud.pcd_reading import clouds_of

F64 = NDArray[np.float64]
Picture = NDArray[np.uint8]

BACKGROUND = np.array([10, 12, 16])
WHOLE_PIXELS = 1300
FINER = 2  # pixels drawn for each that is kept, so that thin things count for what they are
GROUND_CELL_M = 8.0
MIDDLE_M, MIDDLE_HALF_M = np.array([150.0, 60.0]), np.array([420.0, 300.0])  # the streets around the transit centre
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


class Ground(NamedTuple):
    """The lowest point of each square of GROUND_CELL_M, m, and where the squares begin."""

    low_m: F64  # (2,)
    high_m: F64  # (2,)
    lowest_m: F64  # (across, up)

    def above(self, points: F64) -> F64:
        """Return how high (N,) points are over the lowest one of their square, m."""
        height: F64 = points[:, 2] - self.lowest_m[tuple(self.square_of(points).T)]
        return height

    def square_of(self, points: F64) -> NDArray[np.int64]:
        """Return the column and row (N, 2) of points."""
        return np.floor((points[:, :2] - self.low_m) / GROUND_CELL_M).astype(np.int64)


def ground_of(file: Path) -> Ground:
    """Read the file once, for what is lowest everywhere.

    Raises:
        SystemExit: the points have no labels.
    """
    low, high = np.full(2, np.inf), np.full(2, -np.inf)
    for cloud in clouds_of(file):
        if cloud.label is None:
            raise SystemExit(f"{file} has no labels; make it with --labels")
        low, high = (
            np.minimum(low, cloud.points_m[:, :2].min(axis=0)),
            np.maximum(high, cloud.points_m[:, :2].max(axis=0)),
        )
    ground = Ground(low, high, np.full(tuple(((high - low) // GROUND_CELL_M + 1).astype(int)), np.inf))
    for cloud in clouds_of(file):
        square = ground.square_of(cloud.points_m)
        order = np.lexsort((-cloud.points_m[:, 2], square[:, 1], square[:, 0]))  # the lowest of a square comes last
        column, row = square[order].T
        lowest = ground.lowest_m
        last = np.append((column[1:] != column[:-1]) | (row[1:] != row[:-1]), [True])
        at = column[last], row[last]
        lowest[at] = np.minimum(lowest[at], cloud.points_m[order[last], 2])
    return ground


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


class Sheet:
    """A rectangle from above, north being up; the highest point of a pixel is the one that is seen."""

    def __init__(self, low_m: F64, high_m: F64) -> None:
        size = high_m - low_m
        self._low, self._high, self._metres = low_m, high_m, size.max() / (WHOLE_PIXELS * FINER)
        across, down = (int(length / self._metres) // FINER * FINER + FINER for length in size)
        self._colour = np.tile(BACKGROUND.astype(np.uint8), (down, across, 1))
        self._height_m = np.full((down, across), -np.inf)
        print(f"from above: {self._metres * FINER:.2f} m a pixel, {size[0]:.0f} m x {size[1]:.0f} m")

    def draw(self, points: F64, height_m: F64, colour: Picture) -> None:
        """Add points."""
        inside = ((points[:, :2] >= self._low) & (points[:, :2] <= self._high)).all(axis=1)
        order = np.flatnonzero(inside)
        order = order[np.argsort(height_m[order], kind="stable")]
        column, up = np.floor((points[order, :2] - self._low) / self._metres).astype(np.int64).T
        at = len(self._colour) - 1 - up, column
        highest = height_m[order] >= self._height_m[at]
        at = at[0][highest], at[1][highest]
        self._height_m[at], self._colour[at] = height_m[order][highest], colour[order][highest]

    def picture(self) -> Picture:
        """Return it, thin things counting for what they are."""
        down, across, _ = self._colour.shape
        parts = self._colour.reshape(down // FINER, FINER, across // FINER, FINER, 3)
        return parts.mean(axis=(1, 3)).astype(np.uint8)


def close_up(points: F64, colour: Picture, view: View) -> Picture:
    """Return what a camera among the points sees of them."""
    apart = points - (view.x_m, view.y_m, 0.0)
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
    """Write the pictures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path)
    parser.add_argument("--folder", type=Path, default=Path("docs/images"))
    parser.add_argument("--at", type=float, nargs=4, default=(0.0, 0.0, 14.0, 40.0), metavar=("X", "Y", "UP", "DEG"))
    arguments = parser.parse_args()
    view = View(*arguments.at, 18.0)
    ground = ground_of(arguments.file)
    sheets = Sheet(ground.low_m, ground.high_m), Sheet(MIDDLE_M - MIDDLE_HALF_M, MIDDLE_M + MIDDLE_HALF_M)
    near, tints = [], []
    for cloud in clouds_of(arguments.file):
        height_m = ground.above(cloud.points_m)
        colour = colours(height_m, cloud.label)
        for sheet in sheets:
            sheet.draw(cloud.points_m, height_m, colour)
        seen = (np.abs(cloud.points_m[:, :2] - (view.x_m, view.y_m)) < view.far_m).all(axis=1)
        near.append(cloud.points_m[seen])
        tints.append(colour[seen])
    for name, picture in (
        ("pointcloud-map.jpg", sheets[0].picture()),
        ("pointcloud-middle.jpg", sheets[1].picture()),
        ("pointcloud-close.jpg", close_up(np.concatenate(near), np.concatenate(tints), view)),
    ):
        matplotlib.image.imsave(arguments.folder / name, picture, pil_kwargs={"quality": 84, "optimize": True})
        print(f"{arguments.folder / name}: {picture.shape[1]} x {picture.shape[0]}")


if __name__ == "__main__":
    main()
