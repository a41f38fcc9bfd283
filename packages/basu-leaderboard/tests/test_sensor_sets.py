"""Tests of ``basu_leaderboard.sensor_sets``."""

import logging
from typing import Any

import pytest

from basu.agents.sensor_file import parse_sensors, read_sensors
from basu.errors import UserError
from basu.files import PACKAGE_FOLDER
from basu_leaderboard.foreign_class import Dialect
from basu_leaderboard.sensor_sets import FIXED, LIDAR_OF_SCENARIO_RUNNER, theirs, translated

AT = {"x": 0.7, "y": -0.4, "z": 1.6, "roll": 0.0, "pitch": 0.0, "yaw": -45.0}
CAMERA = {"type": "sensor.camera.rgb", "id": "Left", **AT, "width": 300, "height": 200, "fov": 100}
RADAR = {"type": "sensor.other.radar", "id": "R", **AT, "fov": 30, "horizontal_fov": 35.0, "vertical_fov": 20.0}
LIDAR = {"type": "sensor.lidar.ray_cast", "id": "L", **AT, "range": 50}
SPEED = {"type": "sensor.speedometer", "id": "S", "reading_frequency": 20}


def attributes(entry: dict[str, Any], dialect: Dialect = Dialect.LEADERBOARD_2) -> dict[str, str]:
    """What BASU would set on the blueprint."""
    (spec,) = parse_sensors(translated([entry], dialect, "sensors() of A").entries, "sensors() of A")
    return dict(spec.attributes)


def test_a_camera_has_its_size_and_its_angle() -> None:
    assert attributes(CAMERA) == {"image_size_x": "300", "image_size_y": "200", "fov": "100"}


def test_pixels_are_whole_numbers_as_the_human_agents_mirrors_are_not() -> None:
    assert attributes({**CAMERA, "width": 1280 * 0.3})["image_size_x"] == "384"


def test_lidars_are_alike_for_all_agents_of_the_leaderboard() -> None:
    assert attributes(LIDAR) == {name: str(value) for name, value in FIXED["sensor.lidar.ray_cast"].items()}


def test_a_radar_has_its_own_angles_and_fields_without_meaning_are_passed_over() -> None:
    assert attributes(RADAR) == {
        "horizontal_fov": "35.0", "vertical_fov": "20.0", "points_per_second": "1500", "range": "100"
    }  # fmt: skip


def test_scenario_runners_lidars_are_as_the_agent_says() -> None:
    full = {**LIDAR, "rotation_frequency": 20, "channels": 16, "upper_fov": 5, "lower_fov": -20}
    full["points_per_second"] = 1000
    assert attributes(full, Dialect.SCENARIO_RUNNER)["range"] == "50"
    with pytest.raises(UserError, match=r"sensor 'L' \(sensor.lidar.ray_cast\) lacks its field 'rotation_frequency'"):
        attributes(LIDAR, Dialect.SCENARIO_RUNNER)


def test_the_leaderboards_own_sensors_are_not_the_simulators() -> None:
    found = translated([SPEED, CAMERA], Dialect.LEADERBOARD_2, "s")
    assert found.pseudo == {"S": "sensor.speedometer"}
    assert [entry["id"] for entry in found.entries] == ["Left"]


def test_sensors_that_the_leaderboard_would_refuse_are_the_simulators_to_judge() -> None:
    depth = {**CAMERA, "type": "sensor.camera.depth"}
    assert attributes(depth) == {"image_size_x": "300", "image_size_y": "200", "fov": "100"}


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        (None, "returned None; it must return a list of dicts"),
        (CAMERA, "returned dict"),
        ("Left", "returned str"),
        ([{**CAMERA, "fov": 90, "id": "S"}, SPEED], "the id 'S' is given twice"),
        ([SPEED, SPEED], "the id 'S' is given twice"),
        ([{key: value for key, value in CAMERA.items() if key != "width"}], "'Left' .* lacks its field 'width'"),
    ],
)
def test_a_set_that_is_none_gets_a_sentence(given: Any, sentence: str) -> None:
    with pytest.raises(UserError, match=rf"^sensors\(\) of A:? ?{sentence}|{sentence}"):
        translated(given, Dialect.LEADERBOARD_2, "sensors() of A")


@pytest.mark.parametrize("entry", [7, None, "camera", [], {}, {"type": "sensor.camera.rgb"}, {"type": 3, "id": "A"}])
def test_an_entry_that_is_none_is_complained_of_where_all_sets_are_read(entry: Any) -> None:
    with pytest.raises(UserError, match="sensor 1 needs a 'type' and an 'id'"):
        attributes(entry)


RIG = read_sensors(PACKAGE_FOLDER / "config" / "rig.json")
POSE = {"x": 0.0, "y": 0.0, "z": 0.0, "roll": 0.0, "pitch": 0.0, "yaw": 0.0}


def test_every_entry_has_its_whole_pose() -> None:
    entries, _ = theirs(RIG)
    assert len(entries) == len(RIG)
    assert all(entry.keys() >= POSE.keys() for entry in entries)


def test_what_is_reported_is_what_the_leaderboards_agents_tell() -> None:
    entries, _ = theirs(RIG)
    for dialect in Dialect:
        assert len(translated(entries, dialect, "the rig").entries) == len(RIG)
    (lidar,) = (entry for entry in entries if entry["type"] == "sensor.lidar.ray_cast")
    assert lidar.keys() >= set(LIDAR_OF_SCENARIO_RUNNER)


def test_a_camera_without_size_has_carlas() -> None:
    ((camera,), _) = theirs(parse_sensors([{"type": "sensor.camera.rgb", "id": "C", "fov": 70}], "s"))
    assert camera == {"type": "sensor.camera.rgb", "id": "C", **POSE, "width": 800, "height": 600, "fov": 70.0}


def test_a_radar_has_both_its_angles() -> None:
    ((radar,), _) = theirs(parse_sensors([{"type": "sensor.other.radar", "id": "R", "horizontal_fov": 40}], "s"))
    assert (radar["horizontal_fov"], radar["vertical_fov"]) == (40.0, 30.0)


def test_what_the_host_does_not_serve_is_left_out_and_logged(caplog: pytest.LogCaptureFixture) -> None:
    specs = parse_sensors(
        [{"type": "sensor.other.collision", "id": "BUMP"}, {"type": "sensor.other.gnss", "id": "G"}], "s"
    )
    with caplog.at_level(logging.WARNING, logger="basu"):
        entries, served = theirs(specs)
    assert [entry["id"] for entry in entries] == list(served) == ["G"]
    assert "the host serves no sensor.other.collision: sensor 'BUMP' is left out" in caplog.text
