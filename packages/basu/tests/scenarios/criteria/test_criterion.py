"""Tests of ``basu.scenarios.criteria.criterion``."""

import numpy as np
import pytest

from basu.scenarios import criteria
from basu.scenarios.criteria import (
    Criterion,
    Judgement,
    LeastDistance,
    LeastTtc,
    NoCollision,
    Played,
    StandingThing,
    margins_of,
    reported_always,
)
from basu.scenarios.policy import NEAR_TTC_S, NoNearMiss
from fakes.drives import at, driven, hit
from fakes.played import judgement, played
from fakes.rides import braked, eastward, moving, ride


class NeverBacks(Criterion):
    """As the documentation has it."""

    name = "never backs"

    def judge(self, played: Played) -> Judgement:
        backing = np.flatnonzero(played.history.frames["reverse"])
        if len(backing) == 0:
            return self.says(played, True, "it never backed")
        return self.says(played, False, "it put the gear in reverse", tick=int(backing[0]))


def test_a_criterion_of_ones_own_says_when_where_and_how_fast() -> None:
    history = driven(at(5.0, 4.0))
    assert NeverBacks().judge(played(history)).passed is True
    history.frames["reverse"][40:] = 1
    said = NeverBacks(deciding=False).judge(played(history))
    assert (said.criterion, said.passed, said.deciding) == ("never backs", False, False)
    assert (said.t_s, said.x_m, said.y_m, said.speed_mps) == pytest.approx((2.0, 10.0, 0.0, 5.0))


@pytest.mark.parametrize(
    ("phases_s", "phase", "tick"),
    [({}, None, 0), ({"end": 1.0}, "end", 20), ({}, "end", None), ({"end": 99.0}, "end", None)],
)
def test_a_phase_begins_in_its_frame(phases_s: dict[str, float], phase: str | None, tick: int | None) -> None:
    assert played(driven(at(5.0, 4.0)), phases_s=phases_s).first_tick(phase) == tick


def test_the_three_margins_are_reported_of_every_case_and_decide_none() -> None:
    told = reported_always([NoCollision()])
    assert [one.name for one in told] == ["least distance", "least time to collision", "post-encroachment time"]
    assert not any(one.deciding for one in told)


def test_what_the_scenario_asks_of_all_actors_is_not_reported_twice() -> None:
    told = reported_always([LeastDistance(0.5), LeastTtc(1.0, to="child")])
    assert [one.name for one in told] == ["least time to collision", "post-encroachment time"]


def test_the_margins_of_a_drive_are_figures_or_nothing() -> None:
    case = played(ride(5.0, eastward(lambda _: 10.0, 6.0), others=[(9, moving(30.0, 3.0, 0.0, 0.0))]))
    margins = margins_of([one.judge(case) for one in reported_always()])
    assert margins["ttc_s"] is margins["pet_s"] is None
    assert round(margins["distance_m"] or 0.0, 6) == 1.1
    alone = played(driven(at(5.0, 2.0)))
    assert margins_of([one.judge(alone) for one in reported_always()]) == {
        "distance_m": None,
        "ttc_s": None,
        "pet_s": None,
    }


def test_the_printed_time_to_collision_is_the_one_that_the_policy_used() -> None:
    """A car drives up to an ego that has come to rest: no near miss of the ego's, and no figure of it."""
    history = ride(6.0, eastward(braked(5.0, 1.0, 2.5), 6.0), others=[(9, moving(46.0, 0.0, -6.0, 0.0))])
    case = played(history)
    with_standing = LeastTtc().judge(case).measured
    printed = margins_of([one.judge(case) for one in reported_always()])["ttc_s"]
    assert with_standing is not None
    assert printed is not None
    assert with_standing < NEAR_TTC_S <= printed
    assert "from a collision" not in NoNearMiss().judge(case).sentence


def test_an_ego_that_never_moved_has_no_time_to_collision() -> None:
    case = played(ride(3.0, eastward(lambda _: 0.0, 3.0), others=[(9, moving(20.0, 0.0, -4.0, 0.0))]))
    said = LeastTtc(while_moving=True).judge(case)
    assert (said.measured, said.sentence) == (None, "the ego never moved while an actor was within 60 m")


def test_the_least_of_several_is_taken_and_other_figures_are_not() -> None:
    said = [
        judgement("least distance", measured=0.8),
        judgement("least distance to child", measured=0.6),
        judgement("no collision", measured=0.1),
        judgement("least time to collision to child", measured=2.0),
    ]
    assert margins_of(said) == {"distance_m": 0.6, "ttc_s": 2.0, "pet_s": None}


EVERY: list[Criterion] = [
    criteria.Arrives(),
    criteria.Gentle(),
    criteria.HeedsRedLights(),
    criteria.HeedsStopSigns(),
    criteria.InTime(),
    criteria.KeepsHeadway(1.0),
    criteria.KeepsLane(),
    criteria.KeepsLane(passing=True),
    criteria.KeepsSpeed(),
    criteria.LeastDistance(0.5),
    criteria.LeastTtc(1.0),
    criteria.MinimumSpeed(1.0),
    criteria.NoCollision(),
    criteria.Pet(1.0),
    criteria.Reaches(5.0),
    criteria.ReachesPoint(5.0, 0.0, 1.0),
    criteria.Regains(after="trigger"),
    criteria.StoppedFor("child"),
    criteria.StoppedFor("the line", s_m=9.0),
    criteria.YieldsToEmergencyVehicle("car"),
]


def test_every_criterion_of_the_package_is_here() -> None:
    classes = {value for value in vars(criteria).values() if isinstance(value, type) and issubclass(value, Criterion)}
    assert classes - {Criterion} == {type(one) for one in EVERY}


@pytest.mark.parametrize("criterion", EVERY, ids=lambda one: one.name)
@pytest.mark.parametrize("frames", [1, 2, 3, 5, 40])
@pytest.mark.parametrize("alone", [True, False])
def test_records_of_any_length_are_judged_in_words(criterion: Criterion, frames: int, alone: bool) -> None:  # noqa: FBT001
    """Plain values, a sentence without figures that are none, and a limit for whatever decides."""
    others = [] if alone else [(9, moving(12.0, 1.0, -1.0, 0.0))]
    history = ride(frames * 0.05 + 1e-3, eastward(lambda _: 10.0, 3.0), others=others)
    assert len(history.frames) == frames
    contact = () if alone else (hit(frames - 1, "vehicle.audi.tt", 9),)
    things = () if alone else (StandingThing("cone", 9.0, 3.0, 0.0, 0.2, 0.2),)
    said = criterion.judge(played(history, things=things, collisions=contact))
    assert said.sentence
    assert "nan" not in said.sentence
    assert "inf" not in said.sentence
    assert type(said.passed) in (bool, type(None))
    assert type(said.measured) in (float, type(None))
    assert {type(value) for value in (said.t_s, said.x_m, said.y_m, said.speed_mps)} <= {float, type(None)}
    assert said.passed is None or said.limit
