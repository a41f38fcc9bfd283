"""Claims about stopping for an actor, a thing or a line."""

import pytest

from basu.errors import ScenarioError
from basu.scenarios.criteria import StandingThing, StoppedFor
from fakes.drives import at, driven
from fakes.played import played
from fakes.rides import braked, eastward, moving, ride

BARRIER = (StandingThing("barrier", 40.0, 0.0, 0.0, 0.5, 2.0),)
TO_30_M = [*at(10.0, 3.0), *at(0.0, 2.0), *at(5.0, 1.0)]  # then at rest for 2 s, the front at 32 m


def test_standing_before_a_thing_is_reported_with_how_far_and_how_long() -> None:
    said = StoppedFor("barrier").judge(played(driven(TO_30_M), things=BARRIER))
    assert said.passed is True
    assert said.measured == pytest.approx(40.0 - 0.5 - 32.0)
    assert said.sentence == "it stood 7.50 m before barrier from 3.00 s on for 2.00 s"


def test_standing_too_far_away_is_not_for_it() -> None:
    said = StoppedFor("barrier", within_m=5.0).judge(played(driven(TO_30_M), things=BARRIER))
    assert said.passed is False
    assert "it did not stop for barrier: the least speed within 5 m was 5.00 m/s" in said.sentence


def test_it_may_be_asked_to_stand_for_a_while() -> None:
    case = played(driven(TO_30_M), things=BARRIER)
    assert StoppedFor("barrier", stand_s=1.9).judge(case).passed is True
    assert StoppedFor("barrier", stand_s=2.5).judge(case).passed is False


def test_stopping_for_an_actor_an_ego_that_moves() -> None:
    """The ego stands at 15 m from 2 s on; the other crosses 6 m before it meanwhile."""
    crossing = (9, moving(23.0, 20.0, 0.0, -6.0))
    history = ride(6.0, eastward(braked(10.0, 1.0, 10.0), 7.0), others=[crossing])
    assert StoppedFor("child").judge(played(history)).passed is True
    assert StoppedFor("child", since="resolution").judge(played(history, phases_s={"resolution": 5.9})).passed is False


def test_a_line_is_stopped_for_with_the_bumper_before_it() -> None:
    case = played(driven(TO_30_M))
    assert StoppedFor("the kerb", s_m=35.0).judge(case).measured == pytest.approx(3.0)
    assert StoppedFor("the kerb", s_m=31.5).judge(case).passed is True  # half a metre over it is still before it
    assert StoppedFor("the kerb", s_m=30.5).judge(case).passed is False


def test_an_ego_that_never_came_near_did_not_stop() -> None:
    said = StoppedFor("barrier", within_m=2.0).judge(played(driven(at(5.0, 2.0)), things=BARRIER))
    assert (said.passed, said.sentence) == (False, "it never was within 2 m before barrier")
    assert StoppedFor("child").judge(played(driven(TO_30_M))).passed is None


def test_what_no_actor_can_do_is_refused() -> None:
    with pytest.raises(ScenarioError, match="to stop within 0 m"):
        StoppedFor("barrier", within_m=0.0)
