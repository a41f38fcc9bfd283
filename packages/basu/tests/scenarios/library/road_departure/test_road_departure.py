"""Claims about gusts and the pull in a bend, offline."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from basu.scenarios.cases import open_library
from basu.scenarios.paths import Path
from basu.scenarios.scenario import Scenario
from fakes.steered_course import steered

Laid = Callable[..., Scenario]


LIBRARY = open_library()


def names(*kinds: str) -> list[str]:
    return [case.name for case in LIBRARY.cases if case.type in kinds]


@pytest.mark.parametrize(("gusts", "side"), [(1, "right"), (3, "left")])
def test_as_many_gusts_come_as_requested_to_the_side_they_are(laid: Laid, gusts: int, side: str) -> None:
    told = np.array([steer for _, steer in steered(laid("cross_wind_1", gusts=str(gusts), side=side, push="0.2"))])
    blowing = np.abs(told) > 0.0
    assert np.count_nonzero(np.diff(blowing.astype(int)) == 1) == gusts
    assert set(np.sign(told[blowing])) == {1.0 if side == "right" else -1.0}


@pytest.mark.parametrize("name", names("BendDeparture"))
def test_the_pull_in_a_bend_is_towards_its_outside(laid: Laid, name: str) -> None:
    scenario = laid(name)
    begin_m, end_m, _ = scenario.bend
    way = Path.of_route(scenario.place.route)
    turned_rad = way.heading_rad(end_m + 2.0) - way.heading_rad(begin_m - 2.0)
    assert abs(turned_rad) > math.radians(10.0)
    pulled = [steer for _, steer in steered(scenario) if steer != 0.0]
    assert set(np.sign(pulled)) == {-math.copysign(1.0, turned_rad)}
