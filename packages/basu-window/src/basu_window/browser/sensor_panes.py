"""Measurements of the agent's sensors as panes of the page: pictures, points from above, readings in words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import carla
import numpy as np

from basu_window.browser.readings import degrees, fix_of
from linden_window import panes
from linden_window.measured import imu_lines, lidar_points, radar_points, rgb_of, tag_colours

if TYPE_CHECKING:
    from numpy.typing import NDArray

SEMANTIC_RAY = np.dtype([("xyz", "<f4", (3,)), ("cos", "<f4"), ("id", "<u4"), ("tag", "<u4")])


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
        return panes.points(name, frame, *points)
    return panes.lines(name, frame, readings(carla_map, measured))


def readings(carla_map: carla.Map, measured: Any) -> list[tuple[str, str]]:  # noqa: ANN401 - any of carla's
    """Return a measurement as pairs of a name and a value with its unit."""
    if isinstance(measured, carla.GnssMeasurement):
        fix = fix_of(carla_map, measured, measured.transform.location)
        latitude, longitude = degrees(fix, 7)
        return [("Latitude", latitude), ("Longitude", longitude), ("Altitude", f"{fix.altitude_m:.2f} m")]
    if isinstance(measured, carla.IMUMeasurement):
        return imu_lines(measured)
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
    """Return a camera's picture (H, W, 3) as red, green, blue."""
    return rgb_of(np.frombuffer(image.raw_data, dtype=np.uint8).reshape(image.height, image.width, 4), type_id)


def cloud(measured: Any) -> tuple[NDArray[np.float64], NDArray[np.uint8]] | None:  # noqa: ANN401 - any of carla's
    """Return the points of a lidar or radar: (N, 2) m ahead and to the right, and (N, 3) colours; None for others."""
    if isinstance(measured, carla.LidarMeasurement):
        return lidar_points(np.frombuffer(measured.raw_data, dtype="<f4").reshape(-1, 4))
    if isinstance(measured, carla.SemanticLidarMeasurement):
        hits = np.frombuffer(measured.raw_data, dtype=SEMANTIC_RAY)
        return hits["xyz"][:, :2].astype(np.float64), tag_colours(hits["tag"])
    if isinstance(measured, carla.RadarMeasurement):
        echoes = np.frombuffer(measured.raw_data, dtype="<f4").reshape(-1, 4).astype(np.float64)
        return radar_points(*echoes.T)
    return None
