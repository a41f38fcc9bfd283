"""Claims about the junctions of the thesis: the intersection without lights and the roundabout, offline."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from basu.scenarios.cases import open_library
from basu.scenarios.paths import next_junction
from basu.scenarios.scenario import Scenario
from basu.testing import Rehearsal, rehearse, steady, waiting_at

Laid = Callable[..., Scenario]


LIBRARY = open_library()


FAST_MPS = 9.0  # an ego has to be faster than a leader at 7 m/s to hit it


AT_JUNCTIONS = ("UnsignalizedIntersection", "Roundabout")


WHOLE = ["setup", "trigger", "conflict", "resolution", "end"]


def names(*kinds: str) -> list[str]:
    return [case.name for case in LIBRARY.cases if case.type in kinds]


def speed_mps(played: Rehearsal, name: str) -> NDArray[np.float64]:
    return played.trails[name][:, 3]


def apart_m(played: Rehearsal, one: str, other: str) -> float:
    between_m = played.trails[one][:, :2] - played.trails[other][:, :2]
    return float(np.nanmin(np.hypot(*between_m.T)))


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
