"""Tests of ``basu.agents.builtin.rules.obstacles``."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from basu.agents.builtin.driving.manner import AGGRESSIVE, CAUTIOUS, NORMAL, Following, Manner, slowing_distance_m
from basu.agents.builtin.driving.planner import RESERVE, Planner
from basu.agents.builtin.rules.obstacles import CLOSEST_M, LEADER_LIMIT_MPS2, floor, follow_mps2
from basu.agents.builtin.scene import ActorKind, Other
from driving_plant import (
    DT_S,
    SHUTTLE_BODY,
    Log,
    Plant,
    bends,
    body_at,
    drive,
    line,
    make_behavioral,
    make_driver,
    make_route,
)

MANNERS = [CAUTIOUS, NORMAL, AGGRESSIVE]
IDM = Following(1.6, 2.0, 0.73, 1.67)  # as published


def following_of(manner: Manner) -> Following:
    assert manner.following is not None
    return manner.following


@given(speed_mps=st.floats(0.0, 30.0))
def test_at_standoff_plus_headway_behind_an_equally_fast_leader_nothing_changes(speed_mps: float) -> None:
    gap_m = IDM.standoff_m + IDM.headway_s * speed_mps
    assert follow_mps2(gap_m, speed_mps, speed_mps, IDM) == pytest.approx(0.0, abs=1e-9)


def test_closing_in_from_afar_takes_the_comfortable_deceleration() -> None:
    # Treiber et al. 2000: near a standing obstacle, v² / 2 gap being b, the model brakes with b² / b = b
    speed_mps, a, b = 20.0, IDM.accel_mps2, IDM.brake_mps2
    gap_m = speed_mps**2 / (2.0 * b)
    only_closing = IDM._replace(standoff_m=0.0, headway_s=0.0)
    assert follow_mps2(gap_m, speed_mps, 0.0, only_closing) == pytest.approx(a - b, abs=1e-6)


@given(st.floats(0.5, 60.0), st.floats(0.0, 15.0), st.floats(0.0, 15.0), st.floats(0.1, 5.0))
def test_more_room_never_asks_for_more_braking(gap_m: float, own: float, leader: float, more_m: float) -> None:
    assert follow_mps2(gap_m + more_m, own, leader, IDM) >= follow_mps2(gap_m, own, leader, IDM)


@pytest.mark.parametrize("manner", MANNERS)
@pytest.mark.parametrize("leads_mps", [3.0, 5.0])
def test_a_steady_leader_is_followed_at_the_manners_own_distance(manner: Manner, leads_mps: float) -> None:
    def leader(time_s: float) -> list[Other]:
        return [body_at(ActorKind.VEHICLE, 25.0 + leads_mps * time_s, 0.0, velocity_mps=(leads_mps, 0.0))]

    log = drive(make_behavioral(make_route(line(330.0)), manner), Plant(0.0, 0.0, 0.0), 55.0, leader)
    gap_m = leader(log.time_s[-1])[0].x_m - 2.2 - (log.x_m[-1] + SHUTTLE_BODY.front_m)
    following = following_of(manner)
    assert log.speed_mps[-1] == pytest.approx(leads_mps, abs=0.1)
    assert gap_m == pytest.approx(following.standoff_m + following.headway_s * leads_mps, rel=0.08)


@settings(max_examples=100)
@given(
    own_mps=st.floats(0.0, 15.0), leads_mps=st.floats(0.0, 15.0), spare_m=st.floats(0.0, 15.0), after_s=st.floats(0, 3)
)
def test_whenever_a_leader_brakes_with_all_it_has_it_is_never_touched(
    own_mps: float, leads_mps: float, spare_m: float, after_s: float
) -> None:
    """From every state from which it is possible; the planner's reference, followed exactly."""
    planner = Planner(DT_S)
    planner.speed_mps = own_mps
    stops_m = slowing_distance_m(own_mps, 0.0, 0.0, RESERVE) + 2.0 * own_mps * DT_S
    gap_m = max(stops_m - leads_mps**2 / (2.0 * LEADER_LIMIT_MPS2), 0.0) + CLOSEST_M + spare_m
    least_m = gap_m
    for step in range(260):
        if step * DT_S >= after_s:
            leads_mps = max(0.0, leads_mps - LEADER_LIMIT_MPS2 * DT_S)
        follow = follow_mps2(gap_m, planner.speed_mps, leads_mps, following_of(AGGRESSIVE))
        planner.step(planner.speed_mps, 15.0, [floor(gap_m, leads_mps)], follow)
        gap_m += (leads_mps - planner.speed_mps) * DT_S
        least_m = min(least_m, gap_m)
    assert least_m > 0.0


@pytest.mark.parametrize("manner", MANNERS)
@pytest.mark.parametrize("brakes_mps2", [1.0, 8.0])
def test_driven_a_leader_that_brakes_to_a_stop_is_stopped_behind(manner: Manner, brakes_mps2: float) -> None:
    def leader(time_s: float) -> list[Other]:
        braked_s = min(max(0.0, time_s - 25.0), 6.0 / brakes_mps2)
        speed_mps = 6.0 - brakes_mps2 * braked_s
        x_m = 15.0 + 6.0 * min(time_s, 25.0) + 6.0 * braked_s - brakes_mps2 * braked_s**2 / 2.0
        return [body_at(ActorKind.VEHICLE, x_m, 0.0, velocity_mps=(speed_mps, 0.0))]

    driver = make_behavioral(make_route(line(400.0)), manner, left_width_m=0.0)
    log = drive(driver, Plant(0.0, 0.0, 0.0), 48.0, leader)
    gaps_m = [leader(t)[0].x_m - 2.2 - (x + SHUTTLE_BODY.front_m) for t, x in zip(log.time_s, log.x_m, strict=True)]
    assert min(gaps_m) > 1.0
    assert log.speed_mps[-1] == 0.0
    assert gaps_m[-1] < 6.0
    if brakes_mps2 <= 1.0:
        assert -log.accel_mps2.min() < 2.2  # an ordinary stop is an ordinary stop for a follower, too


@given(st.floats(0.0, 40.0), st.floats(0.0, 15.0))
def test_the_floor_is_where_the_leader_would_come_to_rest(gap_m: float, leads_mps: float) -> None:
    asked = floor(gap_m, leads_mps)
    assert asked.distance_m + CLOSEST_M - gap_m == pytest.approx(leads_mps**2 / (2.0 * LEADER_LIMIT_MPS2), abs=1e-9)
    assert math.isclose(asked.speed_mps, 0.0)


FRONT_M = SHUTTLE_BODY.front_m


class Leader:
    """A car ahead that follows a script of accelerations."""

    def __init__(self, ahead_m: float, accel_mps2: Callable[[float], float], top_mps: float = 6.0) -> None:
        self.x_m, self.speed_mps, self.time_s = ahead_m, 0.0, 0.0
        self._accel_mps2, self._top_mps = accel_mps2, top_mps

    def __call__(self, time_s: float) -> list[Other]:
        while self.time_s < time_s - 1e-9:
            self.speed_mps = min(max(0.0, self.speed_mps + self._accel_mps2(self.time_s) * DT_S), self._top_mps)
            self.x_m += self.speed_mps * DT_S
            self.time_s += DT_S
        return [body_at(ActorKind.VEHICLE, self.x_m, 0.2, velocity_mps=(self.speed_mps, 0.0))]


def least_gap_m(log: Log, others: Callable[[float], list[Other]]) -> float:
    """The least distance from the front bumper to an actor in the strip that the shuttle sweeps; inf without one."""
    gaps = [np.inf]
    for time_s, x_m in zip(log.time_s, log.x_m, strict=True):
        gaps += [
            other.x_m - other.half_length_m - (x_m + FRONT_M)
            for other in others(time_s)
            if abs(other.y_m) < 1.0 + other.half_width_m and other.x_m + other.half_length_m > x_m - SHUTTLE_BODY.rear_m
        ]
    return min(gaps)


def on_a_street(others: Callable[[float], list[Other]], seconds: float = 50.0, length_m: float = 300.0) -> Log:
    return drive(make_driver(make_route(line(length_m))), Plant(0.0, 0.0, 0.0), seconds, others)


@pytest.mark.parametrize("kind", list(ActorKind))
def test_what_stands_in_the_way_is_stopped_for_in_comfort(kind: ActorKind) -> None:
    log = on_a_street(lambda _: [body_at(kind, 100.0, 0.5)])
    assert log.speed_mps[-1] == 0.0
    assert 1.5 < 100.0 - body_at(kind, 0.0, 0.0).half_length_m - (log.s_m[-1] + FRONT_M) < 2.5
    assert np.abs(log.accel_mps2).max() <= 1.0


def test_what_stands_beside_the_way_is_driven_past() -> None:
    log = on_a_street(
        lambda _: [body_at(ActorKind.VEHICLE, 60.0, 2.4), body_at(ActorKind.WALKER, 80.0, -1.8, number=8)]
    )
    assert log.s_m[-1] > 200.0
    assert log.speed_mps[(log.s_m > 50.0) & (log.s_m < 90.0)].min() > 6.5


@pytest.mark.parametrize("braking_mps2", [1.0, 3.0, 6.0, 8.0])
def test_a_leader_that_brakes_is_never_touched(braking_mps2: float) -> None:
    script = lambda t: 1.0 if t < 20.0 else -braking_mps2  # noqa: E731 - the script is the test's parameter
    log = on_a_street(Leader(15.0, script))
    leader = Leader(15.0, script)
    gaps = [leader(t)[0].x_m - 2.2 - (x + FRONT_M) for t, x in zip(log.time_s, log.x_m, strict=True)]
    assert min(gaps) > 1.0
    assert -log.accel_mps2.min() < 2.5


def test_a_steady_leader_is_followed_at_a_steady_distance_of_about_two_seconds() -> None:
    leader = Leader(15.0, lambda _: 1.0, top_mps=5.0)
    log = on_a_street(leader, 45.0)
    gap_m = leader(log.time_s[-1])[0].x_m - 2.2 - (log.x_m[-1] + FRONT_M)
    assert log.speed_mps[-1] == pytest.approx(5.0, abs=0.1)
    assert 1.5 < gap_m / 5.0 < 3.5


def test_when_the_leader_goes_on_so_does_the_shuttle() -> None:
    log = on_a_street(Leader(15.0, lambda t: 1.0 if t < 15.0 else -1.5 if t < 30.0 else 1.0), 60.0)
    assert log.speed_mps[log.time_s > 25.0].min() < 0.02
    assert log.speed_mps[-1] > 5.0


@pytest.mark.parametrize("start_s", [6.0, 8.0, 9.0, 10.0, 11.0, 12.0])
@pytest.mark.parametrize("walks_mps", [0.9, 1.4, 2.5])
def test_an_actor_that_crosses_on_foot_is_not_touched(start_s: float, walks_mps: float) -> None:
    def walker(time_s: float) -> list[Other]:
        walking = time_s >= start_s
        y_m = -6.0 + walks_mps * max(0.0, time_s - start_s)
        return [body_at(ActorKind.WALKER, 60.0, y_m, velocity_mps=(0.0, walks_mps if walking else 0.0))]

    log = on_a_street(walker, 40.0)
    assert least_gap_m(log, walker) > 0.3
    assert log.s_m[-1] > 120.0  # and one goes on afterwards


@pytest.mark.parametrize("ahead_m", [7.0, 8.5, 11.0, 15.0])
def test_an_actor_that_steps_out_is_braked_for_as_hard_as_it_takes(ahead_m: float) -> None:
    # 6.7 m/s: within the drive model's limits 7 m are just enough to stop
    driver, plant = make_driver(make_route(line(200.0))), Plant(40.0, 0.0, 0.0, 6.7)
    at_m = 40.0 + FRONT_M + ahead_m
    walker = lambda _: [body_at(ActorKind.WALKER, at_m, 1.0)]  # noqa: E731
    log = drive(driver, plant, 6.0, walker)
    assert log.speed_mps[-1] == 0.0
    assert at_m - 0.2 - (log.x_m[-1] + FRONT_M) > 0.1
    assert -log.accel_mps2.min() > 1.2


def test_a_car_in_the_opposite_lane_of_a_bend_is_no_reason_to_brake() -> None:
    route = make_route(bends((40.0, 0.0), (30.0, 1 / 25), (60.0, 0.0)))
    free = drive(make_driver(route), Plant(0.0, 0.0, 0.0), 25.0)
    oncoming = [body_at(ActorKind.VEHICLE, 47.0, -2.9, velocity_mps=(-6.0, -0.5), yaw_deg=185.0)]
    met = drive(make_driver(route), Plant(0.0, 0.0, 0.0), 25.0, lambda t: oncoming if 8.0 < t < 10.0 else [])
    assert met.s_m[-1] == pytest.approx(free.s_m[-1], abs=0.5)


def test_an_actor_behind_is_not_looked_at() -> None:
    log = drive(
        make_driver(make_route(line(300.0))),
        Plant(50.0, 0.0, 0.0),
        20.0,
        lambda _: [body_at(ActorKind.VEHICLE, 44.0, 0.0)],
    )
    assert log.speed_mps[-1] > 6.5


@pytest.mark.parametrize("brakes_at_s", [14.0, 15.0, 16.0])
def test_an_actor_that_comes_towards_a_behavioral_driver_in_its_lane_is_given_room_to_stop(brakes_at_s: float) -> None:
    def wrong_way(time_s: float) -> list[Other]:
        braked_s = min(max(0.0, time_s - brakes_at_s), 2.0)
        x_m = 220.0 - 8.0 * min(time_s, brakes_at_s) - 8.0 * braked_s + 2.0 * braked_s**2
        return [body_at(ActorKind.VEHICLE, x_m, -0.5, velocity_mps=(4.0 * braked_s - 8.0, 0.0), yaw_deg=180.0)]

    driver = make_behavioral(make_route(line(300.0)), left_width_m=0.0)
    log = drive(driver, Plant(0.0, 0.0, 0.0), 25.0, wrong_way)
    assert log.speed_mps[-1] == 0.0
    assert least_gap_m(log, wrong_way) > 1.0


def test_an_actor_that_cuts_the_corner_into_the_other_lane_is_not_braked_for() -> None:
    cutting = lambda _: [body_at(ActorKind.VEHICLE, 110.0, -2.2, velocity_mps=(-10.4, -1.7), yaw_deg=189.0)]  # noqa: E731
    log = drive(make_behavioral(make_route(line(300.0))), Plant(70.0, 0.0, 0.0, 6.7), 0.5, cutting)
    assert log.speed_mps.min() > 6.4
