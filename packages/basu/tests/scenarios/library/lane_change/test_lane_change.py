"""Lane changes, offline: an ego that does not brake hits the vehicle that comes over, one that brakes follows it."""

import math

import numpy as np
import pytest

from basu.errors import ScenarioError
from basu.scenarios.nhtsa import Group
from basu.scenarios.stage import EGO
from basu.testing import Driver, OfflineStage, careful, rehearse

CASES = {
    **{f"parked_car_pulls_out_{n}": "parked car" for n in (1, 2)},
    **{f"cut_in_before_stop_{n}": "overtaker" for n in (1, 3)},
    **{f"right_hook_{n}": "overtaker" for n in (1, 4)},
    **{f"drifting_neighbour_{n}": "neighbour" for n in (1, 2, 3)},
}


def unmoved(top_mps: float) -> Driver:
    """Sets off like the shuttle, and keeps its speed despite other traffic."""

    def drive(stage: OfflineStage) -> float:
        return min(top_mps, stage.ego.forward_mps + 1.1 * stage.step_s)

    return drive


@pytest.mark.parametrize(("case", "party"), CASES.items())
def test_an_ego_that_does_not_brake_drives_into_the_vehicle_that_comes_over(laid, case, party):
    scenario = laid(case)
    assert scenario.group is Group.LANE_CHANGE
    rehearsal = rehearse(scenario, unmoved(6.4), until_s=24.0)
    assert list(rehearsal.contacts_s) == [party]


@pytest.mark.parametrize("case", list(CASES)[1::2])
def test_an_ego_that_brakes_moderately_touches_no_actor_and_gets_on(laid, case):
    rehearsal = rehearse(laid(case), careful(6.4, brake_mps2=3.5))
    assert not rehearsal.contacts_s
    assert rehearsal.over


def test_the_parked_car_stands_at_the_kerb_until_the_ego_is_near(laid):
    scenario = laid("parked_car_pulls_out_1", warning="3")
    rehearsal = rehearse(scenario, careful(6.4, brake_mps2=3.5))
    began = int(np.searchsorted(rehearsal.times_s, rehearsal.phases_s["conflict"]))
    speed_mps = rehearsal.trails["parked car"][:, 3]
    assert max(speed_mps[: began + 1]) == 0.0
    left_m = 50.0 - 2.5 - 2.0 - rehearsal.ego_s_m[began]
    assert left_m / rehearsal.trails[EGO][began, 3] == pytest.approx(3.0, abs=0.1)


def test_the_overtaker_is_the_gap_ahead_when_it_cuts_in(laid):
    scenario = laid("cut_in_before_stop_1", gap="2")
    rehearsal = rehearse(scenario, unmoved(6.4), until_s=24.0)
    ego, other = rehearsal.trails[EGO], rehearsal.trails["overtaker"]
    yaw = ego[:, 2]
    ahead_m = (other[:, 0] - ego[:, 0]) * np.cos(yaw) + (other[:, 1] - ego[:, 1]) * np.sin(yaw)
    aside_m = (other[:, 1] - ego[:, 1]) * np.cos(yaw) - (other[:, 0] - ego[:, 0]) * np.sin(yaw)
    begins = next(i for i in range(len(ego)) if ahead_m[i] > 0.0 and aside_m[i] > -2.7)
    assert ahead_m[begins] - 2.5 - 2.0 == pytest.approx(2.0, abs=1.2)


def test_the_overtaker_stops_at_the_line_itself(laid):
    scenario = laid("cut_in_before_stop_2")
    rehearsal = rehearse(scenario, careful(6.4, brake_mps2=3.5))
    line_m = scenario.place.route.controls[0].s_m
    line = scenario.place.at(line_m)
    other = rehearsal.trails["overtaker"]
    stands = [i for i in range(len(other)) if other[i, 3] < 0.05 and rehearsal.times_s[i] > 10.0]
    assert math.dist(other[stands[0], :2], line[:2]) == pytest.approx(3.5, abs=0.6)


def test_a_place_without_a_stop_sign_ahead_is_refused(laid):
    elsewhere, scenario = laid("parked_car_pulls_out_1"), laid("cut_in_before_stop_1")
    with pytest.raises(ScenarioError, match="no stop sign lies ahead"):
        type(scenario)(elsewhere.place, scenario.values).trigger()


def test_an_ego_that_hooks_right_ends_in_the_side_street(laid):
    rehearsal = rehearse(laid("right_hook_3"), careful(6.4, brake_mps2=3.5))
    yaw = rehearsal.trails["overtaker"][:, 2]
    there = yaw[~np.isnan(yaw)]
    assert math.remainder(there[-1] - there[0], math.tau) == pytest.approx(math.pi / 2.0, abs=0.2)


def test_the_neighbour_goes_back_to_its_lane(laid):
    scenario = laid("drifting_neighbour_2")
    rehearsal = rehearse(scenario, careful(6.4, brake_mps2=3.5))
    trail = rehearsal.trails["neighbour"]
    start, yaw = scenario.place.at(0.0), scenario.place.heading_rad(0.0)
    right_m = (trail[:, 1] - start.y_m) * math.cos(yaw) - (trail[:, 0] - start.x_m) * math.sin(yaw)
    there = right_m[~np.isnan(right_m)]
    assert max(there) - there[0] == pytest.approx(2.4, abs=0.2)
    assert there[-1] == pytest.approx(there[0], abs=0.3)
