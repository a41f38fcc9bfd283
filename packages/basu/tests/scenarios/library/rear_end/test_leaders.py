"""Claims about leaders: where they stop, brake and swerve, offline at their places in Linden."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from basu.scenarios.cases import open_library
from basu.scenarios.library.rear_end.follow_leading_vehicle import HALF_LENGTH_M
from basu.scenarios.paths import Path, next_junction
from basu.scenarios.scenario import Scenario
from basu.testing import Rehearsal, careful, rehearse

Laid = Callable[..., Scenario]


LIBRARY = open_library()


SHUTTLE_MPS = 6.7


def names(*kinds: str) -> list[str]:
    return [case.name for case in LIBRARY.cases if case.type in kinds]


def speed_mps(played: Rehearsal, name: str) -> NDArray[np.float64]:
    return played.trails[name][:, 3]


def apart_m(played: Rehearsal, one: str, other: str) -> float:
    between_m = played.trails[one][:, :2] - played.trails[other][:, :2]
    return float(np.nanmin(np.hypot(*between_m.T)))


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
