"""Tests of ``basu.agents.builtin.rules.right_of_way``."""

import math

import numpy as np
import pytest

from basu.agents.builtin.driving.path import make_path
from basu.agents.builtin.rules.gap_acceptance import make_zone
from basu.agents.builtin.rules.right_of_way import COURTESY_S, REST_S, StopPhase, StopSign, YieldPhase, YieldSign
from basu.agents.builtin.rules.stopping_lines import BEFORE_LINE_M
from basu.agents.builtin.scene import ActorKind, DrivenVehicle, Other
from basu.routing import ControlKind
from driving_plant import SHUTTLE_BODY, Plant, body_at, drive, line, make_driver, make_route

LINE_S_M, FRONT_M = 50.0, SHUTTLE_BODY.front_m
AT_LINE_M = LINE_S_M - BEFORE_LINE_M


def sign() -> StopSign:
    points_m = line(100.0)
    path = make_path(points_m, points_m[:, 0])
    return StopSign(LINE_S_M, make_zone(path, LINE_S_M, LINE_S_M + 12.0, SHUTTLE_BODY), 4.0)


def ask(stop: StopSign, time_s: float, front_s_m: float, speed_mps: float, *others: Other) -> bool:
    """Whether the sign asks to stop."""
    return stop.step(DrivenVehicle(time_s, front_s_m - FRONT_M, 0.0, 0.0, speed_mps), front_s_m, others) is not None


def test_one_rests_at_the_line_and_goes_on_when_no_actor_comes() -> None:
    stop = sign()
    assert ask(stop, 0.0, 30.0, 5.0)
    assert ask(stop, 5.0, AT_LINE_M, 0.0)
    assert ask(stop, 5.0 + REST_S - 0.05, AT_LINE_M, 0.0)
    assert not ask(stop, 5.0 + REST_S, AT_LINE_M, 0.0)
    assert stop.phase is StopPhase.PASSED


def test_once_passed_it_never_asks_again_even_when_one_stops_right_behind_it() -> None:
    stop = sign()
    ask(stop, 0.0, AT_LINE_M, 0.0)
    ask(stop, 2.0, AT_LINE_M, 0.0)
    assert not any(ask(stop, 3.0 + t, AT_LINE_M + 0.2, 0.0) for t in range(20))


def test_slow_is_not_standing() -> None:
    stop = sign()
    assert all(ask(stop, 0.1 * k, AT_LINE_M, 0.06) for k in range(100))
    assert stop.phase is StopPhase.APPROACHING


def test_standing_in_a_queue_is_not_standing_at_the_line() -> None:
    stop = sign()
    assert all(ask(stop, 0.1 * k, LINE_S_M - 6.0, 0.0) for k in range(100))
    assert stop.phase is StopPhase.APPROACHING


def test_crossing_traffic_goes_first() -> None:
    stop = sign()
    ask(stop, 0.0, AT_LINE_M, 0.0)
    for k in range(60):
        y_m = -30.0 + 0.8 * k  # 8 m/s to the south, through the zone at x = 56
        waits = ask(
            stop,
            2.0 + 0.1 * k,
            AT_LINE_M,
            0.0,
            body_at(ActorKind.VEHICLE, 56.0, y_m, velocity_mps=(0.0, 8.0), yaw_deg=90.0),
        )
        assert waits == (y_m < 2.5), y_m


def test_an_actor_that_stood_there_first_is_let_go_but_not_for_ever() -> None:
    stop, stood = sign(), body_at(ActorKind.VEHICLE, 56.0, -7.0, yaw_deg=90.0)
    assert ask(stop, 0.0, AT_LINE_M, 0.0, stood)
    assert ask(stop, COURTESY_S - 0.1, AT_LINE_M, 0.0, stood)
    assert not ask(stop, COURTESY_S + 0.1, AT_LINE_M, 0.0, stood)


def test_an_actor_that_sets_off_first_is_waited_for_until_it_is_through() -> None:
    stop = sign()
    ask(stop, 0.0, AT_LINE_M, 0.0, body_at(ActorKind.VEHICLE, 56.0, -7.0, yaw_deg=90.0))
    assert ask(stop, 2.0, AT_LINE_M, 0.0, body_at(ActorKind.VEHICLE, 56.0, -5.0, velocity_mps=(0.0, 2.0), yaw_deg=90.0))
    assert not ask(
        stop, 6.0, AT_LINE_M, 0.0, body_at(ActorKind.VEHICLE, 56.0, 9.0, velocity_mps=(0.0, 4.0), yaw_deg=90.0)
    )


def test_an_actor_that_arrives_later_and_stands_does_not_hold_one_up() -> None:
    stop = sign()
    ask(stop, 0.0, AT_LINE_M, 0.0)
    assert not ask(stop, 2.0, AT_LINE_M, 0.0, body_at(ActorKind.VEHICLE, 56.0, -7.0, yaw_deg=90.0))


def test_a_parked_car_along_the_street_is_no_actor_to_wait_for() -> None:
    stop, parked = sign(), body_at(ActorKind.VEHICLE, 57.0, 4.5)
    ask(stop, 0.0, AT_LINE_M, 0.0, parked)
    assert not ask(stop, REST_S + 0.05, AT_LINE_M, 0.0, parked)


def test_an_actor_that_comes_from_behind_and_one_that_comes_towards_us_in_its_lane_do_not_cross() -> None:
    stop = sign()
    behind = body_at(ActorKind.VEHICLE, 35.0, 0.0, velocity_mps=(5.0, 0.0), number=8)
    oncoming = body_at(ActorKind.VEHICLE, 75.0, -3.2, velocity_mps=(-8.0, 0.0), yaw_deg=180.0, number=9)
    ask(stop, 0.0, AT_LINE_M, 0.0, behind, oncoming)
    assert not ask(stop, 2.0, AT_LINE_M, 0.0, behind, oncoming)


def test_a_stream_of_cars_holds_one_for_long_but_not_for_ever() -> None:
    stop = sign()
    ask(stop, 0.0, AT_LINE_M, 0.0)
    far = body_at(ActorKind.VEHICLE, 56.0, -34.0, velocity_mps=(0.0, 8.0), yaw_deg=90.0)  # 4 s away, whenever one looks
    assert ask(stop, 30.0, AT_LINE_M, 0.0, far)
    assert not ask(stop, 60.0, AT_LINE_M, 0.0, far)


def test_a_sign_that_lies_behind_from_the_beginning_asks_for_nothing() -> None:
    assert not ask(sign(), 0.0, LINE_S_M + 1.5, 0.0)


@pytest.mark.parametrize("line_s_m", [40.0, 61.3, 80.0])
def test_driven_it_stops_with_the_bumper_just_before_the_line_waits_and_goes_on(line_s_m: float) -> None:
    route = make_route(
        line(140.0), controls=[(ControlKind.STOP_SIGN, line_s_m)], junctions_s_m=[(line_s_m + 2, line_s_m + 14)]
    )
    log = drive(make_driver(route), Plant(0.0, 0.0, 0.0), 60.0)
    resting = np.flatnonzero((log.speed_mps < 0.05) & (log.s_m > 5.0) & (log.s_m < line_s_m))
    gap_m = line_s_m - (log.s_m[resting] + FRONT_M)
    assert 0.3 <= gap_m.min() <= gap_m.max() <= 1.5
    assert 1.0 <= log.time_s[resting[-1]] - log.time_s[resting[0]] <= 4.0
    assert (np.diff(resting) == 1).all()  # once
    assert log.s_m[-1] > 135.0


def yield_sign() -> YieldSign:
    points_m = line(100.0)
    path = make_path(points_m, points_m[:, 0])
    return YieldSign(LINE_S_M, make_zone(path, LINE_S_M + 1.0, LINE_S_M + 10.0, SHUTTLE_BODY), 4.0)


def ask_yield_sign(yield_sign: YieldSign, time_s: float, front_s_m: float, speed_mps: float, *others: Other) -> bool:
    return (
        yield_sign.step(DrivenVehicle(time_s, front_s_m - FRONT_M, 0.0, 0.0, speed_mps), front_s_m, others) is not None
    )


def circulating(angle_deg: float) -> Other:
    """A car on a circle of 7 m around (57, 0), counter-clockwise seen from above, 4 m/s."""
    angle = math.radians(angle_deg)  # CARLA's y runs south: counter-clockwise from above is a falling angle
    at = (57.0 + 7.0 * math.cos(angle), 7.0 * math.sin(angle))
    velocity = (4.0 * math.sin(angle), -4.0 * math.cos(angle))
    yaw_deg = math.degrees(math.atan2(velocity[1], velocity[0]))
    return body_at(ActorKind.VEHICLE, *at, velocity_mps=velocity, yaw_deg=yaw_deg)._replace(yaw_rate_radps=-4.0 / 7.0)


def test_an_empty_roundabout_is_entered_without_stopping() -> None:
    yielding = yield_sign()
    assert not any(ask_yield_sign(yielding, 0.1 * k, 30.0 + 0.25 * k, 2.5) for k in range(90))


def test_an_actor_that_circulates_towards_the_entry_goes_first() -> None:
    assert ask_yield_sign(yield_sign(), 0.0, 45.0, 2.5, circulating(-100.0))


def test_a_car_that_waits_at_its_own_entry_does_not_hold_one_up() -> None:
    assert not ask_yield_sign(yield_sign(), 0.0, 45.0, 2.5, body_at(ActorKind.VEHICLE, 57.0, -14.0, yaw_deg=90.0))


def test_after_giving_way_the_gap_has_to_last_a_moment() -> None:
    yielding = yield_sign()
    ask_yield_sign(yielding, 0.0, 48.0, 1.0, circulating(-100.0))
    assert yielding.phase is YieldPhase.GIVING_WAY
    assert ask_yield_sign(yielding, 0.1, 48.2, 0.5)
    assert ask_yield_sign(yielding, 0.4, 48.3, 0.2)
    assert not ask_yield_sign(yielding, 0.7, 48.4, 0.1)


def test_over_the_line_one_does_not_stop_any_more() -> None:
    yielding = yield_sign()
    assert not ask_yield_sign(yielding, 0.0, LINE_S_M + 0.2, 2.5, circulating(-100.0))
    assert yielding.phase is YieldPhase.PASSED


def test_too_near_to_stop_one_goes_on() -> None:
    assert not ask_yield_sign(yield_sign(), 0.0, LINE_S_M - 1.5, 4.0, circulating(-100.0))


def test_driven_it_waits_at_the_line_while_cars_circulate_and_then_enters() -> None:
    route = make_route(line(120.0), controls=[(ControlKind.YIELD_SIGN, LINE_S_M)])

    def others(time_s: float) -> list[Other]:
        return [
            body_at(
                ActorKind.VEHICLE, 56.0, -60.0 + 6.0 * (time_s - k), velocity_mps=(0.0, 6.0), yaw_deg=90.0, number=k
            )
            for k in (2, 5, 8)
        ]

    log = drive(make_driver(route), Plant(0.0, 0.0, 0.0), 45.0, others)
    waiting = log.speed_mps[(log.s_m > 40.0) & (log.s_m < LINE_S_M - FRONT_M)]
    assert waiting.min() < 1.0
    assert log.s_m[log.time_s < 18.0].max() + FRONT_M <= LINE_S_M
    assert log.s_m[-1] > 100.0
    assert np.abs(log.accel_mps2).max() < 2.1
