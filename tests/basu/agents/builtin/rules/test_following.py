"""Claims about keeping the distance to a leader: the model's own formulas, and that nothing a leader does is fatal."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from basu.agents.builtin.driving.comfort import slowing_distance_m
from basu.agents.builtin.driving.manner import AGGRESSIVE, CAUTIOUS, NORMAL, Following, Manner
from basu.agents.builtin.driving.planner import RESERVE, Planner
from basu.agents.builtin.rules.following import CLOSEST_M, LEADER_LIMIT_MPS2, floor, follow_mps2
from basu.agents.builtin.scene import Kind, Other
from driving_plant import DT_S, SHUTTLE_BODY, Plant, body_at, drive, line, make_behavioral, make_route

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
        return [body_at(Kind.VEHICLE, 25.0 + leads_mps * time_s, 0.0, velocity_mps=(leads_mps, 0.0))]

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
        return [body_at(Kind.VEHICLE, x_m, 0.0, velocity_mps=(speed_mps, 0.0))]

    driver = make_behavioral(make_route(line(400.0)), manner, left_width_m=0.0)
    log = drive(driver, Plant(0.0, 0.0, 0.0), 48.0, leader)
    gaps_m = [leader(t)[0].x_m - 2.2 - (x + SHUTTLE_BODY.front_m) for t, x in zip(log.time_s, log.x_m, strict=True)]
    assert min(gaps_m) > 1.0
    assert log.speed_mps[-1] == 0.0
    assert gaps_m[-1] < 6.0
    if brakes_mps2 <= 1.0:
        assert -log.accel_mps2.min() < 2.2  # an ordinary stop is an ordinary stop for who follows, too


@given(st.floats(0.0, 40.0), st.floats(0.0, 15.0))
def test_the_floor_is_where_the_leader_would_come_to_rest(gap_m: float, leads_mps: float) -> None:
    asked = floor(gap_m, leads_mps)
    assert asked.distance_m + CLOSEST_M - gap_m == pytest.approx(leads_mps**2 / (2.0 * LEADER_LIMIT_MPS2), abs=1e-9)
    assert math.isclose(asked.speed_mps, 0.0)
