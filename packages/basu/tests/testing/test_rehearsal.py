"""Claims about rehearsals: a scenario of a user's own is tried offline, and drivers differ."""

import math
from collections.abc import Sequence
from typing import ClassVar

import numpy as np
import pytest
from py_trees.behaviour import Behaviour

from basu.scenarios.actions import WalkAlong
from basu.scenarios.parameters import Number, Parameter, read_values
from basu.scenarios.paths import Path
from basu.scenarios.place import Place
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import EGO, ActorSpec
from basu.scenarios.triggers import TimeToArrival
from basu.testing import OfflineStage, careful, offline_place, rehearse, steady, waiting_at


class StepsOut(Scenario):
    """A pedestrian steps out in front of the ego."""

    parameters: ClassVar[Sequence[Parameter]] = (Number("ahead", 50.0, 20.0, 80.0, "m", "of the trigger point"),)

    def actors(self) -> Sequence[ActorSpec]:
        return [ActorSpec("walker", "walker.pedestrian.0001", self.place.at(self.number("ahead"), 4.0, -90.0))]

    def trigger(self) -> Behaviour:
        return TimeToArrival(self.place.trigger_s_m + self.number("ahead"), 3.0)

    def conflict(self) -> Behaviour:
        at_m = self.number("ahead")
        return WalkAlong("walker", Path.through([self.place.at(at_m, 4.0)[:2], self.place.at(at_m, -4.0)[:2]]), 1.4)

    def criteria(self) -> Sequence[object]:
        return ()


@pytest.fixture
def bend() -> Place:
    arc = [(20.0 + 60.0 * math.sin(a), 60.0 - 60.0 * math.cos(a)) for a in np.linspace(0.0, 1.5, 60)]
    return offline_place([(0.0, 0.0), *arc], trigger_s_m=5.0)


def steps_out(place: Place, **given: str) -> StepsOut:
    return StepsOut(place, read_values(StepsOut.parameters, given))


def test_phases_come_in_order_and_the_conflict_begins_when_it_should(bend: Place) -> None:
    played = rehearse(steps_out(bend), steady(6.0))
    assert list(played.phases_s) == ["setup", "trigger", "conflict", "resolution", "end"]
    times_s = list(played.phases_s.values())
    assert times_s == sorted(times_s)
    assert played.phases_s["conflict"] == pytest.approx((55.0 - 18.0) / 6.0, abs=0.06)
    assert played.over


def test_a_blind_driver_hits_and_a_careful_one_does_not(bend: Place) -> None:
    assert list(rehearse(steps_out(bend), steady(6.0)).contacts_s) == ["walker"]
    played = rehearse(steps_out(bend), careful(6.0))
    assert not played.contacts_s
    assert played.over
    assert 2.0 < played.least_distance_m("walker") < 7.0


def test_a_value_of_the_case_moves_the_conflict(bend: Place) -> None:
    near, far = (rehearse(steps_out(bend, ahead=ahead), careful(6.0)) for ahead in ("40", "70"))
    assert far.phases_s["conflict"] - near.phases_s["conflict"] == pytest.approx(30.0 / 6.0, abs=0.1)


def test_one_that_never_comes_never_triggers(bend: Place) -> None:
    played = rehearse(steps_out(bend), steady(0.0), until_s=5.0)
    assert list(played.phases_s) == ["setup", "trigger"]
    assert not played.over


def test_the_same_rehearsal_is_the_same_again(bend: Place) -> None:
    first, again = (rehearse(steps_out(bend), careful(6.0)) for _ in range(2))
    assert all((first.trails[name] == again.trails[name]).all() for name in first.trails)


def test_the_ego_on_paper_keeps_to_its_route(bend: Place) -> None:
    played = rehearse(steps_out(bend), steady(8.0))
    way = Path.through(bend.route.points_m)
    assert max(way.nearest(x, y).distance_m for x, y in played.trails[EGO][:, :2]) < 1e-6
    assert np.diff(played.ego_s_m).max() == pytest.approx(0.4)


def test_a_lawful_stop_takes_its_time_and_goes_on(bend: Place) -> None:
    stage = OfflineStage(bend, (), waiting_at(40.0, 3.0, 8.0))
    stood = 0
    while stage.ego_s_m < 60.0:
        stage.advance()
        stood += stage.ego.speed_mps == 0.0 and 38.0 < stage.ego_s_m < 40.0
        assert stage.time_s < 30.0
    assert stood * stage.step_s == pytest.approx(3.0, abs=0.1)
