"""Claims that hold for all scenarios with people, animals and the shuttle, offline."""

from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, cast

import numpy as np
import pytest
from py_trees.common import Status

import basu.routes
from basu.routing.route_file import read_routes
from basu.scenarios.cases import open_library
from basu.scenarios.library.animal.deer_at_dusk import DeerAtDusk
from basu.scenarios.library.pedalcyclist.cyclist_crossing import CyclistCrossing
from basu.scenarios.library.pedalcyclist.dooring import Dooring
from basu.scenarios.library.shuttle.running_for_the_shuttle import RunningForTheShuttle
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice
from basu.scenarios.paths import crossing
from basu.scenarios.scenario import Scenario, compose, set_on
from basu.testing import OfflineStage, careful, rehearse, steady, waiting_at

if TYPE_CHECKING:
    from basu.scenarios.paths.crossings import Side

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


def pulling_away(stage: OfflineStage) -> float:
    """At full throttle, about as the shuttle does."""
    return min(SHUTTLE_MPS, stage.ego.forward_mps + 1.4 * stage.step_s)


@pytest.mark.parametrize("name", ["pedestrian_crossing_1", "pedestrian_turn_1"])
def test_an_early_pedestrian_sets_out_as_much_sooner(laid: Laid, name: str) -> None:
    sets_out_s = [
        rehearse(laid(name, early=early_s), steady(SHUTTLE_MPS)).phases_s["conflict"] for early_s in ("0.5", "-1.0")
    ]
    assert sets_out_s[1] - sets_out_s[0] == pytest.approx(1.5, abs=0.1)


@pytest.mark.parametrize("kind", [*MET, *TIMED_BY_TURNING, *OTHERS])
def test_each_has_three_cases_or_more_on_the_route_and_off_it(kind: str) -> None:
    found = [case.on_route for case in CASES if case.type == kind]
    assert len(found) >= 3
    assert set(found) == {True, False}


def test_every_group_of_theirs_has_two_scenarios_or_more() -> None:
    groups = Counter(LIBRARY.type_of(case).group for case in {case.type: case for case in CASES}.values())
    assert groups == {Group.PEDESTRIAN: 4, Group.PEDALCYCLIST: 5, Group.ANIMAL: 2, Group.SHUTTLE: 4}


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_case_marked_so_begins_on_the_shuttles_route(case: object) -> None:
    (leap,) = read_routes(Path(basu.routes.__path__[0]) / "linden_leap.xml")
    corners = np.array([(point.x_m, point.y_m) for point in leap.points])
    legs = np.diff(corners, axis=0)
    at = np.array([case.ego.pose.x_m, case.ego.pose.y_m])  # type: ignore[attr-defined]
    share = np.clip(((at - corners[:-1]) * legs).sum(axis=1) / (legs**2).sum(axis=1), 0.0, 1.0)
    away_m = float(np.hypot(*(corners[:-1] + share[:, None] * legs - at).T).min())
    assert (away_m < 2.0) == case.on_route  # type: ignore[attr-defined]


@pytest.mark.parametrize("name", names(MET))
def test_an_ego_that_drives_on_meets_them(laid: Laid, name: str) -> None:
    scenario = laid(name)
    driver = pulling_away if isinstance(scenario, RunningForTheShuttle) else steady(SHUTTLE_MPS)
    played = rehearse(scenario, driver)
    assert MET[type(scenario).__name__] in played.contacts_s
    assert played.contacts_s[MET[type(scenario).__name__]] > played.phases_s["conflict"]


@pytest.mark.parametrize("name", [names({kind})[0] for kind in MET])
def test_an_ego_that_stops_in_time_arrives_unharmed(laid: Laid, name: str) -> None:
    """The offline driver reacts to obstacles only, so it waits for an actor that steps in late."""
    scenario = laid(name)
    driver = careful(SHUTTLE_MPS)
    if isinstance(scenario, DeerAtDusk | Dooring | CyclistCrossing):
        driver = waiting_at(_meets_m(scenario) - 5.0, 9.0, SHUTTLE_MPS, brake_mps2=4.0)
    played = rehearse(scenario, driver)
    assert played.over, played.phases_s
    assert not played.contacts_s
    assert list(played.phases_s) == ["setup", "trigger", "conflict", "resolution", "end"]


def _meets_m(scenario: Scenario) -> float:
    """Along the route, where an ego that drives on meets them."""
    if isinstance(scenario, CyclistCrossing):
        return crossing(scenario.place, cast("Side", scenario.choice("side"))).ego_s_m
    if isinstance(scenario, Dooring):
        return scenario.number("ahead") - 4.0  # the cyclist stands before the door's hinge
    return scenario.number("ahead")


@pytest.mark.parametrize("speed_mps", [4.0, 12.0])
@pytest.mark.parametrize("name", ["pedestrian_crossing_1", "occluded_child_1", "deer_at_dusk_1", "cyclist_crossing_3"])
def test_they_time_themselves_by_the_ego(laid: Laid, name: str, speed_mps: float) -> None:
    scenario = laid(name)
    assert MET[type(scenario).__name__] in rehearse(scenario, steady(speed_mps)).contacts_s


@pytest.mark.parametrize("kind", [*MET, *TIMED_BY_TURNING, *OTHERS])
def test_the_ends_of_every_range_can_be_set_on_a_stage(laid: Laid, kind: str) -> None:
    name = names({kind})[0]
    for parameter in LIBRARY.playable(next(case for case in CASES if case.name == name)).parameters:
        ends = parameter.options if isinstance(parameter, Choice) else (str(parameter.low), str(parameter.high))
        for end in ends:
            scenario = laid(name, **{parameter.name: end})
            tree = compose(scenario)
            set_on(tree, OfflineStage(scenario.place, scenario.actors(), steady(SHUTTLE_MPS)))
            tree.root.tick()
            assert tree.root.root.status is Status.RUNNING, f"{parameter.name}={end}"
