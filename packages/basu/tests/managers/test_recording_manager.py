"""The recording of a drive: sensors and weather beside CARLA's log."""

import json
from pathlib import Path
from types import SimpleNamespace

import carla
import pytest

from basu.agents.sensor_file import parse_sensors
from basu.errors import UserError
from basu.managers.base_manager import WorldChanges
from basu.managers.recorded_conditions import Conditions, WeatherFrom, read_conditions, write_conditions
from basu.managers.recording_manager import RecordingManager

SENSORS = parse_sensors([{"type": "sensor.camera.rgb", "id": "FRONT", "x": 2.0, "width": 320}], "test")


def recorded(folder: Path, weathers: dict[int, carla.WeatherParameters]) -> Conditions:
    """Return the conditions of a drive of five ticks, with the weather that is set at some of them."""
    run = SimpleNamespace(
        client=SimpleNamespace(start_recorder=lambda name, _: name, stop_recorder=lambda: None),
        carla_map=SimpleNamespace(to_opendrive=lambda: "<OpenDRIVE/>"),
        vehicle=SimpleNamespace(id=42),
        folder=folder,
        changes=WorldChanges(weather=carla.WeatherParameters.ClearNoon),
    )
    manager = RecordingManager("drive.log", lambda: SENSORS)
    manager.setup(run)
    for tick in range(5):
        run.changes.weather = weathers.get(tick, run.changes.weather)
        manager.tick(SimpleNamespace(tick=tick))
    manager.close()
    return read_conditions(folder)


def test_the_sensors_and_the_vehicle_stand_beside_the_log(tmp_path: Path) -> None:
    found = recorded(tmp_path, {})
    assert (found.vehicle_id, found.sensors) == (42, SENSORS)
    assert [mark.frame for mark in found.weather] == [1]


def test_a_change_of_the_weather_shows_from_the_next_frame_of_the_log_on(tmp_path: Path) -> None:
    found = recorded(tmp_path, {3: carla.WeatherParameters.HardRainNight})
    assert [mark.frame for mark in found.weather] == [1, 5]  # tick 3 is frame 4
    assert [mark.values["precipitation"] for mark in found.weather] == [0.0, 100.0]


def test_conditions_are_read_as_they_were_written(tmp_path: Path) -> None:
    conditions = Conditions(7, SENSORS, (WeatherFrom(1, {"cloudiness": 5.0}),))
    write_conditions(tmp_path, conditions)
    assert read_conditions(tmp_path) == conditions


@pytest.mark.parametrize("document", [{}, [], {"vehicle_id": 1, "sensors": [{"id": "A"}], "weather": []}])
def test_a_document_of_another_kind_is_refused(tmp_path: Path, document: object) -> None:
    (tmp_path / "recording.json").write_text(json.dumps(document))
    with pytest.raises(UserError, match="is not what --record writes"):
        read_conditions(tmp_path)
