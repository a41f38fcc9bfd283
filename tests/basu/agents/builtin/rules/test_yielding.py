"""Dialogues with a yield sign at a roundabout."""

import math

import numpy as np

from basu.agents.builtin.driving.path import make_path
from basu.agents.builtin.rules.conflicts import make_zone
from basu.agents.builtin.rules.yielding import Phase, YieldSign
from basu.agents.builtin.scene import Ego, Kind, Other
from basu.routing import ControlKind
from driving_plant import SHUTTLE_BODY, Plant, body_at, drive, line, make_driver, make_route

LINE_S_M, FRONT_M = 50.0, SHUTTLE_BODY.front_m


def sign() -> YieldSign:
    points_m = line(100.0)
    path = make_path(points_m, points_m[:, 0])
    return YieldSign(LINE_S_M, make_zone(path, LINE_S_M + 1.0, LINE_S_M + 10.0, SHUTTLE_BODY), 4.0)


def ask(sign: YieldSign, time_s: float, front_s_m: float, speed_mps: float, *others: Other) -> bool:
    return sign.step(Ego(time_s, front_s_m - FRONT_M, 0.0, 0.0, speed_mps), front_s_m, others) is not None


def circulating(angle_deg: float) -> Other:
    """A car on a circle of 7 m around (57, 0), counter-clockwise seen from above, 4 m/s."""
    angle = math.radians(angle_deg)  # CARLA's y runs south: counter-clockwise from above is a falling angle
    at = (57.0 + 7.0 * math.cos(angle), 7.0 * math.sin(angle))
    velocity = (4.0 * math.sin(angle), -4.0 * math.cos(angle))
    yaw_deg = math.degrees(math.atan2(velocity[1], velocity[0]))
    return body_at(Kind.VEHICLE, *at, velocity_mps=velocity, yaw_deg=yaw_deg)._replace(yaw_rate_radps=-4.0 / 7.0)


def test_an_empty_roundabout_is_entered_without_stopping() -> None:
    yielding = sign()
    assert not any(ask(yielding, 0.1 * k, 30.0 + 0.25 * k, 2.5) for k in range(90))


def test_who_circulates_towards_the_entry_goes_first() -> None:
    assert ask(sign(), 0.0, 45.0, 2.5, circulating(-100.0))


def test_a_car_that_waits_at_its_own_entry_does_not_hold_one_up() -> None:
    assert not ask(sign(), 0.0, 45.0, 2.5, body_at(Kind.VEHICLE, 57.0, -14.0, yaw_deg=90.0))


def test_after_giving_way_the_gap_has_to_last_a_moment() -> None:
    yielding = sign()
    ask(yielding, 0.0, 48.0, 1.0, circulating(-100.0))
    assert yielding.phase is Phase.GIVING_WAY
    assert ask(yielding, 0.1, 48.2, 0.5)
    assert ask(yielding, 0.4, 48.3, 0.2)
    assert not ask(yielding, 0.7, 48.4, 0.1)


def test_over_the_line_one_does_not_stop_any_more() -> None:
    yielding = sign()
    assert not ask(yielding, 0.0, LINE_S_M + 0.2, 2.5, circulating(-100.0))
    assert yielding.phase is Phase.PASSED


def test_too_near_to_stop_one_goes_on() -> None:
    assert not ask(sign(), 0.0, LINE_S_M - 1.5, 4.0, circulating(-100.0))


def test_driven_it_waits_at_the_line_while_cars_circulate_and_then_enters() -> None:
    route = make_route(line(120.0), controls=[(ControlKind.YIELD_SIGN, LINE_S_M)])

    def others(time_s: float) -> list[Other]:
        return [
            body_at(Kind.VEHICLE, 56.0, -60.0 + 6.0 * (time_s - k), velocity_mps=(0.0, 6.0), yaw_deg=90.0, number=k)
            for k in (2, 5, 8)
        ]

    log = drive(make_driver(route), Plant(0.0, 0.0, 0.0), 45.0, others)
    waiting = log.speed_mps[(log.s_m > 40.0) & (log.s_m < LINE_S_M - FRONT_M)]
    assert waiting.min() < 1.0
    assert log.s_m[log.time_s < 18.0].max() + FRONT_M <= LINE_S_M
    assert log.s_m[-1] > 100.0
    assert np.abs(log.accel_mps2).max() < 2.1
