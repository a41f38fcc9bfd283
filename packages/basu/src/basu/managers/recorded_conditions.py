"""The conditions of a recorded drive, which CARLA's log does not have: the sensors of the vehicle and the weather.

``recording.json`` in the run's folder has them.
"""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.agents.sensor_file import SensorSpec
from basu.errors import UserError
from basu.files import read_json, write_bytes
from basu.records.recording_files import CONDITIONS_FILE

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path


class WeatherFrom(NamedTuple):
    """The weather from a frame of the log on."""

    frame: int  # from 1
    values: Mapping[str, float]  # of carla.WeatherParameters, in its units


class Conditions(NamedTuple):
    """What a log of CARLA's does not have.

    Attributes:
        vehicle_id: the actor id of the vehicle under test, in the log.
        sensors: of the vehicle under test.
        weather: the weathers of the drive in the order of their frames; empty where the simulator's own was kept.
    """

    vehicle_id: int
    sensors: tuple[SensorSpec, ...]
    weather: tuple[WeatherFrom, ...]


def write_conditions(folder: Path, conditions: Conditions) -> None:
    """Write the conditions of a recording into a run's folder."""
    document = {
        "vehicle_id": conditions.vehicle_id,
        "sensors": [asdict(spec) for spec in conditions.sensors],
        "weather": [each._asdict() for each in conditions.weather],
    }
    write_bytes(folder / CONDITIONS_FILE, (json.dumps(document, indent=2) + "\n").encode())


def read_conditions(folder: Path) -> Conditions:
    """Read the conditions of a recording in a run's folder.

    Raises:
        UserError: the file is not there, or is no such document.
    """
    path = folder / CONDITIONS_FILE
    document = read_json(path, "conditions of a recording")
    try:
        return Conditions(
            int(document["vehicle_id"]),
            tuple(_spec(each) for each in document["sensors"]),
            tuple(WeatherFrom(int(each["frame"]), dict(each["values"])) for each in document["weather"]),
        )
    except (KeyError, TypeError, ValueError) as error:
        raise UserError(f"{path} is not what --record writes: {error!r}; record the run again") from error


def _spec(entry: dict[str, Any]) -> SensorSpec:
    return SensorSpec(**{**entry, "attributes": tuple((str(name), str(value)) for name, value in entry["attributes"])})
