"""Measurements made of the leaderboard's arrays, in the shape that a BASU agent expects from CARLA.

CARLA's own classes cannot be made by hand; these have their attributes as far as the host hands them on.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import carla
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from basu.agents.sensor_file import SensorSpec


@dataclass(frozen=True, slots=True, kw_only=True)
class Image:
    """As ``carla.Image``: ``raw_data`` is blue, green, red, alpha, a byte each, row by row."""

    frame: int
    timestamp: float
    width: int
    height: int
    fov: float  # degrees
    raw_data: bytes


@dataclass(frozen=True, slots=True, kw_only=True)
class Cloud:
    """As ``carla.LidarMeasurement``: ``raw_data`` is x, y, z in m and intensity, four float32 a point."""

    frame: int
    timestamp: float
    raw_data: bytes

    def __len__(self) -> int:
        """The number of points."""
        return len(self.raw_data) // 16


class Detection(NamedTuple):
    """As ``carla.RadarDetection``: m/s, rad, rad, m."""

    velocity: float
    azimuth: float
    altitude: float
    depth: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Echoes:
    """As ``carla.RadarMeasurement``: ``raw_data`` is velocity, azimuth, altitude, depth, four float32 each."""

    frame: int
    timestamp: float
    raw_data: bytes

    def __len__(self) -> int:
        """The number of detections."""
        return len(self.raw_data) // 16

    def __iter__(self) -> Iterator[Detection]:
        """The detections."""
        for row in np.frombuffer(self.raw_data, np.float32).reshape(-1, 4).tolist():
            yield Detection(*row)


@dataclass(frozen=True, slots=True, kw_only=True)
class Fix:
    """As ``carla.GnssMeasurement``: degrees and m."""

    frame: int
    timestamp: float
    latitude: float
    longitude: float
    altitude: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Inertia:
    """As ``carla.IMUMeasurement``: m/s², rad/s, rad."""

    frame: int
    timestamp: float
    accelerometer: carla.Vector3D
    gyroscope: carla.Vector3D
    compass: float


def as_measurement(spec: SensorSpec, frame: int, timestamp_s: float, data: Any) -> Any:  # noqa: ANN401 - by its sensor
    """One sensor's array; a kind that the leaderboard does not know is handed on as it came."""
    at: dict[str, Any] = {"frame": frame, "timestamp": timestamp_s}
    if spec.type_id == "sensor.camera.rgb":
        height, width, _ = data.shape
        fov = float(dict(spec.attributes).get("fov", "90"))
        return Image(**at, width=width, height=height, fov=fov, raw_data=_bytes(data, np.uint8))
    if spec.type_id == "sensor.lidar.ray_cast":
        return Cloud(**at, raw_data=_bytes(data, np.float32))
    if spec.type_id == "sensor.other.radar":
        return Echoes(**at, raw_data=_bytes(data[:, ::-1], np.float32))
    if spec.type_id == "sensor.other.gnss":
        latitude, longitude, altitude = data.tolist()
        return Fix(**at, latitude=latitude, longitude=longitude, altitude=altitude)
    if spec.type_id == "sensor.other.imu":
        values = data.tolist()
        return Inertia(
            **at, accelerometer=carla.Vector3D(*values[:3]), gyroscope=carla.Vector3D(*values[3:6]), compass=values[6]
        )
    return data


def _bytes(data: NDArray[Any], dtype: type[np.generic]) -> bytes:
    return np.ascontiguousarray(data, dtype).tobytes()
