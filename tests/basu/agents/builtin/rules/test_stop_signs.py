"""Dialogues with a stop sign: what one sees, and what it then asks for."""

import numpy as np
import pytest

from basu.agents.builtin.driving.path import make_path
from basu.agents.builtin.rules.conflicts import make_zone
from basu.agents.builtin.rules.lines import BEFORE_LINE_M
from basu.agents.builtin.rules.stop_signs import COURTESY_S, REST_S, Phase, StopSign
from basu.agents.builtin.scene import Ego, Kind, Other
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
    return stop.step(Ego(time_s, front_s_m - FRONT_M, 0.0, 0.0, speed_mps), front_s_m, others) is not None


def test_one_rests_at_the_line_and_goes_on_when_nobody_comes() -> None:
    stop = sign()
    assert ask(stop, 0.0, 30.0, 5.0)
    assert ask(stop, 5.0, AT_LINE_M, 0.0)
    assert ask(stop, 5.0 + REST_S - 0.05, AT_LINE_M, 0.0)
    assert not ask(stop, 5.0 + REST_S, AT_LINE_M, 0.0)
    assert stop.phase is Phase.PASSED


def test_once_passed_it_never_asks_again_even_when_one_stops_right_behind_it() -> None:
    stop = sign()
    ask(stop, 0.0, AT_LINE_M, 0.0)
    ask(stop, 2.0, AT_LINE_M, 0.0)
    assert not any(ask(stop, 3.0 + t, AT_LINE_M + 0.2, 0.0) for t in range(20))


def test_slow_is_not_standing() -> None:
    stop = sign()
    assert all(ask(stop, 0.1 * k, AT_LINE_M, 0.06) for k in range(100))
    assert stop.phase is Phase.APPROACHING


def test_standing_in_a_queue_is_not_standing_at_the_line() -> None:
    stop = sign()
    assert all(ask(stop, 0.1 * k, LINE_S_M - 6.0, 0.0) for k in range(100))
    assert stop.phase is Phase.APPROACHING


def test_crossing_traffic_goes_first() -> None:
    stop = sign()
    ask(stop, 0.0, AT_LINE_M, 0.0)
    for k in range(60):
        y_m = -30.0 + 0.8 * k  # 8 m/s to the south, through the zone at x = 56
        waits = ask(
            stop, 2.0 + 0.1 * k, AT_LINE_M, 0.0, body_at(Kind.VEHICLE, 56.0, y_m, velocity_mps=(0.0, 8.0), yaw_deg=90.0)
        )
        assert waits == (y_m < 2.5), y_m


def test_who_stood_there_first_is_let_go_but_not_for_ever() -> None:
    stop, stood = sign(), body_at(Kind.VEHICLE, 56.0, -7.0, yaw_deg=90.0)
    assert ask(stop, 0.0, AT_LINE_M, 0.0, stood)
    assert ask(stop, COURTESY_S - 0.1, AT_LINE_M, 0.0, stood)
    assert not ask(stop, COURTESY_S + 0.1, AT_LINE_M, 0.0, stood)


def test_who_sets_off_first_is_waited_for_until_it_is_through() -> None:
    stop = sign()
    ask(stop, 0.0, AT_LINE_M, 0.0, body_at(Kind.VEHICLE, 56.0, -7.0, yaw_deg=90.0))
    assert ask(stop, 2.0, AT_LINE_M, 0.0, body_at(Kind.VEHICLE, 56.0, -5.0, velocity_mps=(0.0, 2.0), yaw_deg=90.0))
    assert not ask(stop, 6.0, AT_LINE_M, 0.0, body_at(Kind.VEHICLE, 56.0, 9.0, velocity_mps=(0.0, 4.0), yaw_deg=90.0))


def test_who_arrives_later_and_stands_does_not_hold_one_up() -> None:
    stop = sign()
    ask(stop, 0.0, AT_LINE_M, 0.0)
    assert not ask(stop, 2.0, AT_LINE_M, 0.0, body_at(Kind.VEHICLE, 56.0, -7.0, yaw_deg=90.0))


def test_a_parked_car_along_the_street_is_nobody_to_wait_for() -> None:
    stop, parked = sign(), body_at(Kind.VEHICLE, 57.0, 4.5)
    ask(stop, 0.0, AT_LINE_M, 0.0, parked)
    assert not ask(stop, REST_S + 0.05, AT_LINE_M, 0.0, parked)


def test_who_comes_from_behind_and_who_comes_towards_us_in_its_lane_do_not_cross() -> None:
    stop = sign()
    behind = body_at(Kind.VEHICLE, 35.0, 0.0, velocity_mps=(5.0, 0.0), number=8)
    oncoming = body_at(Kind.VEHICLE, 75.0, -3.2, velocity_mps=(-8.0, 0.0), yaw_deg=180.0, number=9)
    ask(stop, 0.0, AT_LINE_M, 0.0, behind, oncoming)
    assert not ask(stop, 2.0, AT_LINE_M, 0.0, behind, oncoming)


def test_a_stream_of_cars_holds_one_for_long_but_not_for_ever() -> None:
    stop = sign()
    ask(stop, 0.0, AT_LINE_M, 0.0)
    far = body_at(Kind.VEHICLE, 56.0, -34.0, velocity_mps=(0.0, 8.0), yaw_deg=90.0)  # 4 s away, whenever one looks
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
