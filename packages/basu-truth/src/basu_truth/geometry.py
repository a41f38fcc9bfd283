"""Boxes in the frames of world, vehicle and sensor, and their projection into a pinhole camera.

CARLA's frames are left-handed: x forward, y right, z up. A camera looks along x; a pixel's column grows along y and its
row against z.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import carla
import numpy as np
from numpy.typing import NDArray

from basu_truth.rig import transform_of
from basu_truth.truth import Pose, Rectangle

if TYPE_CHECKING:
    from basu_truth.truth import Sensor

F64 = NDArray[np.float64]

CORNERS = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
EDGES = tuple((a, b) for a in range(8) for b in range(a + 1, 8) if int(np.sum(CORNERS[a] != CORNERS[b])) == 1)
NEAREST_M = 0.05  # what is nearer to a camera's plane than this is behind it
DEPTH_STEPS, FARTHEST_M = float(256**3 - 1), 1000.0  # of CARLA's depth camera


def matrix_of(transform: carla.Transform) -> F64:
    """Return the matrix (4, 4) from the frame of a transform into that in which it stands."""
    return np.array(transform.get_matrix())


def matrix(pose: Pose) -> F64:
    """Return the matrix (4, 4) of a pose."""
    return matrix_of(transform_of(pose))


def pose_of(transform: F64) -> Pose:
    """Return the pose of a matrix (4, 4): the inverse of `matrix`."""
    pitch = math.asin(max(-1.0, min(1.0, float(transform[2, 0]))))
    yaw = math.atan2(transform[1, 0], transform[0, 0])
    roll = math.atan2(-transform[2, 1], transform[2, 2])
    place = transform[:3, 3].tolist()
    return Pose(*place, *(math.degrees(angle) for angle in (roll, pitch, yaw)))


def corners_m(box_matrix: F64, size_m: tuple[float, float, float]) -> F64:
    """Return the corners (8, 3) of a box in the frame into which its matrix leads."""
    local = CORNERS * (np.array(size_m) / 2.0)
    return local @ box_matrix[:3, :3].T + box_matrix[:3, 3]


def focal_px(sensor: Sensor) -> float:
    """Return the focal length of a camera in pixels."""
    return sensor.width_px / (2.0 * math.tan(math.radians(sensor.fov_deg) / 2.0))


def projected(points_m: F64, sensor: Sensor) -> F64:
    """Return column and row (N, 2) of points (N, 3) in the camera's frame, all of them before it."""
    focal = focal_px(sensor)
    ahead = points_m[:, 0]
    column = sensor.width_px / 2.0 + focal * points_m[:, 1] / ahead
    row = sensor.height_px / 2.0 - focal * points_m[:, 2] / ahead
    return np.stack([column, row], axis=-1)


def box_outline(corners: F64, sensor: Sensor) -> Rectangle | None:
    """Return the rectangle around the projection of a box (8, 3) in the camera's frame, not cut at the picture's rim.

    Of a box that is partly behind the camera, the part before it is projected. None: all of it is behind.
    """
    points = [corner for corner in corners if corner[0] >= NEAREST_M]
    for a, b in EDGES:
        if (corners[a, 0] < NEAREST_M) != (corners[b, 0] < NEAREST_M):
            share = (NEAREST_M - corners[a, 0]) / (corners[b, 0] - corners[a, 0])
            points.append(corners[a] + share * (corners[b] - corners[a]))
    if not points:
        return None
    pixels = projected(np.array(points), sensor)
    (left, top), (right, bottom) = pixels.min(0).tolist(), pixels.max(0).tolist()
    return Rectangle(left, top, right - left, bottom - top)


def in_picture(outline: Rectangle, sensor: Sensor) -> Rectangle | None:
    """Return the part of a rectangle that is in the picture; None: nothing is."""
    left, top = max(0.0, outline.left), max(0.0, outline.top)
    right = min(float(sensor.width_px), outline.left + outline.width)
    bottom = min(float(sensor.height_px), outline.top + outline.height)
    return Rectangle(left, top, right - left, bottom - top) if right > left and bottom > top else None


def points_of_pixels(
    rows: NDArray[np.int64], columns: NDArray[np.int64], picture: NDArray[np.uint8], sensor: Sensor
) -> F64:
    """Return the points (N, 3) in the camera's frame that pixels show; ``picture`` (H, W, 4) is of a depth camera."""
    blue, green, red = (picture[rows, columns, channel].astype(np.float64) for channel in range(3))
    ahead = (red + 256.0 * green + 65536.0 * blue) / DEPTH_STEPS * FARTHEST_M
    focal = focal_px(sensor)
    right = (columns + 0.5 - sensor.width_px / 2.0) / focal * ahead
    up = -(rows + 0.5 - sensor.height_px / 2.0) / focal * ahead
    return np.stack([ahead, right, up], axis=-1)


def within_box(
    points_m: F64, box_matrix: F64, size_m: tuple[float, float, float], *, margin_m: float
) -> NDArray[np.bool_]:
    """Return which points (N, 3) of the world lie in a box, made larger by a margin on each side: (N,)."""
    local = (points_m - box_matrix[:3, 3]) @ box_matrix[:3, :3]
    inside: NDArray[np.bool_] = np.all(np.abs(local) <= np.array(size_m) / 2.0 + margin_m, axis=1)
    return inside
