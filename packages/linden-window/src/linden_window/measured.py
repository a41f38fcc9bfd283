"""How measurements of sensors are shown: pictures as red, green and blue, points from above, and readings in words.

The arrays come from the listeners of CARLA's client or from `linden.sensors`.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
U8 = NDArray[np.uint8]

MOST_WIDE_PX = 640
_FAR_M = 1000.0
"""Distance that a depth of 1 means: CARLA's sensor reference, "Depth camera"."""
_NEAR_M = 1.0
"""A surface that is nearer than this is black in a depth picture."""
_MOVING_MPS = 0.5
"""Radar echoes that approach or recede faster than this are yellow."""
_WHITE, _YELLOW = (235, 235, 235), (250, 205, 60)
_GOLDEN = 0.618034
"""Share of a turn by which the hue differs from tag to tag, so that neighbours differ."""
_POINTS = ("N", "NE", "E", "SE", "S", "SW", "W", "NW")


def compass_point(degrees: float) -> str:
    """Return the nearest of the eight points of the compass."""
    return _POINTS[round(degrees / 45.0) % 8]


def rgb_of(bgra: U8, type_id: str) -> U8:
    """Return a camera's picture as red, green, blue, at most ``MOST_WIDE_PX`` wide.

    Colours stay as they are, depth becomes logarithmic grey, and tags become colours.

    Args:
        bgra: picture (H, W, 4).
        type_id: blueprint of the camera.
    """
    every = math.ceil(bgra.shape[1] / MOST_WIDE_PX)
    bgra = bgra[::every, ::every]
    if type_id.endswith("depth"):
        parts = bgra.astype(np.float64)
        depth_m = _FAR_M * (parts[..., 2] + 256.0 * parts[..., 1] + 65536.0 * parts[..., 0]) / 0xFFFFFF
        grey = 255.0 * np.log(np.maximum(depth_m, _NEAR_M) / _NEAR_M) / math.log(_FAR_M / _NEAR_M)
        return np.repeat(grey.astype(np.uint8)[..., None], 3, axis=2)
    if type_id.endswith("segmentation"):
        return tag_colours(bgra[..., 2].reshape(-1)).reshape(*bgra.shape[:2], 3)
    return np.ascontiguousarray(bgra[..., 2::-1])


def tag_colours(tags: NDArray[np.integer[Any]]) -> U8:
    """Return a colour (N, 3) for each tag (N,): hues apart, tag 0 black."""
    hue = (np.arange(256) * _GOLDEN)[:, None] + np.array([0.0, 1.0 / 3.0, 2.0 / 3.0])
    palette = (140.0 + 100.0 * np.cos(math.tau * hue)).astype(np.uint8)
    palette[0] = 0
    return np.asarray(palette[np.asarray(tags) & 255], dtype=np.uint8)


def lidar_points(rays: NDArray[np.float32]) -> tuple[F64, U8]:
    """Return places (N, 2) in m ahead and to the right, and colours (N, 3), of rays (N, 4): x, y, z, intensity."""
    level = (80.0 + 175.0 * np.clip(rays[:, 3], 0.0, 1.0)).astype(np.uint8)
    return rays[:, :2].astype(np.float64), np.column_stack([level, level, level])


def radar_points(velocity_mps: F64, azimuth_rad: F64, altitude_rad: F64, depth_m: F64) -> tuple[F64, U8]:
    """Return places (N, 2) in m ahead and to the right, and colours (N, 3), of echoes (N,)."""
    flat_m = depth_m * np.cos(altitude_rad)
    colours = np.where(np.abs(velocity_mps)[:, None] > _MOVING_MPS, np.array(_YELLOW), np.array(_WHITE))
    return np.column_stack([flat_m * np.cos(azimuth_rad), flat_m * np.sin(azimuth_rad)]), colours.astype(np.uint8)


def imu_lines(reading: Any) -> list[tuple[str, str]]:  # noqa: ANN401 - carla's IMUMeasurement, or that of linden
    """Return the readings of an IMU as pairs of a name and a value with its unit."""
    force, spin, heading_deg = reading.accelerometer, reading.gyroscope, math.degrees(reading.compass)
    return [
        *((f"Acceleration {axis}", f"{getattr(force, axis):+.2f} m/s²") for axis in "xyz"),
        *((f"Turn rate {axis}", f"{math.degrees(getattr(spin, axis)):+.2f} °/s") for axis in "xyz"),
        ("Compass", f"{heading_deg:.1f}° {compass_point(heading_deg)}"),
    ]
