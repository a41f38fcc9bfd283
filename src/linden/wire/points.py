"""What lidars and radars send behind the header.

Source: LibCarla 0.9.16, ``carla/sensor/s11n/LidarSerializer.h``, ``sensor/data/SemanticLidarData.h``, ``LidarData.h``
and ``RadarData.h``.
"""

import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from linden.wire.stream import Parts

RADAR_DETECTION = np.dtype(
    [
        ("velocity", "<f4"),  # m/s, positive where the target recedes (Radar.cpp)
        ("azimuth", "<f4"),  # rad, positive to the right
        ("altitude", "<f4"),  # rad, positive upwards
        ("depth", "<f4"),  # m
    ]
)
_LIDAR = struct.Struct("<fI")


def lidar_payload(horizontal_rad: float, count: NDArray[np.uint32], points: NDArray[Any]) -> Parts:
    """Return the header with the number of points of each channel, and the points, packed as they are."""
    return (
        _LIDAR.pack(horizontal_rad, len(count)),
        np.ascontiguousarray(count, "<u4"),
        np.ascontiguousarray(points),
    )


def radar_payload(detections: NDArray[np.void]) -> Parts:
    """Return detections (N,) of RADAR_DETECTION as they are sent."""
    return (np.ascontiguousarray(detections, RADAR_DETECTION),)
