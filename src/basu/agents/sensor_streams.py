"""Listens to spawned sensors in step with the ticks, in the benchmark's process or in the agent's."""

from __future__ import annotations

import contextlib
import threading
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from basu.agents.sensor_data import as_array

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    import carla

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


class SpawnedSensor(NamedTuple):
    """A sensor of the agent's set that is in the world."""

    id: str  # in the set
    actor_id: int
    period_ticks: int  # ticks from one measurement to the next; 0: it measures on events
    as_numpy: bool  # whether the agent receives numpy arrays instead of CARLA's objects


class SensorListener(Protocol):
    """What receives the measurements for the agent."""

    def hear(self, sensors: Sequence[SpawnedSensor]) -> bool:
        """Take the agent's sensors; whether the agent's process listens to them itself."""
        ...

    def stop_hearing(self) -> None:
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
