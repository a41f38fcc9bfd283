"""Claims about gentleness: harsh stops, and those that nothing was a reason for."""

import pytest

from basu.scenarios.criteria import Gentle, StandingThing
from fakes.drives import STEP_S
from fakes.played import played
from fakes.rides import braked, eastward, ride


def stopped(braking_mps2: float) -> object:
    """From 8 m/s, begun after 3 s; the front is at 26 m then."""
    return ride(9.0, eastward(braked(8.0, 3.0, braking_mps2), 10.0))


def test_a_gentle_stop_is_reported_with_what_was_felt() -> None:
    said = Gentle().judge(played(stopped(1.0)))  # type: ignore[arg-type]
    assert said.passed is True
    assert said.measured == pytest.approx(1.0, abs=0.1)
    assert said.sentence.startswith("the hardest braking felt was 1.0")


def test_a_harsh_stop_without_cause_is_a_phantom_stop() -> None:
    said = Gentle(phantom_only=True).judge(played(stopped(4.0)))  # type: ignore[arg-type]
    assert (said.passed, said.criterion) == (False, "no phantom stop")
    assert said.measured == pytest.approx(4.0, abs=0.35)
    assert 3.0 <= (said.t_s or 0.0) <= 5.0 + STEP_S
    assert said.sentence.startswith("phantom stop at 3.")
    assert "nothing was ahead" in said.sentence


def test_a_thing_of_the_scenarios_is_a_cause() -> None:
    case = played(stopped(4.0), things=(StandingThing("barrier", 37.0, 0.0, 0.0, 0.5, 1.5),))  # type: ignore[arg-type]
    assert Gentle().judge(case).passed is False
    said = Gentle(phantom_only=True).judge(case)
    assert said.passed is True
    assert said.sentence.endswith("; 1 harsh stop had a cause")


def test_what_was_before_its_phase_does_not_count() -> None:
    case = played(stopped(4.0), phases_s={"resolution": 7.0})  # type: ignore[arg-type]
    assert Gentle(since="resolution").judge(case).passed is True
    assert Gentle(since="end").judge(case).passed is None


def test_three_frames_are_too_short_to_feel_anything() -> None:
    assert Gentle().judge(played(ride(0.15, eastward(lambda _: 8.0, 1.0)))).passed is None
