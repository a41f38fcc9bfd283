"""Claims about heeding stop signs and red lights."""

import pytest

from basu.scenarios.criteria import HeedsRedLights, HeedsStopSigns
from fakes.drives import at, driven, ramp, stop_sign, straight_route, traffic_light
from fakes.played import played

GREEN, RED = 2, 0


def test_stopping_before_the_line_heeds_the_sign() -> None:
    route = straight_route(controls=(stop_sign(50.0),))
    speeds = [*at(9.0, 5.0), *at(0.0, 1.0), *at(5.0, 4.0)]  # the front stands at 47 m
    said = HeedsStopSigns().judge(played(driven(speeds, route=route)))
    assert said.passed is True
    assert said.sentence == "it stopped at stop sign 7, 3.0 m before its line"


def test_running_the_sign_is_told_with_speed_time_and_place() -> None:
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
