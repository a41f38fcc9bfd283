"""Sensor measurements as bytes: the header of a message, images, points.

The packed header stands before every stream payload; the number of the sensor type is in it. Sources, in LibCarla
0.9.16: ``carla/sensor/s11n/SensorHeaderSerializer.h``, ``EpisodeStateSerializer.h``, ``ImageSerializer.h``,
``DVSEventArraySerializer.h``, ``LidarSerializer.h``; ``carla/sensor/SensorRegistry.h``;
``carla/sensor/data/SemanticLidarData.h``, ``LidarData.h``, ``RadarData.h``.
"""

import struct
from enum import IntEnum, IntFlag
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from linden.errors import ProtocolError
from linden.protocol.values.space import Transform
from linden.structured import StructuredArray

Parts: TypeAlias = tuple[bytes | NDArray[Any], ...]
"""What a message is made of, in its order: pictures are large, so they are joined once, when all of it is there."""


class SensorType(IntEnum):
    """Index of a sensor in CARLA's registry. The official client ends itself on 6, 12 and anything from 22 on."""

    COLLISION = 0
    CAMERA_DEPTH = 1
    CAMERA_NORMALS = 2
    CAMERA_DVS = 3
    GNSS = 4
    IMU = 5
    OBSTACLE = 7
    CAMERA_OPTICAL_FLOW = 8
    RADAR = 9
    LIDAR_SEMANTIC = 10
    LIDAR = 11
    CAMERA_RGB = 13
    CAMERA_SEMANTIC = 14
    CAMERA_INSTANCE = 15
    CAMERA_COSMOS = 16
    WORLD_OBSERVER = 17
    GBUFFER_UINT8 = 18
    GBUFFER_FLOAT = 19
    V2X = 20
    V2X_CUSTOM = 21


class SimulationState(IntFlag):
    """What the client should fetch anew."""

    NONE = 0
    MAP_CHANGE = 1
    PENDING_LIGHT_UPDATE = 2


SENSOR_HEADER = np.dtype(
    [
        ("sensor_type", "<u8"),  # a SensorType
        ("frame", "<u8"),  # step in which the measurement was made
        ("timestamp", "<f8"),  # s of simulated time since the episode began
        ("location", "<f4", (3,)),  # of the sensor in the world, m
        ("rotation", "<f4", (3,)),  # pitch, yaw, roll in degrees
    ]
)
EPISODE_HEADER = np.dtype(
    [
        ("episode_id", "<u8"),
        ("platform_timestamp", "<f8"),  # s
        ("delta_seconds", "<f4"),  # s, of this step
        ("map_origin", "<i4", (3,)),  # large maps only
        ("simulation_state", "<u4"),  # SimulationState
    ]
)
_SENSOR = struct.Struct("<QQd6f")
_EPISODE = struct.Struct("<Qdf3iI")
assert SENSOR_HEADER.itemsize == _SENSOR.size == 48  # SensorHeaderSerializer.cpp asserts the same
assert EPISODE_HEADER.itemsize == _EPISODE.size == 36


def sensor_header(sensor_type: SensorType, frame: int, timestamp_s: float, world_from_sensor: Transform) -> bytes:
    """Return the 48 bytes that open every stream message."""
    return _SENSOR.pack(sensor_type, frame, timestamp_s, *world_from_sensor.location, *world_from_sensor.rotation)


def episode_header(
    episode_id: int, platform_timestamp_s: float, delta_s: float, state: SimulationState = SimulationState.NONE
) -> bytes:
    """Return the 36 bytes between the header of a world snapshot and its rows."""
    return _EPISODE.pack(episode_id, platform_timestamp_s, delta_s, 0, 0, 0, state)


_HEADER = struct.Struct("<IIf")  # width and height in pixels, horizontal field of view in degrees


def image_payload(pixels: NDArray[np.uint8] | NDArray[np.float32], fov_deg: float) -> Parts:
    """Return a picture (height, width, 4) of bytes B, G, R, A or (height, width, 2) of floats.

    Raises:
        ProtocolError: the pixels are of another form.
    """
    if pixels.ndim != 3 or (pixels.shape[2], pixels.dtype.name) not in ((4, "uint8"), (2, "float32")):
        raise ProtocolError(f"a picture has 4 bytes or 2 floats a pixel, not {pixels.shape} of {pixels.dtype}")
    height, width = pixels.shape[:2]
    return _HEADER.pack(width, height, fov_deg), np.ascontiguousarray(pixels)


def events_payload(events: StructuredArray, width: int, height: int, fov_deg: float) -> Parts:
    """Return what an event camera saw, packed events one after the other."""
    return _HEADER.pack(width, height, fov_deg), np.ascontiguousarray(events)


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


def radar_payload(detections: StructuredArray) -> Parts:
    """Return detections (N,) of RADAR_DETECTION as they are sent."""
    return (np.ascontiguousarray(detections, RADAR_DETECTION),)
