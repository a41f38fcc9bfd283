"""Claims about people on foot and on bicycles, animals and the shuttle's own, rehearsed at their places in Linden."""

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
from basu.scenarios.stage import Controls
from basu.testing import OfflineStage, Rehearsal, careful, rehearse, steady, waiting_at

if TYPE_CHECKING:
    from basu.scenarios.paths.crossings import Side

Laid = Callable[..., Scenario]
SHUTTLE_MPS = 6.7
# whom an ego meets that drives on at its speed and looks at nobody
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
def test_who_drives_on_meets_them(laid: Laid, name: str) -> None:
    scenario = laid(name)
    driver = pulling_away if isinstance(scenario, RunningForTheShuttle) else steady(SHUTTLE_MPS)
    played = rehearse(scenario, driver)
    assert MET[type(scenario).__name__] in played.contacts_s
    assert played.contacts_s[MET[type(scenario).__name__]] > played.phases_s["conflict"]


@pytest.mark.parametrize("name", [names({kind})[0] for kind in MET])
def test_who_stops_in_time_arrives_unharmed(laid: Laid, name: str) -> None:
    """For what steps in too late for a driver of paper, who sees only what is in the way, one waits."""
    scenario = laid(name)
    driver = careful(SHUTTLE_MPS)
    if isinstance(scenario, DeerAtDusk | Dooring | CyclistCrossing):
        driver = waiting_at(_meets_m(scenario) - 5.0, 9.0, SHUTTLE_MPS, brake_mps2=4.0)
    played = rehearse(scenario, driver)
    assert played.over, played.phases_s
    assert not played.contacts_s
    assert list(played.phases_s) == ["setup", "trigger", "conflict", "resolution", "end"]


def _meets_m(scenario: Scenario) -> float:
    """Along the route, where who drives on meets them."""
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


@pytest.mark.parametrize("name", names({"PedestrianTurn"}))
def test_behind_the_corner_they_step_out_when_the_ego_turns(laid: Laid, name: str) -> None:
    scenario = laid(name)
    played = rehearse(scenario, steady(3.0))  # as one turns
    assert "walker" in played.contacts_s
    begun = np.argmax(played.times_s >= played.phases_s["conflict"])
    end_m = scenario.place.route.length_m
    assert 40.0 < played.ego_s_m[begun] < end_m - 20.0


@pytest.mark.parametrize("name", names({"CyclistAtRightTurn"}))
def test_beside_a_right_turn_the_cyclist_goes_straight_on_across_it(laid: Laid, name: str) -> None:
    played = rehearse(laid(name), steady(3.5))
    yaw_rad = np.unwrap(played.trails["cyclist"][:, 2])
    assert np.ptp(yaw_rad) < 0.05
    assert "cyclist" in played.contacts_s


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


@pytest.mark.parametrize("name", names({"CyclistSwerves"}))
def test_round_the_door_the_cyclist_comes_into_the_lane_and_leaves_it(laid: Laid, name: str) -> None:
    scenario = laid(name)
    played = rehearse(scenario, steady(scenario.number("speed")))  # who is no faster stays behind
    right_m = _beside_m(scenario, played, "cyclist")
    edge_m, into_m = scenario.number("edge"), scenario.number("into")
    assert right_m[0] == pytest.approx(edge_m, abs=0.05)
    assert right_m.min() == pytest.approx(into_m, abs=0.15)
    assert right_m[-1] == pytest.approx(edge_m, abs=0.1)
    opened = [command.details[0] for command in played.commands if command.what == "put"]
    assert len(opened) == 4  # three frames of the swing, and shut again
    assert {"open door", "close door"} <= {command.what for command in played.commands}


def _beside_m(scenario: Scenario, played: Rehearsal, name: str) -> np.ndarray:
    """(T,) how far to the right of a straight route somebody is."""
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
def test_who_overtakes_at_the_stop_waits_for_the_shuttle_to_move(laid: Laid, name: str) -> None:
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
