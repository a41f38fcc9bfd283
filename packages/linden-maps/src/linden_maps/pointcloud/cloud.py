"""Points and where they were measured from, as every step of making a map hands them on.

Frames of this package are right-handed, as those of ROS and of Autoware: a sensor's x forward, y left, z up; a map's x
east, y north, z up. CARLA's are met where rays are cast and nowhere else.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kernel

F64 = NDArray[np.float64]
U32 = NDArray[np.uint32]

HERE: F64 = np.eye(3, 4)
"""The pose of a cloud that lies in the map's frame already."""


class Cloud(NamedTuple):
    """Points (N, 3) in m, and what each is part of (N,) where that is known: CARLA's semantic tags."""

    points_m: F64
    label: U32 | None = None


class Scan(NamedTuple):
    """A cloud in the sensor's frame."""

    map_from_sensor: F64  # (3, 4): rotation and place
    cloud: Cloud
    amount: int  # of the whole work, in what the progress bar counts


def in_map(scan: Scan) -> Cloud:
    """Return the points of a scan in the map's frame, without points that are not finite."""
    points, label = scan.cloud
    moved = np.empty((len(points), 3))
    known = _moved(np.ascontiguousarray(points, np.float64), scan.map_from_sensor, moved)
    if known.all():
        return Cloud(moved, label)
    return Cloud(moved[known], None if label is None else label[known])


@kernel
def _moved(points_m: F64, pose: F64, moved_m: F64) -> NDArray[np.bool_]:
    """Write the points where a pose takes them; return which are finite."""
    known = np.empty(len(points_m), np.bool_)
    for row in range(len(points_m)):
        x, y, z = points_m[row]
        for axis in range(3):
            moved_m[row, axis] = pose[axis, 0] * x + pose[axis, 1] * y + pose[axis, 2] * z + pose[axis, 3]
        known[row] = np.isfinite(moved_m[row]).all()
    return known
