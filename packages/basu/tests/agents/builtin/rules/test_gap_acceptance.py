"""Claims about which gaps are long enough."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from basu.agents.builtin.driving.manner import (
    AGGRESSIVE,
    CAUTIOUS,
    LEFT_FROM_MAJOR_S,
    LEFT_FROM_MINOR_S,
    NORMAL,
    ROUNDABOUT_S,
    Manner,
)
from basu.agents.builtin.driving.path import make_path
from basu.agents.builtin.rules.gap_acceptance import Movement, make_rule, movement, time_to_cover_s
from basu.agents.builtin.scene import ActorKind, Other
from basu.routing import ControlKind
from driving_plant import SHUTTLE_BODY, Log, Plant, bends, body_at, drive, line, make_behavioral, make_route

MANNERS = [CAUTIOUS, NORMAL, AGGRESSIVE]
LINE_S_M, CROSSED_AT_X_M = 60.0, 68.0


@given(st.floats(0.1, 80.0), st.floats(0.0, 12.0), st.floats(0.3, 3.0), st.floats(0.5, 12.0))
def test_the_time_to_cover_a_distance_is_that_of_driving_it(
    distance_m: float, speed_mps: float, accel_mps2: float, top_mps: float
) -> None:
    steps = 20_000
    expected_s = time_to_cover_s(distance_m, speed_mps, accel_mps2, top_mps)
    time_s = (np.arange(steps) + 0.5) * expected_s / steps
    speeds = np.minimum(speed_mps + accel_mps2 * time_s, max(top_mps, speed_mps))
    assert speeds.sum() * expected_s / steps == pytest.approx(distance_m, rel=1e-3)


def test_nothing_takes_no_time() -> None:
    assert time_to_cover_s(0.0, 3.0, 1.0, 5.0) == time_to_cover_s(-2.0, 0.0, 1.0, 5.0) == 0.0


@pytest.mark.parametrize(
    ("bend_1pm", "expected"), [(0.0, Movement.THROUGH), (0.1, Movement.RIGHT), (-0.1, Movement.LEFT)]
)
def test_what_a_way_does_in_a_junction_is_read_off_its_heading(bend_1pm: float, expected: Movement) -> None:
    points_m = bends((20.0, 0.0), (15.0, bend_1pm), (20.0, 0.0))
    path = make_path(points_m, np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points_m[:, :2], axis=0).T))]))
    assert movement(path, 18.0, 37.0) is expected


@given(
    manner=st.sampled_from(MANNERS),
    critical_s=st.sampled_from([LEFT_FROM_MAJOR_S, LEFT_FROM_MINOR_S, ROUNDABOUT_S]),
    distance_m=st.floats(1.0, 40.0),
    speed_mps=st.floats(0.0, 8.0),
    top_mps=st.floats(1.5, 8.0),
    waited_s=st.floats(0.0, 200.0),
)
def test_no_gap_is_shorter_than_the_time_that_the_crossing_takes(
    manner: Manner, critical_s: float, distance_m: float, speed_mps: float, top_mps: float, waited_s: float
) -> None:
    assert manner.gaps is not None
    rule = make_rule(manner.gaps, manner, critical_s, top_mps)
    bare_s = time_to_cover_s(distance_m, speed_mps, manner.comfort.accel_mps2, top_mps)
    assert rule.needed_s(distance_m, speed_mps, waited_s) >= bare_s
    if waited_s <= manner.gaps.patience_s:
        assert rule.needed_s(distance_m, speed_mps, waited_s) >= manner.gaps.factor * critical_s


def crossing_street(gap_s: float, speed_mps: float = 8.0, first_s: float = 0.0) -> list[tuple[float, float]]:
    """When each of a stream of cars from the north is at the level of our street, and how fast it drives."""
    return [(first_s + gap_s * k, speed_mps) for k in range(8)]


def at_a_stop_sign(manner: Manner, stream: list[tuple[float, float]], seconds: float) -> tuple[Log, list[float]]:
    """Drive straight over the crossing; the log, and the least distance to each car, both taken as boxes."""
    route = make_route(line(160.0), controls=[(ControlKind.STOP_SIGN, LINE_S_M)], junctions_s_m=[(62.0, 74.0)])

    def cars(time_s: float) -> list[Other]:
        return [
            body_at(
                ActorKind.VEHICLE, CROSSED_AT_X_M, v * (time_s - at_s), velocity_mps=(0.0, v), yaw_deg=90.0, number=k
            )
            for k, (at_s, v) in enumerate(stream)
            if abs(v * (time_s - at_s)) < 80.0
        ]

    log = drive(make_behavioral(route, manner), Plant(0.0, 0.0, 0.0), seconds, cars)
    least_m = []
    for time_s, x_m, y_m in zip(log.time_s, log.x_m, log.y_m, strict=True):
        least_m += [
            max(abs(car.x_m - x_m) - 0.95 - SHUTTLE_BODY.front_m, abs(car.y_m - y_m) - 2.2 - 1.0)
            for car in cars(time_s)
        ]
    return log, least_m


@pytest.mark.parametrize("manner", MANNERS)
@pytest.mark.parametrize("gap_s", [9.0, 11.0, 13.0])
def test_driven_a_stop_sign_is_left_in_gaps_that_are_long_enough_and_in_no_others(manner: Manner, gap_s: float) -> None:
    log, least_m = at_a_stop_sign(manner, crossing_street(gap_s), 45.0)
    assert min(least_m) > 0.5  # the cars do not brake: they need not
    assert log.x_m[-1] > 45.0


def test_driven_a_gap_below_the_critical_headway_is_not_taken() -> None:
    log, _ = at_a_stop_sign(NORMAL, crossing_street(6.0), 40.0)  # straight on takes 6.5 s by the book
    assert log.x_m[-1] + SHUTTLE_BODY.front_m < LINE_S_M


def test_the_aggressive_takes_gaps_that_the_cautious_leaves() -> None:
    left_s = {}
    for manner in MANNERS:
        log, _ = at_a_stop_sign(manner, [*crossing_street(9.0)[:3], *crossing_street(16.0, first_s=34.0)[:3]], 80.0)
        left_s[manner.name] = float(log.time_s[np.argmax(log.x_m > LINE_S_M + 5.0)])
    assert left_s["aggressive"] < left_s["normal"] <= left_s["cautious"]


def test_an_actor_that_turns_left_lets_the_ones_pass_that_come_towards_it() -> None:
    route = make_route(bends((60.0, 0.0), (12.0, -math.pi / 24), (60.0, 0.0)), junctions_s_m=[(58.0, 74.0)])

    def cars(time_s: float) -> list[Other]:
        xs = [110.0 + 24.0 * k - 8.0 * (time_s - 8.0) for k in range(5)]
        return [
            body_at(ActorKind.VEHICLE, x, -3.2, velocity_mps=(-8.0, 0.0), yaw_deg=180.0, number=k)
            for k, x in enumerate(xs)
        ]

    log = drive(make_behavioral(route), Plant(0.0, 0.0, 0.0), 60.0, cars)
    last_past_s = 8.0 + (110.0 + 24.0 * 4 - 62.0) / 8.0
    assert log.s_m[log.time_s < last_past_s].max() + SHUTTLE_BODY.front_m < 60.0
    assert "left turn" in log.reasons
    assert log.s_m[-1] > 110.0


def test_an_actor_that_turns_left_before_an_empty_street_does_not_stop() -> None:
    route = make_route(bends((60.0, 0.0), (12.0, -math.pi / 24), (60.0, 0.0)), junctions_s_m=[(58.0, 74.0)])
    log = drive(make_behavioral(route), Plant(0.0, 0.0, 0.0), 40.0)
    assert log.speed_mps[(log.s_m > 40.0) & (log.s_m < 80.0)].min() > 1.4
