"""Opposite direction, offline: an ego that keeps up its speed is met in its own lane, one that stops is passed."""

import numpy as np
import pytest

from basu.scenarios.library.opposite_direction.out_of_lane import OutOfLane
from basu.scenarios.nhtsa import Group
from basu.scenarios.paths import lanes_apart_m
from basu.scenarios.scenario import Scenario
from basu.testing import Driver, OfflineStage, Rehearsal, rehearse, waiting_at

CASES = [
    *(f"narrowed_street_{n}" for n in (1, 2, 3, 4)),
    *(f"straying_oncoming_{n}" for n in (1, 2, 3, 4)),
    *(f"oncoming_overtaker_{n}" for n in (1, 2, 3, 4)),
]


def unmoved(top_mps: float) -> Driver:
    """Sets off like the shuttle, and keeps its speed despite other traffic."""

    def drive(stage: OfflineStage) -> float:
        return min(top_mps, stage.ego.forward_mps + 1.1 * stage.step_s)

    return drive


def right_of_route_m(scenario: Scenario, rehearsal: Rehearsal, name: str) -> np.ndarray:
    """How far to the right of the ego's route an actor was in each frame; nan while not there."""
    route = scenario.place.route
    found = []
    for x_m, y_m, _, _ in rehearsal.trails[name]:
        if np.isnan(x_m):
            found.append(np.nan)
            continue
        near = int(np.argmin(np.hypot(route.points_m[:, 0] - x_m, route.points_m[:, 1] - y_m)))
        dx_m, dy_m, yaw = x_m - route.points_m[near, 0], y_m - route.points_m[near, 1], route.yaw_rad[near]
        found.append(dy_m * np.cos(yaw) - dx_m * np.sin(yaw))
    return np.array(found)


@pytest.mark.parametrize("case", CASES)
def test_an_ego_that_keeps_up_its_speed_is_met_head_on(laid, case):
    scenario = laid(case)
    assert scenario.group is Group.OPPOSITE_DIRECTION
    rehearsal = rehearse(scenario, unmoved(6.4), until_s=15.0)
    assert next(iter(rehearsal.contacts_s), None) == "oncoming"


@pytest.mark.parametrize("case", CASES[::4])
def test_an_ego_that_stops_well_before_is_passed_and_gets_on(laid, case):
    scenario = laid(case)
    assert isinstance(scenario, OutOfLane)
    rehearsal = rehearse(scenario, waiting_at(scenario.back_m - 20.0, 6.0, 6.4))
    assert not rehearsal.contacts_s
    assert rehearsal.over


@pytest.mark.parametrize("case", ["narrowed_street_1", "straying_oncoming_2", "oncoming_overtaker_3"])
def test_the_other_leaves_its_lane_and_comes_back_to_it(laid, case):
    scenario = laid(case)
    rehearsal = rehearse(scenario, waiting_at(scenario.back_m - 20.0, 6.0, 6.4))
    right_m = right_of_route_m(scenario, rehearsal, "oncoming")
    there = right_m[~np.isnan(right_m)]
    apart_m = lanes_apart_m(scenario.place, scenario.back_m)
    assert there[0] == pytest.approx(-apart_m, abs=0.2)
    assert max(there) == pytest.approx(scenario.aside_m - apart_m, abs=0.2)
    assert there[-1] == pytest.approx(-apart_m, abs=0.3)


def test_an_actor_overtaken_has_been_passed_when_the_overtaker_goes_back(laid):
    scenario = laid("oncoming_overtaker_1")
    rehearsal = rehearse(scenario, waiting_at(scenario.back_m - 20.0, 6.0, 6.4))
    fast, slow = rehearsal.trails["oncoming"][:, :2], rehearsal.trails["slow"][:, :2]
    assert np.nanmin(np.hypot(*(fast - slow).T)) > 2.0


def test_parked_cars_leave_the_egos_lane_free_and_narrow_the_other(laid):
    scenario = laid("narrowed_street_1")
    parked = [spec for spec in scenario.actors() if spec.name.startswith("parked")]
    rehearsal = rehearse(scenario, unmoved(0.0), until_s=0.2)
    for spec in parked:
        right_m = right_of_route_m(scenario, rehearsal, spec.name)
        half_lane_m = scenario.place.width_m(60.0) / 2.0
        assert right_m[0] + 1.0 < -half_lane_m
        assert right_m[0] - 1.0 > -3.0 * half_lane_m - 1.0
