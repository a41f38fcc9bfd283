"""Claims about objects in the way and what comes out from behind a van, offline at their places in Linden."""

from collections.abc import Callable

import pytest

from basu.scenarios.cases import open_library
from basu.scenarios.paths import Path
from basu.scenarios.scenario import Scenario
from basu.testing import rehearse, steady

Laid = Callable[..., Scenario]


LIBRARY = open_library()


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
