"""Claims about the least time to collision: closed forms of straight drives."""

import math

import pytest

from basu.errors import ScenarioError
from basu.scenarios.criteria import LeastTtc, Thing
from fakes.drives import at, driven, hit
from fakes.played import played
from fakes.rides import braked, eastward, moving, ride


def test_towards_somebody_at_rest_it_is_the_gap_over_the_speed() -> None:
    """At 8 m/s from 0: after 3 s the front is at 26 m, the other's rear at 38 m."""
    said = LeastTtc(1.0).judge(played(ride(3.05, eastward(lambda _: 8.0, 4.0), others=[(9, moving(40.0, 0.0, 0, 0))])))
    assert said.measured == pytest.approx(12.0 / 8.0, abs=1e-6)
    assert (said.passed, said.t_s) == (True, pytest.approx(3.0))
    assert said.sentence == (
        "child (vehicle.audi.tt) was 1.50 s from a collision at 3.00 s, the ego at 8.00 m/s and the other at 0.00 m/s"
    )


def test_towards_each_other_both_speeds_count() -> None:
    """After 1 s the front is at 12 m and the other's at 60 - 2 - 6 = 52 m; they close at 16 m/s."""
    oncoming = (9, moving(60.0, 0.0, -6.0, 0.0))
    said = LeastTtc().judge(played(ride(1.05, eastward(lambda _: 10.0, 2.0), others=[oncoming])))
    assert said.measured == pytest.approx(40.0 / 16.0, abs=1e-6)


def test_on_crossing_courses_the_clock_runs_down_to_the_contact() -> None:
    """The front comes to the other's strip (x = 29.1) after 2.71 s, its nose is then 0.5 m into the ego's already."""
    touch_s = (30.0 - 0.9 - 2.0) / 10.0
    crossing = (9, moving(30.0, 1.0 + 2.0 - 0.5 + 8.0 * touch_s, 0.0, -8.0))
    said = LeastTtc(1.0).judge(played(ride(2.0, eastward(lambda _: 10.0, 3.0), others=[crossing])))
    assert said.measured == pytest.approx(touch_s - 1.95, abs=1e-6)
    assert said.passed is False


def test_braking_in_front_of_somebody_it_is_least_on_the_way() -> None:
    """5 m/s² from 10 m/s to rest 4 m short: 4 / v + v / 10 at a speed of v, least at v = sqrt(40)."""
    parked = (9, moving(20.0 + 10.0 + 2.0 + 4.0 + 2.0, 0.0, 0.0, 0.0))
    said = LeastTtc().judge(played(ride(6.0, eastward(braked(10.0, 2.0, 5.0), 6.0), others=[parked])))
    assert said.measured == pytest.approx(math.sqrt(1.6), abs=0.005)


def test_things_are_run_towards_like_anybody() -> None:
    said = LeastTtc(2.0).judge(played(driven(at(10.0, 2.05)), things=(Thing("barrier", 30.5, 0.0, 0.0, 0.5, 1.0),)))
    assert (said.other, said.passed) == ("barrier", False)
    assert said.measured == pytest.approx((30.0 - 22.0) / 10.0, abs=1e-6)


def test_beyond_five_seconds_nothing_is_measured_and_the_limit_is_kept() -> None:
    case = played(ride(2.0, eastward(lambda _: 10.0, 3.0), others=[(9, moving(40.0, 6.0, 10.0, 0.0))]))
    said = LeastTtc(1.0).judge(case)
    assert (said.passed, said.measured, said.sentence) == (True, None, "it never was below 5 s")
    assert LeastTtc().judge(case).passed is None


def test_who_was_touched_was_no_time_away() -> None:
    history = ride(2.0, eastward(lambda _: 10.0, 3.0), others=[(9, moving(40.0, 6.0, 10.0, 0.0))])
    said = LeastTtc(0.5).judge(played(history, collisions=(hit(30, "vehicle.audi.tt", 9),)))
    assert (said.measured, said.passed, said.t_s) == (0.0, False, pytest.approx(1.5))


def test_a_limit_that_is_never_measured_is_refused() -> None:
    with pytest.raises(ScenarioError, match="cannot be held against 6 s: it is measured from 0 to 5 s"):
        LeastTtc(6.0)
