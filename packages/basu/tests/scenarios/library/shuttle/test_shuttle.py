"""Claims about the shuttle: its steering, its stop, and overtakers there, offline."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import pytest

from basu.scenarios.cases import open_library
from basu.scenarios.scenario import Scenario, compose, set_on
from basu.scenarios.stage import Controls
from basu.testing import OfflineStage, Rehearsal, rehearse, steady

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


def _beside_m(scenario: Scenario, played: Rehearsal, name: str) -> np.ndarray:
    """(T,) how far to the right of a straight route an actor is."""
    start = scenario.place.at(0.0)
    gap = played.trails[name][:, :2] - (start.x_m, start.y_m)
    beside: np.ndarray = gap @ (-np.sin(start.yaw_rad), np.cos(start.yaw_rad))
    return beside


def test_a_slight_deviation_changes_the_wheels_for_a_moment_and_no_more(laid: Laid) -> None:
    for name in names({"SteeringDeviation"}):
        scenario = laid(name)
        played = rehearse(scenario, steady(SHUTTLE_MPS))
        (begun, ended) = (command for command in played.commands if command.what == "disturb")
        assert (begun.details[1], ended.details[1]) == (True, False)
        assert ended.time_s - begun.time_s == pytest.approx(scenario.number("lasts"), abs=0.1)
        assert played.over


def test_a_deviation_goes_to_the_side_it_is_said_to(laid: Laid) -> None:
    for side, sign in (("right", 1.0), ("left", -1.0)):
        scenario = laid("steering_deviation_1", side=side)
        stage = OfflineStage(scenario.place, (), steady(SHUTTLE_MPS))
        tree = compose(scenario)
        set_on(tree, stage)
        meant = Controls(0.3, 0.0, 0.0)
        steer = []
        while stage.time_s < 10.0:
            tree.root.tick()
            steer.append(stage.controls(meant).steer)
            stage.advance()
        assert sign * max(steer, key=abs) == pytest.approx(0.03)


@pytest.mark.parametrize("name", names({"LeavingStop"}))
def test_an_ego_that_overtakes_at_the_stop_waits_for_the_shuttle_to_move(laid: Laid, name: str) -> None:
    scenario = laid(name)

    def waits(stage: object) -> float:
        return 0.0 if stage.time_s < 5.0 else min(5.0, 1.0 * (stage.time_s - 5.0))  # type: ignore[attr-defined]

    played = rehearse(scenario, waits)
    assert played.phases_s["conflict"] == pytest.approx(5.3, abs=0.2)
    right_m = _beside_m(scenario, played, "car")
    back_in_m = right_m[np.isfinite(right_m)][-1]
    assert np.nanmin(right_m) < -2.5
    assert back_in_m == pytest.approx(0.0, abs=0.3)


def test_a_car_at_the_stop_stands_at_the_stop_of_the_case(laid: Laid) -> None:
    for name in names({"CarAtTheStop"}):
        scenario = laid(name)
        (stop,) = scenario.place.route.stops
        (car,) = scenario.actors()
        assert np.hypot(car.pose.x_m - stop.x_m, car.pose.y_m - stop.y_m) < 1.0, name
