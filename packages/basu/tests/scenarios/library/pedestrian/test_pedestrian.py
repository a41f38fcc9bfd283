"""Claims about pedestrians: behind a corner, and hidden by a van, offline."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import pytest

from basu.scenarios.cases import open_library
from basu.scenarios.scenario import Scenario
from basu.testing import rehearse, steady

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


@pytest.mark.parametrize("name", names({"PedestrianTurn"}))
def test_behind_the_corner_they_step_out_when_the_ego_turns(laid: Laid, name: str) -> None:
    scenario = laid(name)
    played = rehearse(scenario, steady(3.0))  # as one turns
    assert "walker" in played.contacts_s
    begun = np.argmax(played.times_s >= played.phases_s["conflict"])
    end_m = scenario.place.route.length_m
    assert 40.0 < played.ego_s_m[begun] < end_m - 20.0


def test_a_child_is_hidden_until_it_is_past_the_van(laid: Laid) -> None:
    """From the ego's middle, half its run is behind the van."""
    scenario = laid("occluded_child_1")
    played = rehearse(scenario, steady(SHUTTLE_MPS))
    child, van, ego = (played.trails[name] for name in ("child", "parked", "hero"))
    first = int(np.argmax(played.times_s >= played.phases_s["conflict"]))
    hidden = [_crosses(ego[at, :2], child[at, :2], van[at]) for at in range(first, len(child))]
    seen = first + int(np.flatnonzero(hidden)[-1]) + 1
    bumper_m = scenario.number("ahead") - 2.0 - played.ego_s_m[seen]
    assert np.count_nonzero(hidden) * 0.05 > 0.5
    assert bumper_m / SHUTTLE_MPS == pytest.approx(scenario.number("sight"), abs=0.4)


def _crosses(one: np.ndarray, other: np.ndarray, van: np.ndarray) -> bool:
    """Whether a line of sight goes through a van's box."""
    along = np.linspace(0.0, 1.0, 400)[:, None]
    points = one + along * (other - one) - van[:2]
    cos, sin = np.cos(van[2]), np.sin(van[2])
    forward, right = points @ (cos, sin), points @ (-sin, cos)
    return bool(((np.abs(forward) < 2.96) & (np.abs(right) < 0.99)).any())
