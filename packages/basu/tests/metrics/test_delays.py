"""Claims about rests and time: blocked after three minutes, out of time by the route's length and stops."""

import pytest

from basu.metrics.delays import BLOCKED_S, delays, time_limit_s
from basu.routing import Stop
from fakes.drives import at, driven, straight_route

STOP = Stop(id="1", name="a stop", s_m=20.0, x_m=20.0, y_m=0.0, z_m=0.0, yaw_rad=0.0)


def test_a_rest_is_measured_and_is_no_block_before_three_minutes() -> None:
    found = delays(driven([*at(5.0, 2.0), *at(0.0, BLOCKED_S), *at(5.0, 2.0)]))
    assert found.longest_rest_s == pytest.approx(BLOCKED_S)
    assert found.blocked == ()


def test_more_than_three_minutes_at_rest_is_blocked_since_its_beginning() -> None:
    found = delays(driven([*at(5.0, 2.0), *at(0.05, BLOCKED_S + 0.05)]))
    (event,) = found.blocked
    assert event.tick == 40
    assert event.detail == "stood still for 180 s"


def test_two_rests_with_a_move_between_them_are_not_one() -> None:
    assert delays(driven([*at(0.0, 100.0), *at(0.2, 0.1), *at(0.0, 100.0)])).blocked == ()


def test_the_time_for_a_route_is_a_start_a_walk_and_a_minute_for_each_stop() -> None:
    assert time_limit_s(straight_route(150.0)) == pytest.approx(120.0 + 100.0)
    assert time_limit_s(straight_route(150.0, stops=(STOP, STOP))) == pytest.approx(120.0 + 100.0 + 120.0)


def test_more_time_than_that_is_a_timeout_that_tells_how_far_one_got() -> None:
    late = delays(driven(at(0.2, 230.0), route=straight_route(150.0)))
    assert late.timeouts[0].detail == "46 m of 150 m after 220 s"
    assert delays(driven(at(0.2, 219.0), route=straight_route(150.0))).timeouts == ()
