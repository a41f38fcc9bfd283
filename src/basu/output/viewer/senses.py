"""What sensors measured, as it is shown: pictures, clouds, radar echoes; what an agent holds stays as it is."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import carla
import numpy as np
import rerun as rr

from basu.output.viewer.frames import Pose, shown, turned

if TYPE_CHECKING:
    from numpy.typing import NDArray

EVERY_S = 0.1  # of simulated time between two pictures or clouds of one sensor: a file of a whole ride stays handy
JPEG_QUALITY = 75
FAR_M = 1000.0  # what a depth of 1 means: CARLA's cameras, "Depth camera" of the sensors' reference
SMALL, LARGE = np.array([-1.5]), np.array([-3.0])  # radii in points on the screen: Rerun has them negative
SEMANTIC_RAY = np.dtype([("xyz", "<f4", (3,)), ("cos", "<f4"), ("id", "<u4"), ("tag", "<u4")])


def show(recording: Any, sensor_id: str, type_id: str, measured: Any) -> None:  # noqa: ANN401 - rerun and carla
    """Show one measurement; what is neither picture nor cloud is left to the signals."""
    name = rr.escape_entity_path_part(sensor_id)
    if isinstance(measured, carla.Image):
        recording.log(f"cameras/{name}", picture(measured, type_id))
        return
    points = cloud(measured)
    if points is not None:
        at, angle = measured.transform.location, measured.transform.rotation
        pose = Pose(at.x, at.y, at.z, *(math.radians(a) for a in (angle.roll, angle.pitch, angle.yaw)))
        recording.log(f"world/sensors/{name}", rr.Transform3D(translation=shown(pose[:3]), mat3x3=turned(pose)))
        recording.log(f"world/sensors/{name}/points", points)


def picture(image: carla.Image, type_id: str) -> Any:  # noqa: ANN401 - an archetype of Rerun's
    """A camera's picture: colours as JPEG, depth in m, tags as classes."""
    bgra = np.frombuffer(image.raw_data, dtype=np.uint8).reshape(image.height, image.width, 4)
    if type_id.endswith("depth"):
        parts = bgra[:, :, :3].astype(np.uint32)
        depth = parts[:, :, 2] + (parts[:, :, 1] << 8) + (parts[:, :, 0] << 16)
        return rr.DepthImage((depth * (FAR_M * 10.0 / 0xFFFFFF)).astype(np.uint16), meter=10.0)
    if type_id.endswith("segmentation"):
        return rr.SegmentationImage(np.ascontiguousarray(bgra[:, :, 2]))
    return rr.Image(np.ascontiguousarray(bgra[:, :, 2::-1])).compress(jpeg_quality=JPEG_QUALITY)


def cloud(measured: Any) -> Any:  # noqa: ANN401 - an archetype of Rerun's
    """The points of a lidar or radar in its own frame; None of anything else."""
    if isinstance(measured, carla.LidarMeasurement):
        rays = np.frombuffer(measured.raw_data, dtype="<f4").reshape(-1, 4)
        return rr.Points3D(shown(rays[:, :3]), colors=grey(rays[:, 3]), radii=SMALL)
    if isinstance(measured, carla.SemanticLidarMeasurement):
        hits = np.frombuffer(measured.raw_data, dtype=SEMANTIC_RAY)
        return rr.Points3D(shown(hits["xyz"]), class_ids=hits["tag"].astype(np.uint16), radii=SMALL)
    if isinstance(measured, carla.RadarMeasurement):
        echoes = np.frombuffer(measured.raw_data, dtype="<f4").reshape(-1, 4)  # velocity, azimuth, altitude, depth
        azimuth, altitude, depth_m = echoes[:, 1], echoes[:, 2], echoes[:, 3]
        flat_m = depth_m * np.cos(altitude)
        points = np.column_stack([flat_m * np.cos(azimuth), flat_m * np.sin(azimuth), depth_m * np.sin(altitude)])
        return rr.Points3D(shown(points), colors=[(255, 140, 0)], radii=LARGE)
    return None


def grey(intensity: NDArray[np.float32]) -> NDArray[np.uint8]:
    """(N, 3) a lidar's intensity in [0, 1] as brightness, dim enough to see the road through it."""
    level = (90.0 + 165.0 * np.clip(intensity, 0.0, 1.0)).astype(np.uint8)
    return np.column_stack([level, level, level])
