"""Claims about what a question is put to: files of a run, maps without a server, criteria in two forms."""

import json
from pathlib import Path

import carla
import pytest

from basu.errors import UserError
from basu_carla_log.sources import (
    LOG_FILE,
    MAP_FILE,
    RESULT_FILE,
    AbsentMap,
    criteria_of,
    read_criteria,
    read_map,
    source,
)

LINDEN = Path(__file__).parents[3] / "packages" / "linden" / "src" / "linden" / "data" / "Linden.xodr"


def test_a_runs_folder_has_its_log_map_and_result(tmp_path: Path) -> None:
    for name in (LOG_FILE, MAP_FILE, RESULT_FILE):
        (tmp_path / name).touch()
    assert source(tmp_path) == (tmp_path / LOG_FILE, tmp_path / MAP_FILE, tmp_path / RESULT_FILE)
    assert source(tmp_path / LOG_FILE) == source(tmp_path)
    assert source(tmp_path, LINDEN).map == LINDEN


def test_a_recorder_file_stands_for_itself(tmp_path: Path) -> None:
    log = tmp_path / "any.log"
    log.touch()
    assert source(log) == (log, None, None)


def test_what_is_missing_is_reported_with_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"has no recording\.log: the run was not recorded; run it with --record"):
        source(tmp_path)
    elsewhere = {"file": "drive.log", "where": "disk of the simulator at far:2000"}
    (tmp_path / "config.json").write_text(json.dumps({"recording": elsewhere}))
    with pytest.raises(UserError, match=r"it is drive\.log \(disk of the simulator at far:2000\); copy it here under"):
        source(tmp_path)
    with pytest.raises(UserError, match="nowhere is not there; name a run's folder"):
        source(tmp_path / "nowhere")
    with pytest.raises(UserError, match=r"the map none\.xodr is not there"):
        source(tmp_path, Path("none.xodr"))


def test_a_map_is_read_without_a_server() -> None:
    town = read_map(LINDEN, "Linden")
    assert town.name == "Linden"
    assert town.get_waypoint(carla.Location()) is not None


@pytest.mark.parametrize("content", [b"no map", b"\xff\xfe\x00"])
def test_what_is_no_map_is_reported(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "bad.xodr"
    path.write_bytes(content)
    with pytest.raises(UserError, match=r"bad\.xodr cannot be read: .*; name an OpenDRIVE file"):
        read_map(path, "bad")


def test_a_map_that_is_not_there_says_so_when_it_is_used() -> None:
    town = AbsentMap("Carla/Maps/Town03")
    with pytest.raises(UserError, match=r"asks for get_waypoint of the map Carla/Maps/Town03.*--map Town03\.xodr"):
        town.get_waypoint(carla.Location())


def test_criteria_have_the_name_that_scenario_runners_example_asks_for(tmp_path: Path) -> None:
    path = tmp_path / "criteria.json"
    path.write_text(json.dumps({"CollisionTest": {"actual_value": 2, "expected_value_success": 0}, "note": "kept"}))
    assert read_criteria(path) == {
        "CollisionTest": {"actual_value": 2, "expected_value_success": 0, "success_value": 0},
        "note": "kept",
    }


@pytest.mark.parametrize("text", ["[1]", "{", ""])
def test_criteria_that_are_none_are_reported(tmp_path: Path, text: str) -> None:
    path = tmp_path / "criteria.json"
    path.write_text(text)
    with pytest.raises(UserError, match="criteria"):
        read_criteria(path)


def test_the_judgement_of_a_run_of_ours_becomes_criteria(tmp_path: Path) -> None:
    path = tmp_path / RESULT_FILE
    found = [{"kind": "speeding"}, {"kind": "speeding"}]
    path.write_text(json.dumps({"infractions": found, "scoring": {"penalties": {"speeding": 0.8, "stop_sign": 0.8}}}))
    criteria = criteria_of(path)
    assert {name: (one["test_status"], one["actual_value"]) for name, one in criteria.items()} == {
        "speeding": ("FAILURE", 2),
        "stop_sign": ("SUCCESS", 0),
    }
    path.write_text("{}")
    with pytest.raises(UserError, match="is not the result of a run"):
        criteria_of(path)
