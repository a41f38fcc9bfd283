"""Tests of ``basu.scenarios.criteria.traffic_rules``."""

import pytest

from basu.scenarios.criteria import HeedsRedLights, HeedsStopSigns, KeepsSpeed, MinimumSpeed
from fakes.drives import at, driven, ramp, stop_sign, straight_route, traffic_light
from fakes.played import played

GREEN, RED = 2, 0


def test_stopping_before_the_line_heeds_the_sign() -> None:
    route = straight_route(controls=(stop_sign(50.0),))
    speeds = [*at(9.0, 5.0), *at(0.0, 1.0), *at(5.0, 4.0)]  # the front stands at 47 m
    said = HeedsStopSigns().judge(played(driven(speeds, route=route)))
    assert said.passed is True
    assert said.sentence == "it stopped at stop sign 7, 3.0 m before its line"


def test_running_the_sign_is_reported_with_speed_time_and_place() -> None:
    said = HeedsStopSigns().judge(played(driven(at(9.0, 8.0), route=straight_route(controls=(stop_sign(50.0),)))))
    assert (said.passed, said.other, said.measured) == (False, "stop sign 7", pytest.approx(9.0))
    assert said.sentence.startswith(
        "it crossed the line of stop sign 7 at 9.00 m/s; the lowest speed before it was 9.00"
    )


def test_a_sign_that_was_not_passed_says_nothing() -> None:
    speeds = [*at(9.0, 4.0), *ramp(9.0, 0.0, 1.0)]
    said = HeedsStopSigns().judge(played(driven(speeds, route=straight_route(controls=(stop_sign(50.0),)))))
    assert (said.passed, said.sentence) == (None, "it passed no stop sign")


@pytest.mark.parametrize(("shown", "passed"), [(RED, False), (GREEN, True)])
def test_a_light_is_judged_by_what_it_showed(shown: int, passed: bool) -> None:  # noqa: FBT001
    history = driven(at(9.0, 8.0), route=straight_route(controls=(traffic_light(50.0),)))
    history.frames["route_light"] = shown
    said = HeedsRedLights().judge(played(history))
    assert (said.passed, said.other, said.measured) == (passed, "traffic light 12", pytest.approx(9.0))
    assert ("on red" if shown == RED else "it passed traffic light 12 on green") in said.sentence


def test_without_lights_there_is_nothing_to_judge() -> None:
    assert HeedsRedLights().judge(played(driven(at(9.0, 8.0)))).passed is None


FAST = [*at(10.0, 3.0), *at(13.0, 2.0), *at(10.0, 3.0)]


def test_within_the_tolerance_the_limit_is_kept() -> None:
    said = KeepsSpeed().judge(played(driven(at(11.9, 4.0))))
    assert (said.passed, said.measured, said.limit) == (True, pytest.approx(11.9), "at most 12.00 m/s")


def test_two_seconds_above_it_are_an_offence_with_time_and_place() -> None:
    said = KeepsSpeed().judge(played(driven(FAST)))
    assert said.passed is False
    assert said.t_s == pytest.approx(3.0)
    assert said.sentence == "it drove up to 13.00 m/s where 11.00 m/s are allowed, at 3.00 s, for 2.0 s"


def test_a_moment_above_it_is_forgiven() -> None:
    assert KeepsSpeed().judge(played(driven([*at(10.0, 3.0), *at(13.0, 0.4), *at(10.0, 3.0)]))).passed is True


def test_a_limit_of_the_scenarios_own_holds_from_its_phase_on() -> None:
    case = played(driven(FAST), phases_s={"conflict": 5.5})
    assert KeepsSpeed(limit_mps=8.0).judge(case).passed is False
    assert KeepsSpeed(limit_mps=9.5, since="conflict").judge(case).passed is True
    late = KeepsSpeed(limit_mps=8.0, since="conflict").judge(case)
    assert (late.passed, late.t_s) == (False, pytest.approx(5.5))


def test_where_no_limit_is_posted_there_is_nothing_to_judge() -> None:
    route = straight_route(limit_mps=float("nan"))
    assert KeepsSpeed().judge(played(driven(FAST, route=route))).passed is None


def test_an_ego_that_creeps_fails_by_its_mean() -> None:
    case = played(driven([*at(4.0, 5.0), *at(1.0, 5.0)]), phases_s={"conflict": 5.0})
    assert MinimumSpeed(2.0).judge(case).measured == pytest.approx(2.5)
    assert MinimumSpeed(2.0).judge(case).passed is True
    assert MinimumSpeed(2.0, since="conflict").judge(case).passed is False
