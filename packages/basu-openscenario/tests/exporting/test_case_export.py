"""Claims about exported cases: valid for ASAM, played as they were rehearsed, refused by name where that cannot be."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lxml import etree

from basu.errors import ScenarioError, UserError
from basu.running.scenario_runs.options import ScenarioOptions
from basu.running.scenario_runs.placed_cases import export_cases
from basu.scenarios.cases import by_id, cases_of
from basu.scenarios.stage import EGO
from basu_openscenario.exporting.case_export import ESMINI, STEP_S, Exported
from basu_openscenario.exporting.entry import export
from basu_openscenario.exporting.motions import at_rest, thinned
from basu_openscenario.playing.player import make_player
from basu_openscenario.reading.scenario_file import read_scenario
from fakes import asam
from openscenario_texts import scenario, written

Export = Callable[[str], tuple[Exported, Path]]

CASES = (
    "pedestrian_crossing_1",  # a time to a place, a walker
    "lead_vehicle_brakes_1",  # a distance, a leader
    "red_light_runner_1",  # lights
    "dog_on_the_road_1",  # an animal
    "turn_into_traffic_1",  # a time to a stop, vehicles that leave the world
    "car_at_the_stop_2",  # one trigger after the other, a rest
)
LATE_S, APART_M = 0.05, 0.25


@pytest.fixture(scope="module")
def exported(export_for: Callable[[str, str], tuple[Exported, Path]]) -> Export:
    """Exports a case of Linden for esmini by its id, once."""
    return lambda name: export_for(name, ESMINI)


@pytest.mark.parametrize("name", CASES)
def test_asams_checker_finds_nothing_wrong(exported: Export, name: str) -> None:
    assert asam.scenario_issues(exported(name)[1]) == []


def test_asams_checker_finds_what_is_wrong(exported: Export, tmp_path: Path) -> None:
    wrong = tmp_path / "wrong.xosc"
    wrong.write_text(exported(CASES[0])[1].read_text().replace("<TeleportAction>", '<TeleportAction to="x">'))
    assert asam.scenario_issues(wrong)


@pytest.mark.parametrize("name", CASES)
def test_a_file_is_played_as_it_was_rehearsed(exported: Export, name: str) -> None:
    made, path = exported(name)
    played = made.played
    player = make_player(read_scenario(path))
    worst_m = 0.0
    for frame in player.play(STEP_S, 60.0):
        nth = round(frame.time_s / STEP_S)
        for pose in frame.poses if nth < len(played.times_s) else ():
            x_m, y_m = played.trails[pose.name][nth, :2]
            if not math.isnan(x_m):
                worst_m = max(worst_m, math.dist((pose.x_m, pose.y_m), (x_m, -y_m)))
    begun = {
        change.path.rsplit("::", 1)[-1]: change.time_s
        for change in reversed(player.changes)
        if change.kind == "event" and change.state == "runningState"
    }
    assert worst_m < APART_M
    assert {one for one in made.begins_s if abs(begun[one] - made.begins_s[one]) > LATE_S} == set()
    assert player.world.time_s == pytest.approx(played.times_s[-1], abs=0.1)


def test_the_others_wait_for_the_ego(exported: Export) -> None:
    """An ego that stands never triggers the conflict, so that the walker stands as well."""
    player = make_player(read_scenario(exported("pedestrian_crossing_1")[1]))
    player.step(0.0)
    hero, walker = player.world.mover(EGO), player.world.mover("walker")
    begin = walker.place.x_m, walker.place.y_m
    for event in (one for one in player.board.all() if one.path.endswith("hero 1 moves")):
        event.stop()
    for _ in range(2000):
        player.step(STEP_S)
    assert hero.travelled_m < 1.0
    assert (walker.place.x_m, walker.place.y_m) == pytest.approx(begin)


def test_lights_are_set_at_the_beginning(exported: Export) -> None:
    _, path = exported("red_light_runner_1")
    states = etree.parse(path).findall(".//Init/Actions/GlobalAction//TrafficSignalStateAction")
    assert [one.get("state") for one in states].count("off;off;on") == 1
    signals = etree.parse(path.with_name("Linden.xodr")).findall(".//signal[@type='1000001']")
    assert {one.get("country") for one in signals} == {"OpenDRIVE"}


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("control_loss_2", "a disturbance of the ego's controls"),
        ("slippery_stop_1", "friction of a part of the road"),
        ("dooring_1", "an open door"),
        ("leaving_stop_1", "the trigger PassesEgo"),
    ],
)
def test_what_cannot_be_expressed_is_refused_by_name(exported: Export, name: str, why: str) -> None:
    with pytest.raises(ScenarioError, match=f"{name} cannot be exported: {why} has no counterpart in OpenSCENARIO"):
        exported(name)


def test_the_same_case_gives_the_same_bytes(exported: Export, export_for: Any, tmp_path: Path) -> None:
    _, path = exported(CASES[0])
    before = path.read_bytes()
    export_for.cache_clear()
    assert exported(CASES[0])[1].read_bytes() == before


def test_several_cases_are_not_one_file(tmp_path: Path) -> None:
    options = ScenarioOptions(what=("dog_on_the_road",))
    with pytest.raises(UserError, match=r"cases need a folder; name one without \.xosc"):
        list(export_cases(options, tmp_path / "one.xosc"))


def test_a_missing_writer_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    with pytest.raises(UserError, match=r"pip install \"basu-openscenario\[export\]\""):
        export(by_id(CASES[0]), None, "", tmp_path / "a.xosc")  # type: ignore[arg-type]


@pytest.mark.usefixtures("plugin")
def test_a_file_of_openscenario_is_not_exported(tmp_path: Path) -> None:
    (playable,) = cases_of([str(written(tmp_path, scenario()))])
    with pytest.raises(ScenarioError, match="is an OpenSCENARIO file already"):
        export(playable, None, "", tmp_path / "a.xosc")  # type: ignore[arg-type]


def test_points_between_which_all_is_linear_are_left_out() -> None:
    times_s = np.arange(0.0, 10.0, 0.01)
    even = np.column_stack([times_s, 3.0 * times_s, 0.0 * times_s, 0.0 * times_s])
    assert len(thinned(even)) == 2
    speeding = np.column_stack([times_s, times_s**2, 0.0 * times_s, 0.0 * times_s])
    few = thinned(speeding)
    assert np.abs(np.interp(times_s, few[:, 0], few[:, 1]) - speeding[:, 1]).max() < 0.006
    assert len(few) < 150


def test_an_actor_that_rests_keeps_its_place() -> None:
    speeds_mps = np.array([1.0, 0.05, 0.02, 0.05, 1.0])
    trail = np.column_stack([np.cumsum(speeds_mps), 0.0 * speeds_mps, 0.0 * speeds_mps, speeds_mps])
    held, marks = at_rest(trail)
    assert marks == [1, 3]
    assert set(held[1:4, 0]) == {trail[1, 0]}


def test_a_moment_shortly_before_a_rest_is_kept_and_one_after_it_is_not() -> None:
    times_s = np.arange(0.0, 4.0, 0.01)
    ahead_m = np.where(times_s < 1.0, -((1.0 - times_s) ** 2), np.where(times_s < 3.0, 0.0, (times_s - 3.0) ** 2))
    points = np.column_stack([times_s, ahead_m, 0.0 * times_s, 0.0 * times_s])
    kept = thinned(points, rests=[100, 300], moments=[85, 310])[:, 0]
    assert 0.85 in np.round(kept, 2)
    assert 3.1 not in np.round(kept, 2)
