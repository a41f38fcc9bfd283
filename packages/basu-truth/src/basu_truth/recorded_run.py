"""`RecordedRun`: a run's folder with its log, its sensors and its weather."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from basu.episode.world import weather_called
from basu.errors import UserError
from basu.managers.recorded_conditions import Conditions, WeatherFrom, read_conditions
from basu.records.recording_files import CONDITIONS_FILE
from basu.routing.weather import WEATHER_FIELDS
from basu_carla_log import Log, read_log
from basu_carla_log.sources import source
from basu_truth.rig import cameras_and_lidars

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from basu.agents.sensor_file import SensorSpec

USUAL_STEP_S = 0.05  # of a log with a single frame


@dataclass(frozen=True, slots=True)
class RecordedRun:
    """A run that was driven with ``--record``, and the cameras and lidars that look at it again."""

    name: str
    log: Log
    conditions: Conditions
    sensors: tuple[SensorSpec, ...]

    @property
    def step_s(self) -> float:
        """Simulated time from frame to frame."""
        return float(np.median(np.diff(self.log.elapsed_s))) if self.log.frames > 1 else USUAL_STEP_S

    @property
    def town(self) -> str:
        """The name of the map without its folder."""
        return str(self.log.map_name).rsplit("/", maxsplit=1)[-1]

    def weather_at(self, frame: int) -> Mapping[str, float]:
        """Return the weather of a frame; empty where the simulator's own was kept."""
        marks = [mark for mark in self.conditions.weather if mark.frame <= frame]
        return marks[-1].values if marks else {}


def read_run(folder: Path, sensor_file: Path | None) -> RecordedRun:
    """Read a run's folder; ``sensor_file`` replaces the sensors that the agent declared.

    Raises:
        UserError: the folder is none of a recorded run, or neither it nor the file has a camera or a lidar.
    """
    if not folder.is_dir():
        raise UserError(f"{folder} is not a folder; name a run's folder, such as runs/latest")
    log_file = source(folder).log
    if not (folder / CONDITIONS_FILE).is_file():
        raise UserError(
            f"{folder} has no {CONDITIONS_FILE}, which says what its sensors and its weather were; an older version of "
            "basu recorded it: run it again with --record"
        )
    conditions = read_conditions(folder)
    sensors = cameras_and_lidars(conditions.sensors, str(folder), sensor_file)
    log = read_log(log_file)
    if log.frames == 0:
        raise UserError(f"{log_file} has no frame; run it again with --record")
    return RecordedRun(folder.resolve().name, log, conditions, sensors)


def in_weather(run: RecordedRun, name: str) -> RecordedRun:
    """Return a run as it would have looked in one of CARLA's presets of the weather, from its first frame to its last.

    Raises:
        UserError: there is no preset of that name.
    """
    preset = weather_called(name)
    values = {field: float(getattr(preset, field)) for field in WEATHER_FIELDS}
    return replace(run, conditions=run.conditions._replace(weather=(WeatherFrom(1, values),)))
