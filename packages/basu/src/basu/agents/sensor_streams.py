"""Streams of spawned sensors, collected tick by tick, and their measurements as numpy arrays."""

from __future__ import annotations

import contextlib
import threading
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import carla
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

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


# These speak when something happens, not every tick: nothing waits for them.
ON_EVENT = frozenset(
    {
        "sensor.other.collision",
        "sensor.other.lane_invasion",
        "sensor.other.obstacle",
        "sensor.other.rss",
        "sensor.other.v2x",
        "sensor.other.v2x_custom",
    }
)

# With a ``sensor_tick``, a radio of ``linden serve`` speaks every tick; CARLA's radios speak when they hear.
RADIOS = frozenset({"sensor.other.v2x", "sensor.other.v2x_custom"})


class SpawnedSensor(NamedTuple):
    """A sensor of the agent's set that is in the world."""

    id: str  # in the set
    actor_id: int
    period_ticks: int  # ticks from one measurement to the next; 0: it measures on events
    as_numpy: bool  # whether the agent receives numpy arrays instead of CARLA's objects


class SensorListener(Protocol):
    """What receives the measurements for the agent."""

    def open_sensor_streams(self, sensors: Sequence[SpawnedSensor]) -> bool:
        """Take the agent's sensors; whether the agent's process listens to them itself."""
        ...

    def close_sensor_streams(self) -> None:
        """Stop listening; the sensors are about to be destroyed."""
        ...


class SensorSilentError(Exception):
    """Sensors did not measure in time; the text names them and the frame."""


class SensorStreams:
    """Sensors that are listened to, in the order in which they were added."""

    def __init__(self, timeout_s: float) -> None:
        """``timeout_s`` of wall time is how long ``wait`` waits."""
        self._timeout_s = timeout_s
        self._sensors: list[tuple[SpawnedSensor, Any]] = []
        self._news = threading.Condition()
        self._latest: dict[str, tuple[int, Any]] = {}

    def listen(self, sensor: SpawnedSensor, actor: carla.Sensor) -> None:
        """Listen to one more sensor.

        Raises:
            RuntimeError: the simulator does not serve it.
        """
        self._sensors.append((sensor, actor))
        actor.listen(self._callback(sensor.id))

    def wait(self, frame: int) -> dict[str, tuple[int, Any]]:
        """The latest measurement of each sensor with its frame, once all that are due in ``frame`` are there.

        Raises:
            SensorSilentError: they did not come in time.
        """
        with self._news:
            if not self._news.wait_for(lambda: not self._missing(frame), timeout=self._timeout_s):
                silent = ", ".join(self._missing(frame))
                raise SensorSilentError(f"sensor {silent} did not answer for frame {frame} in time")
            return {sensor.id: self._measured(sensor) for sensor, _ in self._sensors if sensor.id in self._latest}

    def stop(self) -> None:
        """Stop listening and let go of what was measured."""
        sensors, self._sensors = self._sensors, []
        for _, actor in sensors:
            with contextlib.suppress(RuntimeError):  # the simulator or the sensor is gone
                actor.stop()
        self._latest = {}

    def _callback(self, sensor_id: str) -> Callable[[carla.SensorData], None]:
        """What the client calls, on threads of its own, with each measurement."""

        def receive(measurement: carla.SensorData) -> None:
            with self._news:
                self._latest[sensor_id] = (measurement.frame, measurement)
                self._news.notify()

        return receive

    def _measured(self, sensor: SpawnedSensor) -> tuple[int, Any]:
        """The latest measurement in the form in which it is wanted; converted once."""
        frame, measured = self._latest[sensor.id]
        if sensor.as_numpy:
            measured = as_array(measured)  # an array stays as it is
            self._latest[sensor.id] = (frame, measured)
        return frame, measured

    def _missing(self, frame: int) -> list[str]:
        """The sensors that are due in this frame and have not answered."""
        return [
            sensor.id
            for sensor, _ in self._sensors
            if sensor.period_ticks
            and (sensor.id not in self._latest or frame - self._latest[sensor.id][0] >= sensor.period_ticks)
        ]
