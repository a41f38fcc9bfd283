"""Crossing paths, offline: an ego that drives on meets its partner, one that waits before the junction meets none."""

import math

import numpy as np
import pytest

from basu.errors import ScenarioError
from basu.scenarios.library.crossing_paths.from_the_side import AcrossTheWay
from basu.scenarios.library.crossing_paths.stream import Stream
from basu.scenarios.library.road_users import run_up_m
from basu.scenarios.nhtsa import Group
from basu.scenarios.paths import next_junction
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import EGO
from basu.testing import Driver, OfflineStage, rehearse, waiting_at

CASES = {
    "red_light_runner_1": "other",
    "red_light_runner_4": "other",
    "stop_sign_runner_1": "other",
    "left_turn_across_path_2": "other",
    "right_turn_into_path_1": "other",
    "car_across_junction_1": "other",
    "ego_turns_left_1": "oncoming 2",
}
BEHIND_A_STOP_SIGN = ("straight_crossing_paths_2", "turn_into_traffic_1", "unsignalized_intersection_2")


def unmoved(top_mps: float) -> Driver:
    """Sets off like the shuttle, and keeps its speed despite other traffic."""

    def drive(stage: OfflineStage) -> float:
        return min(top_mps, stage.ego.forward_mps + 1.1 * stage.step_s)

    return drive


@pytest.mark.parametrize(("case", "party"), CASES.items())
def test_an_ego_that_drives_on_is_hit_by_the_one_with_the_way_crosses(laid, case, party):
    scenario = laid(case)
    assert scenario.group is Group.CROSSING_PATHS
    rehearsal = rehearse(scenario, unmoved(6.4), until_s=15.0)
    assert next(iter(rehearsal.contacts_s), None) == party


def stopping(scenario: Scenario, seconds: float, speed_mps: float) -> Driver:
    """Comes to rest at its stop sign for so long, and drives off despite other traffic."""
    line_m = scenario.place.stop_line_m()
    assert line_m is not None
    return waiting_at(scenario.place.trigger_s_m + line_m - 2.0, seconds, speed_mps, brake_mps2=1.0, start_mps2=0.85)


@pytest.mark.parametrize(
    ("case", "speed_mps"),
    [(case, mps) for case in BEHIND_A_STOP_SIGN for mps in (4.0, 6.4)]
    + [(case, 2.0) for case in BEHIND_A_STOP_SIGN[:2]],
)
def test_behind_a_stop_sign_the_others_come_when_the_ego_drives_off_however_slowly_it_came(laid, case, speed_mps):
    scenario = laid(case)
    rehearsal = rehearse(scenario, stopping(scenario, 1.5, speed_mps), until_s=60.0)
    others = {spec.name for spec in scenario.actors()}
    assert others & rehearsal.contacts_s.keys()


@pytest.mark.parametrize("case", BEHIND_A_STOP_SIGN[:2])
@pytest.mark.parametrize("stands_s", [0.5, 2.0, 3.5, 5.0])
def test_a_stream_has_no_gap_for_one_that_drives_off_early_or_late(laid, case, stands_s):
    scenario = laid(case)
    rehearsal = rehearse(scenario, stopping(scenario, stands_s, 6.4), until_s=60.0)
    assert {spec.name for spec in scenario.actors()} & rehearsal.contacts_s.keys()


@pytest.mark.parametrize("case", BEHIND_A_STOP_SIGN)
def test_a_stream_ends_and_one_that_waits_for_that_passes(laid, case):
    scenario = laid(case)
    rehearsal = rehearse(scenario, stopping(scenario, 16.0, 6.4))
    assert not rehearsal.contacts_s
    assert rehearsal.over


@pytest.mark.parametrize("case", list(CASES)[::2])
def test_an_ego_that_waits_before_the_junction_is_not_touched(laid, case):
    scenario = laid(case)
    before_m = next_junction(scenario.place).from_m - 4.0
    rehearsal = rehearse(scenario, waiting_at(before_m, 14.0, 6.4))
    assert not rehearsal.contacts_s
    assert rehearsal.over


@pytest.mark.parametrize("speed_mps", [5.0, 6.4, 9.0])
def test_the_meeting_fits_whatever_speed_the_ego_has(laid, speed_mps):
    rehearsal = rehearse(laid("stop_sign_runner_3"), unmoved(speed_mps), until_s=15.0)
    assert "other" in rehearsal.contacts_s


def test_the_egos_light_is_green_and_all_others_are_red(laid):
    scenario = laid("red_light_runner_1")
    own = [control.landmark_id for control in scenario.place.route.controls]
    rehearsal = rehearse(scenario, unmoved(6.4), until_s=1.0)
    shown = [command.details for command in rehearsal.commands if command.what == "light"]
    assert (own[0], "Green") in shown
    assert sorted(state for _, state in shown) == ["Green", "Red", "Red", "Red"]


def test_without_a_light_no_actor_can_run_it(laid):
    scenario = laid("stop_sign_runner_1")
    runner = laid("red_light_runner_1")
    with pytest.raises(ScenarioError, match="no traffic light lies ahead"):
        type(runner)(scenario.place, runner.values).setup()


def test_the_side_chosen_is_the_side_it_comes_from(laid):
    for side, sign in (("left", -1.0), ("right", 1.0)):
        scenario = laid("red_light_runner_1", side=side)
        assert isinstance(scenario, AcrossTheWay)
        junction_m = next_junction(scenario.place).from_m
        here, there = scenario.place.at(junction_m), scenario.actors()[0].pose
        right_m = (there.y_m - here.y_m) * math.cos(here.yaw_rad) - (there.x_m - here.x_m) * math.sin(here.yaw_rad)
        assert right_m * sign > 10.0


def test_cars_of_a_stream_stand_one_behind_the_other_with_room_between(laid):
    scenario = laid("straight_crossing_paths_3")
    assert isinstance(scenario, Stream)
    poses = {spec.name: spec.pose for spec in scenario.actors()}
    assert sorted(poses) == [f"{side} {number}" for side in ("left", "right") for number in range(1, 6)]
    for side in ("left", "right"):
        apart_m = math.dist(poses[f"{side} 1"][:2], poses[f"{side} 2"][:2])
        assert apart_m == pytest.approx(2.2 * 9.0, abs=0.5)


def test_the_first_of_the_actors_that_come_turns_left_and_the_others_go_straight_on(laid):
    rehearsal = rehearse(laid("ego_turns_left_1", cars="3"), waiting_at(50.0, 12.0, 6.4))
    turned_rad = {}
    for name, trail in rehearsal.trails.items():
        yaw = trail[~np.isnan(trail[:, 2]), 2]
        turned_rad[name] = max(abs(math.remainder(angle - yaw[0], math.tau)) for angle in yaw)
    assert turned_rad["oncoming 1"] > 1.2
    assert max(turned_rad[name] for name in turned_rad if name not in {EGO, "oncoming 1"}) < 0.3


def test_that_stands_across_the_junction_drives_on_after_the_ego_has_stopped(laid):
    scenario = laid("car_across_junction_3", stands="2")
    before_m = next_junction(scenario.place).from_m - 4.0
    rehearsal = rehearse(scenario, waiting_at(before_m, 12.0, 6.4))
    ego_mps, other = rehearsal.trails[EGO][:, 3], rehearsal.trails["other"]
    stood = next(i for i in range(100, len(ego_mps)) if ego_mps[i] < 0.3)
    leaves = next(i for i in range(stood, len(other)) if other[i, 3] > 0.5)
    assert rehearsal.times_s[leaves] - rehearsal.times_s[stood] == pytest.approx(2.0, abs=0.5)


@pytest.mark.parametrize(("speed_mps", "notice_s", "metres"), [(7.0, 6.0, 35.0), (7.0, 1.0, 1.75), (3.5, 2.0, 5.25)])
def test_a_run_up_is_what_is_driven_from_rest_in_the_time(speed_mps, notice_s, metres):
    assert run_up_m(speed_mps, notice_s) == pytest.approx(metres)
