"""Measurements as numpy arrays, as the leaderboard and ScenarioRunner hand them to an agent."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import carla
import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def as_array(measured: Any) -> Any:  # noqa: ANN401 - one of several types in, an array or the same thing out
    """A measurement of CARLA's as the leaderboard's ``SensorInterface`` gives it.

    Images: (H, W, 4) uint8, blue, green, red, alpha. Lidars: (N, 4) float32, x, y, z in m in the sensor's frame and
    intensity. Radars: (N, 4) float32, depth in m, altitude and azimuth in rad, velocity in m/s. GNSS: latitude and
    longitude in degrees, altitude in m. IMU: acceleration in m/s², rate of turn in rad/s, three of each, compass in
    rad. What the leaderboard has no form for stays as CARLA made it.
    """
    if isinstance(measured, carla.Image):
        return np.frombuffer(measured.raw_data, np.uint8).reshape(measured.height, measured.width, 4).copy()
    if isinstance(measured, carla.LidarMeasurement):
        return np.frombuffer(measured.raw_data, np.float32).reshape(-1, 4).copy()
    if isinstance(measured, carla.RadarMeasurement):
        # on the wire: velocity, azimuth, altitude, depth (RadarData.h); the leaderboard turns the row around
        return np.frombuffer(measured.raw_data, np.float32).reshape(-1, 4)[:, ::-1].copy()
    if isinstance(measured, carla.GnssMeasurement):
        return np.array([measured.latitude, measured.longitude, measured.altitude], np.float64)
    if isinstance(measured, carla.IMUMeasurement):
        return _inertial(measured)
    return measured


def _inertial(measured: carla.IMUMeasurement) -> NDArray[np.float64]:
    """Seven numbers of an IMU."""
    force, spin = measured.accelerometer, measured.gyroscope
    return np.array([force.x, force.y, force.z, spin.x, spin.y, spin.z, measured.compass], np.float64)
