"""Claims about leaders, objects in the way and junctions of the thesis, rehearsed at their places in Linden."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from basu.scenarios.cases import open_library
from basu.scenarios.library.rear_end.follow_leading_vehicle import HALF_LENGTH_M
from basu.scenarios.parameters import Choice
from basu.scenarios.paths import Path, next_junction
from basu.scenarios.scenario import Scenario
from basu.testing import Rehearsal, careful, rehearse, steady, waiting_at

Laid = Callable[..., Scenario]
LIBRARY = open_library()
SHUTTLE_MPS = 6.7
FAST_MPS = 9.0  # an ego has to be faster than a leader at 7 m/s to hit it
# the actors met by an ego that drives on blindly
MET = {
    "FollowLeadingVehicle": "leader",
    "FollowLeadingVehicleWithObstacle": "leader",
    "LeadVehicleBrakes": "leader",
    "StopAndGo": "leader",
    "LeadVehicleSwerves": "standing",
    "StaticObject": "object",
    "DynamicObject": "object",
}
AT_JUNCTIONS = ("UnsignalizedIntersection", "Roundabout")
WHOLE = ["setup", "trigger", "conflict", "resolution", "end"]


def names(*kinds: str) -> list[str]:
    return [case.name for case in LIBRARY.cases if case.type in kinds]


def speed_mps(played: Rehearsal, name: str) -> NDArray[np.float64]:
    return played.trails[name][:, 3]


def apart_m(played: Rehearsal, one: str, other: str) -> float:
    between_m = played.trails[one][:, :2] - played.trails[other][:, :2]
    return float(np.nanmin(np.hypot(*between_m.T)))


@pytest.mark.parametrize("kind", [*MET, *AT_JUNCTIONS])
def test_each_has_three_cases_or_more_on_the_route_and_off_it(kind: str) -> None:
    found = [case.on_route for case in LIBRARY.cases if case.type == kind]
    assert len(found) >= 3
    assert set(found) == {True, False}


@pytest.mark.parametrize("name", names(*MET))
def test_an_ego_that_drives_on_meets_them(laid: Laid, name: str) -> None:
    scenario = laid(name)
    played = rehearse(scenario, steady(FAST_MPS))
    assert MET[type(scenario).__name__] in played.contacts_s


@pytest.mark.parametrize("name", [name for name in names(*MET) if not name.startswith("static_object")])
def test_an_ego_that_brakes_for_what_is_ahead_is_unharmed_and_sees_the_end(laid: Laid, name: str) -> None:
    played = rehearse(laid(name), careful(SHUTTLE_MPS))
    assert not played.contacts_s
    assert played.over
    assert list(played.phases_s) == WHOLE


@pytest.mark.parametrize("name", names("FollowLeadingVehicle"))
def test_a_leader_of_any_kind_stands_with_its_front_at_the_line(laid: Laid, name: str) -> None:
    scenario = laid(name)
    played = rehearse(scenario, careful(SHUTTLE_MPS))
    way = Path.of_route(scenario.place.route)
    stands = way.nearest(*played.trails["leader"][-1, :2])
    line_m = scenario.place.stop_line_m()
    assert line_m is not None
    front_s_m = stands.s_m + HALF_LENGTH_M[scenario.choice("leader")]
    assert scenario.place.trigger_s_m + line_m - front_s_m == pytest.approx(0.5, abs=0.4)
    assert speed_mps(played, "leader")[-1] == 0.0
    assert speed_mps(played, "leader").max() == pytest.approx(scenario.number("speed"), abs=0.1)


@pytest.mark.parametrize("name", names("FollowLeadingVehicleWithObstacle"))
def test_the_leader_lets_an_actor_cross_before_it_and_drives_on(laid: Laid, name: str) -> None:
    played = rehearse(laid(name), careful(SHUTTLE_MPS))
    stands = speed_mps(played, "leader") == 0.0
    walks = speed_mps(played, "crosser") > 0.5
    assert np.count_nonzero(stands & walks) * 0.05 > 1.0
    assert apart_m(played, "leader", "crosser") > 2.5
    after = int(np.flatnonzero(walks)[-1])
    assert speed_mps(played, "leader")[after:].max() > 2.0


def test_the_leader_brakes_as_hard_as_requested(laid: Laid) -> None:
    played = rehearse(laid("lead_vehicle_brakes_1", brake="8", speed="6"), careful(SHUTTLE_MPS))
    assert np.diff(speed_mps(played, "leader")).min() / 0.05 == pytest.approx(-8.0, abs=0.5)


def test_a_leader_placed_late_brakes_where_there_is_still_room_before_the_junction(laid: Laid) -> None:
    scenario = laid("follow_leading_vehicle_with_obstacle_1", after="60", ahead="30", brake="2")
    assert scenario.cross_m <= next_junction(scenario.place).from_m - 5.0 + 0.1
    assert scenario.brakes_m > 30.0


def test_a_van_placed_near_swerves_at_once_and_still_gets_round(laid: Laid) -> None:
    played = rehearse(laid("lead_vehicle_swerves_1", ahead="25", stands_at="50", late="25"), careful(SHUTTLE_MPS))
    assert apart_m(played, "leader", "standing") > 2.2


@pytest.mark.parametrize("stops", [1, 4])
def test_a_queue_stops_as_often_as_requested(laid: Laid, stops: int) -> None:
    played = rehearse(laid("stop_and_go_1", stops=str(stops), stride="8"), careful(SHUTTLE_MPS))
    stands = (speed_mps(played, "leader") < 0.01).astype(int)
    assert np.count_nonzero(np.diff(stands) == 1) == stops


@pytest.mark.parametrize("name", names("LeadVehicleSwerves"))
def test_the_van_gets_round_the_standing_car_untouched(laid: Laid, name: str) -> None:
    played = rehearse(laid(name), careful(SHUTTLE_MPS))
    assert apart_m(played, "leader", "standing") > 2.2
    assert np.nanmax(speed_mps(played, "standing")) == 0.0


@pytest.mark.parametrize(
    "kind", next(s for s in LIBRARY.scenarios if s.__name__ == "StaticObject").parameters[0].options
)
def test_whatever_stands_there_stands_in_the_lane(laid: Laid, kind: str) -> None:
    scenario = laid("static_object_1", object=kind)
    (actor,) = scenario.actors()
    at = Path.of_route(scenario.place.route).nearest(actor.pose.x_m, actor.pose.y_m)
    assert at.s_m == pytest.approx(scenario.number("ahead"), abs=0.1)
    assert at.right_m == pytest.approx(scenario.number("right"), abs=0.1)


@pytest.mark.parametrize("ego_mps", [4.0, 6.0, 9.0, 12.0])
@pytest.mark.parametrize("name", ["dynamic_object_1", "dynamic_object_4"])
def test_what_crosses_times_itself_by_the_ego(laid: Laid, name: str, ego_mps: float) -> None:
    assert "object" in rehearse(laid(name), steady(ego_mps)).contacts_s


def test_what_crosses_comes_out_from_behind_the_van(laid: Laid) -> None:
    scenario = laid("dynamic_object_1")
    crosses, van = scenario.actors()
    way = Path.of_route(scenario.place.route)
    hidden, hides = (way.nearest(spec.pose.x_m, spec.pose.y_m) for spec in (crosses, van))
    assert hides.s_m < hidden.s_m
    assert 0.0 < hides.right_m < hidden.right_m


@pytest.mark.parametrize("name", names(*AT_JUNCTIONS))
def test_an_ego_that_stops_at_the_line_and_lets_them_pass_arrives(laid: Laid, name: str) -> None:
    scenario = laid(name)
    line_m = next_junction(scenario.place).from_m - 3.0
    played = rehearse(scenario, waiting_at(line_m, 15.0, 6.0))
    assert not played.contacts_s
    assert played.over
    assert list(played.phases_s) == WHOLE


@pytest.mark.parametrize("name", names("UnsignalizedIntersection"))
def test_the_other_sets_off_in_the_first_region_and_accelerates_in_the_second(laid: Laid, name: str) -> None:
    scenario = laid(name)
    junction_m = next_junction(scenario.place).from_m
    played = rehearse(scenario, waiting_at(junction_m - 3.0, 8.0, 6.0))
    other_mps = speed_mps(played, "other")
    first = int(np.argmax(played.ego_s_m >= junction_m - scenario.number("first")))
    second = int(np.argmax(played.ego_s_m >= junction_m - scenario.number("second")))
    assert other_mps[: max(first, 1)].max() == 0.0
    assert other_mps[first:second].max() > 1.0
    assert other_mps[first:second].max() < np.nanmax(other_mps[second:])
    assert np.nanmax(other_mps[second:]) == pytest.approx(scenario.number("speed"), abs=0.2)


@pytest.mark.parametrize("name", names("Roundabout"))
@pytest.mark.parametrize("ego_mps", [5.0, FAST_MPS])
def test_an_ego_that_does_not_give_way_in_a_roundabout_meets_a_car(laid: Laid, name: str, ego_mps: float) -> None:
    assert {"car 1", "car 2"} & set(rehearse(laid(name), steady(ego_mps)).contacts_s)


@pytest.mark.parametrize("cars", [1, 2, 4])
def test_as_many_cars_circulate_as_requested_apart_from_each_other(laid: Laid, cars: int) -> None:
    scenario = laid("roundabout_1", cars=str(cars))
    played = rehearse(scenario, waiting_at(next_junction(scenario.place).from_m - 3.0, 15.0, 6.0))
    there = [name for name in played.trails if name.startswith("car ")]
    assert there == [f"car {number + 1}" for number in range(cars)]
    for before, behind in pairwise(there):
        assert apart_m(played, before, behind) > 4.7


@pytest.mark.parametrize("kind", [*MET, *AT_JUNCTIONS])
def test_every_choice_can_be_played(laid: Laid, kind: str) -> None:
    for name in names(kind):
        (playable,) = LIBRARY.of_id(name)
        for choice in playable.parameters:
            for option in choice.options if isinstance(choice, Choice) else ():
                assert laid(name, **{choice.name: option}).actors(), name
