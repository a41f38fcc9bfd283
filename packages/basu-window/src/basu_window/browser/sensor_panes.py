"""Measurements of the agent's sensors as panes of the page: pictures, points from above, readings in words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import carla
import numpy as np

from basu_window.browser.readings import compass_point, degrees, fix_of
from linden_window import panes

if TYPE_CHECKING:
    from numpy.typing import NDArray

FAR_M = 1000.0
"""Distance that a depth of 1 means: CARLA's sensor reference, "Depth camera"."""
NEAR_M = 1.0
"""A surface that is nearer than this is black in a depth picture."""
MOVING_MPS = 0.5
"""Radar echoes that approach or recede faster than this are yellow."""
WHITE, YELLOW = (235, 235, 235), (250, 205, 60)
SEMANTIC_RAY = np.dtype([("xyz", "<f4", (3,)), ("cos", "<f4"), ("id", "<u4"), ("tag", "<u4")])
GOLDEN = 0.618034
"""Share of a turn by which the hue differs from tag to tag, so that neighbours differ."""
MOST_WIDE_PX = 640
MOST_POINTS = 20_000


def pane(name: str, type_id: str, frame: int, measured: Any, carla_map: carla.Map) -> bytes:  # noqa: ANN401 - of carla
    """Return the bytes of a sensor's pane.

    Args:
        name: id of the sensor in the agent's set.
        type_id: its blueprint.
        frame: the server's frame of the measurement.
        measured: what CARLA's client hands to a listener.
        carla_map: projects places, for GNSS.
    """
    if isinstance(measured, carla.Image):
        return panes.picture(name, frame, picture(measured, type_id))
    points = cloud(measured)
    if points is not None:
        places_m, colours = points
        every = math.ceil(len(places_m) / MOST_POINTS) or 1
        return panes.points(name, frame, places_m[::every], colours[::every])
    return panes.lines(name, frame, readings(carla_map, measured))


def readings(carla_map: carla.Map, measured: Any) -> list[tuple[str, str]]:  # noqa: ANN401 - any of carla's
    """Return a measurement as pairs of a name and a value with its unit."""
    if isinstance(measured, carla.GnssMeasurement):
        fix = fix_of(carla_map, measured, measured.transform.location)
        latitude, longitude = degrees(fix, 7)
        return [("Latitude", latitude), ("Longitude", longitude), ("Altitude", f"{fix.altitude_m:.2f} m")]
    if isinstance(measured, carla.IMUMeasurement):
        force, spin, heading_deg = measured.accelerometer, measured.gyroscope, math.degrees(measured.compass)
        return [
            *((f"Acceleration {axis}", f"{getattr(force, axis):+.2f} m/s²") for axis in "xyz"),
            *((f"Turn rate {axis}", f"{math.degrees(getattr(spin, axis)):+.2f} °/s") for axis in "xyz"),
            ("Compass", f"{heading_deg:.1f}° {compass_point(heading_deg)}"),
        ]
    if isinstance(measured, carla.CollisionEvent):
        impulse = measured.normal_impulse
        other = measured.other_actor
        return [
            ("Last collision", "nothing" if other is None else str(other.type_id)),
            ("Impulse", f"{math.hypot(impulse.x, impulse.y, impulse.z):.0f} N s"),
        ]
    if isinstance(measured, carla.LaneInvasionEvent):
        return [("Last line crossed", ", ".join(str(mark.type) for mark in measured.crossed_lane_markings))]
    if isinstance(measured, carla.ObstacleDetectionEvent):
        return [("Obstacle", str(measured.other_actor.type_id)), ("Distance", f"{measured.distance:.1f} m")]
    return [("Measured", type(measured).__name__)]


def picture(image: carla.Image, type_id: str) -> NDArray[np.uint8]:
    """Return a camera's picture (H, W, 3) as red, green, blue, at most ``MOST_WIDE_PX`` wide.

    Colours stay as they are, depth becomes logarithmic grey, and tags become colours.
    """
    every = math.ceil(image.width / MOST_WIDE_PX)
    bgra = np.frombuffer(image.raw_data, dtype=np.uint8).reshape(image.height, image.width, 4)[::every, ::every]
    if type_id.endswith("depth"):
        parts = bgra.astype(np.float64)
        depth_m = FAR_M * (parts[..., 2] + 256.0 * parts[..., 1] + 65536.0 * parts[..., 0]) / 0xFFFFFF
        grey = 255.0 * np.log(np.maximum(depth_m, NEAR_M) / NEAR_M) / math.log(FAR_M / NEAR_M)
        return np.repeat(grey.astype(np.uint8)[..., None], 3, axis=2)
    if type_id.endswith("segmentation"):
        return tag_colours(bgra[..., 2].reshape(-1)).reshape(*bgra.shape[:2], 3)
    return np.ascontiguousarray(bgra[..., 2::-1])


def tag_colours(tags: NDArray[np.integer[Any]]) -> NDArray[np.uint8]:
    """Return a colour (N, 3) for each tag (N,): hues apart, tag 0 black."""
    hue = (np.arange(256) * GOLDEN)[:, None] + np.array([0.0, 1.0 / 3.0, 2.0 / 3.0])
    palette = (140.0 + 100.0 * np.cos(math.tau * hue)).astype(np.uint8)
    palette[0] = 0
    return np.asarray(palette[np.asarray(tags) & 255], dtype=np.uint8)


def cloud(measured: Any) -> tuple[NDArray[np.float64], NDArray[np.uint8]] | None:  # noqa: ANN401 - any of carla's
    """Return the points of a lidar or radar: (N, 2) m ahead and to the right, and (N, 3) colours; None for others."""
    if isinstance(measured, carla.LidarMeasurement):
        rays = np.frombuffer(measured.raw_data, dtype="<f4").reshape(-1, 4)
        level = (80.0 + 175.0 * np.clip(rays[:, 3], 0.0, 1.0)).astype(np.uint8)
        return rays[:, :2].astype(np.float64), np.column_stack([level, level, level])
    if isinstance(measured, carla.SemanticLidarMeasurement):
        hits = np.frombuffer(measured.raw_data, dtype=SEMANTIC_RAY)
        return hits["xyz"][:, :2].astype(np.float64), tag_colours(hits["tag"])
    if isinstance(measured, carla.RadarMeasurement):
        echoes = np.frombuffer(measured.raw_data, dtype="<f4").reshape(-1, 4).astype(np.float64)
        velocity_mps, azimuth, altitude, depth_m = echoes.T
        flat_m = depth_m * np.cos(altitude)
        colours = np.where(np.abs(velocity_mps)[:, None] > MOVING_MPS, np.array(YELLOW), np.array(WHITE))
        return np.column_stack([flat_m * np.cos(azimuth), flat_m * np.sin(azimuth)]), colours.astype(np.uint8)
    return None
