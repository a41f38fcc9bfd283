"""KITTI's object benchmark: ``training`` with ``image_2``, ``velodyne``, ``label_2`` and ``calib``.

Source: readme.txt of the object development kit (devkit_object), Geiger et al., CVPR 2012. KITTI has one camera and one
lidar: the first ones of the export. A camera's frame is x right, y down, z forward; a lidar's x forward, y left, z up.
The rectangle is that of the whole object, as if nothing were in front of it; ``occluded`` says how much is hidden.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from basu.errors import UserError
from basu.files import write_bytes
from basu_truth.clouds import points_of
from basu_truth.geometry import focal_px
from basu_truth.pictures import write_picture
from basu_truth.rig import LIDARS
from basu_truth.right_handed import FROM_CAMERA, right_handed

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from basu_truth.scene import Shot
    from basu_truth.truth import SeenObject, Sensor, Truth

TYPE = {"car": "Car", "truck": "Truck", "pedestrian": "Pedestrian", "bicycle": "Cyclist"}
OTHER_TYPE = "Misc"
"""KITTI's type of objects that it has no type for: buses, motorcycles, animals, cones and barriers."""
OCCLUDED = ((0.8, 0), (0.4, 1), (0.0, 2))
"""Visible shares from which an object is fully visible, partly occluded, largely occluded."""
UNKNOWN = 3


class KittiWriter:
    """Writes the first camera and the first lidar of an export."""

    def __init__(self, folder: Path, sensors: Sequence[Sensor]) -> None:
        """Choose the sensors.

        Raises:
            UserError: there is no camera.
        """
        self._folder = folder / "training"
        self._camera = next((each for each in sensors if each.is_camera), None)
        self._lidar = next((each for each in sensors if not each.is_camera), None)
        if self._camera is None:
            raise UserError("--format kitti needs a camera, and the sensors have none; choose another with --sensors")

    def write(self, shot: Shot, objects: Sequence[SeenObject]) -> None:
        """Write picture, cloud, labels and calibration of a frame."""
        assert self._camera is not None, "there is one"
        name = f"{shot.number:06d}"
        write_picture(self._folder / "image_2" / f"{name}.png", shot.measured[self._camera.id][self._camera.type_id])
        if self._lidar is not None:
            measured = shot.measured[self._lidar.id][self._lidar.type_id]
            points = points_of(measured, is_semantic=self._lidar.type_id == LIDARS[1])
            points[:, 1] *= -1.0
            self._write("velodyne", f"{name}.bin", points.astype("<f4").tobytes())
        lines = [label(each) for each in objects if each.sensor == self._camera.id]
        self._write("label_2", f"{name}.txt", "".join(f"{line}\n" for line in lines).encode())
        self._write("calib", f"{name}.txt", calibration(self._camera, self._lidar).encode())

    def finish(self, truth: Truth) -> None:
        """End the export; each frame of KITTI has its files already."""

    def _write(self, kind: str, name: str, data: bytes) -> None:
        (self._folder / kind).mkdir(parents=True, exist_ok=True)
        write_bytes(self._folder / kind / name, data)


def label(seen: SeenObject) -> str:
    """Return the line of an object that a camera saw."""
    assert seen.whole_rectangle is not None, "a camera saw it"
    left, top, width, height = seen.whole_rectangle
    pose, (length_m, width_m, height_m) = seen.box_in_sensor, seen.size_m
    yaw = math.radians(pose.yaw_deg) - math.pi / 2.0  # 0 is to the right of the camera, and the axis points down
    right_m, down_m, ahead_m = pose.y_m, -pose.z_m + height_m / 2.0, pose.x_m
    alpha = _wrapped(yaw - math.atan2(right_m, ahead_m))
    share = seen.visibility
    occluded = UNKNOWN if share is None else next(level for least, level in OCCLUDED if share >= least)
    numbers = (
        *(f"{value:.2f}" for value in (alpha, left, top, left + width, top + height)),
        *(f"{value:.3f}" for value in (height_m, width_m, length_m, right_m, down_m, ahead_m)),
        f"{_wrapped(yaw):.4f}",
    )
    return " ".join((TYPE.get(seen.category, OTHER_TYPE), f"{seen.truncation or 0.0:.2f}", str(occluded), *numbers))


def calibration(camera: Sensor, lidar: Sensor | None) -> str:
    """Return the calibration of a frame; all four of KITTI's cameras are the one camera."""
    focal = focal_px(camera)
    projection = [focal, 0.0, camera.width_px / 2.0, 0.0, 0.0, focal, camera.height_px / 2.0, 0.0, 0.0, 0.0, 1.0, 0.0]
    to_camera = np.linalg.inv(right_handed(camera.pose) @ FROM_CAMERA)
    of_lidar = np.eye(4) if lidar is None else right_handed(lidar.pose)
    rows = {f"P{number}": projection for number in range(4)}
    rows["R0_rect"] = np.eye(3).ravel().tolist()
    rows["Tr_velo_to_cam"] = _rows(to_camera @ of_lidar)
    rows["Tr_imu_to_velo"] = _rows(np.linalg.inv(of_lidar))  # the vehicle's frame takes the place of the IMU's
    return "".join(f"{name}: {' '.join(f'{value:.12e}' for value in values)}\n" for name, values in rows.items())


def _rows(transform: NDArray[np.floating[Any]]) -> list[float]:
    """Return the upper three rows of a matrix (4, 4) one after the other."""
    values: list[float] = transform[:3].ravel().tolist()
    return values


def _wrapped(angle_rad: float) -> float:
    """Return an angle within half a turn."""
    return math.remainder(angle_rad, 2.0 * math.pi)
