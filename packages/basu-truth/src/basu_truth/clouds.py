"""Points of lidars: which object each belongs to."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

if TYPE_CHECKING:
    import carla

ROW = np.dtype([("xyz", "<f4", (3,)), ("cos_incidence", "<f4"), ("object_id", "<u4"), ("tag", "<u4")])
"""A point of CARLA's semantic lidar: m in the sensor's frame, the actor's id or 0, the semantic tag."""
SAME_RAY = 1e-3
"""Between two unit vectors of one ray: a lidar's noise moves a point along its ray, and float32 rounds."""


def rows_of(measured: carla.SemanticLidarMeasurement) -> NDArray[Any]:
    """Return the points (N,) of ``ROW`` of a semantic lidar."""
    return np.frombuffer(measured.raw_data, ROW)


def points_of(
    measured: carla.LidarMeasurement | carla.SemanticLidarMeasurement, *, is_semantic: bool
) -> NDArray[np.float32]:
    """Return the points (N, 4) of a declared lidar: x, y, z in m in the sensor's frame, and intensity.

    A semantic lidar measures no intensity; the cosine of the angle of incidence takes its place.
    """
    if is_semantic:
        return rows_of(measured).view(np.float32).reshape(-1, 6)[:, :4].copy()
    return np.frombuffer(measured.raw_data, np.float32).reshape(-1, 4).copy()


def rings_of(measured: carla.LidarMeasurement | carla.SemanticLidarMeasurement) -> NDArray[np.float32]:
    """Return the number of the channel of each point (N,); the lowest number looks up."""
    counts = [measured.get_point_count(channel) for channel in range(measured.channels)]
    return np.repeat(np.arange(len(counts), dtype=np.float32), counts)


def numbers_of_points(points: NDArray[np.float32], rows: NDArray[Any]) -> NDArray[np.int64]:
    """Return the number of the object of each point (N, 4) of a declared lidar; 0 where it is none's.

    ``rows`` are those of the twin: the same rays without losses. A point belongs to the object of its ray.
    """
    if not len(points) or not len(rows):
        return np.zeros(len(points), np.int64)
    distance, index = cKDTree(_directions(rows["xyz"])).query(_directions(points[:, :3]))
    return np.where(distance <= SAME_RAY, rows["object_id"][index].astype(np.int64), 0)


def _directions(places: NDArray[np.float32]) -> NDArray[np.float64]:
    """Return the unit vectors (N, 3) towards places (N, 3)."""
    away = places.astype(np.float64)
    unit: NDArray[np.float64] = away / np.maximum(np.linalg.norm(away, axis=1, keepdims=True), 1e-9)
    return unit
