"""Claims about cyclists: beside a turn, round a door, and the door itself, offline."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import pytest

from basu.scenarios.cases import open_library
from basu.scenarios.scenario import Scenario
from basu.testing import Rehearsal, rehearse, steady

if TYPE_CHECKING:
    pass

Laid = Callable[..., Scenario]


SHUTTLE_MPS = 6.7


# the actors met by an ego that drives on blindly
MET = {
    "PedestrianCrossing": "walker",
    "PedestrianTurnsBack": "walker",
    "OccludedChild": "child",
    "CyclistCrossing": "cyclist",
    "CyclistAhead": "cyclist",
    "DeerAtDusk": "deer_2",
    "DogOnTheRoad": "dog",
    "Dooring": "cyclist",
    "CarAtTheStop": "car",
    "RunningForTheShuttle": "passenger",
}


TIMED_BY_TURNING = ("PedestrianTurn", "CyclistAtRightTurn")


OTHERS = ("CyclistSwerves", "SteeringDeviation", "LeavingStop")


LIBRARY = open_library()


CASES = [case for case in LIBRARY.cases if case.type in {*MET, *TIMED_BY_TURNING, *OTHERS}]


def names(types: object) -> list[str]:
    return [case.name for case in CASES if case.type in types]  # type: ignore[operator]


@pytest.mark.parametrize("name", names({"CyclistAtRightTurn"}))
def test_beside_a_right_turn_the_cyclist_goes_straight_on_across_it(laid: Laid, name: str) -> None:
    played = rehearse(laid(name), steady(3.5))
    yaw_rad = np.unwrap(played.trails["cyclist"][:, 2])
    assert np.ptp(yaw_rad) < 0.05
    assert "cyclist" in played.contacts_s


@pytest.mark.parametrize("name", names({"CyclistSwerves"}))
def test_round_the_door_the_cyclist_comes_into_the_lane_and_leaves_it(laid: Laid, name: str) -> None:
    scenario = laid(name)
    played = rehearse(scenario, steady(scenario.number("speed")))  # an ego that is no faster stays behind
    right_m = _beside_m(scenario, played, "cyclist")
    edge_m, into_m = scenario.number("edge"), scenario.number("into")
    assert right_m[0] == pytest.approx(edge_m, abs=0.05)
    assert right_m.min() == pytest.approx(into_m, abs=0.15)
    assert right_m[-1] == pytest.approx(edge_m, abs=0.1)
    assert "put" not in {command.what for command in played.commands}  # no thing stands in for the door
    assert {"open door", "close door"} <= {command.what for command in played.commands}


def _beside_m(scenario: Scenario, played: Rehearsal, name: str) -> np.ndarray:
    """(T,) how far to the right of a straight route an actor is."""
    start = scenario.place.at(0.0)
    gap = played.trails[name][:, :2] - (start.x_m, start.y_m)
    beside: np.ndarray = gap @ (-np.sin(start.yaw_rad), np.cos(start.yaw_rad))
    return beside


def test_a_door_reaches_into_the_lane_of_the_ego(laid: Laid) -> None:
    for name in names({"Dooring"}):
        scenario = laid(name)
        played = rehearse(scenario, steady(SHUTTLE_MPS))
        right_m = np.nanmin(_beside_m(scenario, played, "door"))
        assert right_m - 0.53 < 1.0 - 0.1, name  # half of the open door's reach, the shuttle's half width, a bit
