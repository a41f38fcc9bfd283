"""`RecordingManager`: starts and stops the simulator's recorder for a run, and saves map, sensor set and weather."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

from basu.errors import UserError
from basu.files import write_bytes
from basu.managers.base_manager import BaseManager
from basu.managers.recorded_conditions import Conditions, WeatherFrom, write_conditions
from basu.records.recording_files import MAP_FILE
from basu.routing.weather import WEATHER_FIELDS

if TYPE_CHECKING:
    from collections.abc import Callable

    import carla

    from basu.agents.sensor_file import SensorSpec
    from basu.managers.base_manager import Frame, Run

ADDITIONAL_DATA = True  # velocities, boxes, physics: the input of queries


class RecordingManager(BaseManager):
    """Has the simulator record from the first step to the last, and keeps what its log lacks.

    That is the map, the sensors of the vehicle under test, and the weather.

    ``path`` is where the simulator says that it writes the log.
    """

    def __init__(self, name: str, sensors: Callable[[], tuple[SensorSpec, ...]] = tuple) -> None:
        """Prepare a recording.

        Args:
            name: a path where simulator and benchmark share a disk, else a plain name.
            sensors: returns the sensors of the vehicle under test once the drive has begun.
        """
        self._name, self._sensors = name, sensors
        self._run: Run | None = None
        self._weather: list[WeatherFrom] = []
        self._shown: carla.WeatherParameters | None = None
        self.path: str | None = None

    def setup(self, run: Run) -> None:
        """Begin; present actors are written as of the first frame.

        Raises:
            UserError: the simulator cannot write it.
        """
        try:
            path = run.client.start_recorder(self._name, ADDITIONAL_DATA)
        except RuntimeError as error:
            raise UserError(f"--record: the simulator cannot write its log: {error}") from error
        if not path:
            raise UserError(
                f"--record: the simulator could not write its log {self._name} and did not say why; "
                "see whether its disk is full, or run without --record"
            )
        self._run, self.path, self._weather, self._shown = run, str(path), [], None
        self._note_weather(run, 1)
        write_bytes(run.folder / MAP_FILE, run.carla_map.to_opendrive().encode())

    def tick(self, frame: Frame) -> None:
        """Note a change of the weather; it shows from the next frame on. The simulator writes each frame itself."""
        if self._run is not None:
            self._note_weather(self._run, frame.tick + 2)

    def close(self) -> None:
        """End the log."""
        if self._run is not None:
            run, self._run = self._run, None
            with contextlib.suppress(RuntimeError):  # the simulator is gone; every whole frame is in the file
                run.client.stop_recorder()
            write_conditions(run.folder, Conditions(run.vehicle.id, self._sensors(), tuple(self._weather)))

    def _note_weather(self, run: Run, frame: int) -> None:
        """Note the weather from a frame of the log on, counted from 1, where it is not the one before."""
        weather = run.changes.weather
        if weather is not None and weather is not self._shown:
            values = {name: float(getattr(weather, name)) for name in WEATHER_FIELDS}
            self._weather.append(WeatherFrom(frame, values))
            self._shown = weather
