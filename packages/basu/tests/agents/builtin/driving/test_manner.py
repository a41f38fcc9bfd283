"""Tests of ``basu.agents.builtin.driving.manner``."""

import math
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from basu.agents.builtin.driving.manner import (
    AGGRESSIVE,
    BASIC,
    CAUTIOUS,
    NORMAL,
    ComfortLimits,
    Manner,
    approach_accel_mps2,
    slowing_distance_m,
)
from basu.agents.builtin.driving.planner import FIRM, OVERSPEED_MPS
from basu.metrics.scoring import TOLERANCE_MPS

LIMITS = ComfortLimits(0.9, 0.8)


def driven_m(speed_mps: float, accel_mps2: float, target_mps: float, limits: ComfortLimits) -> float:
    """The obvious way: at each tiny step brake deeper while there is time to release again, else release."""
    dt_s, way_m, v, a = 0.0005, 0.0, speed_mps, accel_mps2
    deepest = max(limits.accel_mps2, -accel_mps2)
    while v > target_mps + 1e-5 or a > 0.0:
        if a < 0.0 and v - target_mps <= a * a / (2.0 * limits.jerk_mps3):
            a = min(a + limits.jerk_mps3 * dt_s, -1e-3)
        else:
            a = max(a - limits.jerk_mps3 * dt_s, -deepest)
        v += a * dt_s
        way_m += v * dt_s
    return way_m


@given(speed_mps=st.floats(0.5, 15.0), accel_mps2=st.floats(-0.9, 0.9), target_mps=st.floats(0.0, 14.0))
def test_the_distance_is_that_of_the_manoeuvre_driven(speed_mps: float, accel_mps2: float, target_mps: float) -> None:
    if speed_mps + max(accel_mps2, 0.0) ** 2 / (2 * LIMITS.jerk_mps3) <= target_mps:
        assert slowing_distance_m(speed_mps, accel_mps2, target_mps, LIMITS) == pytest.approx(0.0, abs=1e-6)
        return
    if speed_mps < target_mps:
        return  # already slower, and only the acceleration has to be let go: not a slowing
    expected_m = driven_m(speed_mps, accel_mps2, target_mps, LIMITS)
    off_m = abs(slowing_distance_m(speed_mps, accel_mps2, target_mps, LIMITS) - expected_m)
    assert off_m <= 0.02 + 0.03 * speed_mps + 0.005 * expected_m  # the small steps end up to 0.03 s early


def test_a_long_stop_takes_the_textbook_distance() -> None:
    # v²/2a plus v a/2j for building the deceleration up and letting it go
    assert slowing_distance_m(10.0, 0.0, 0.0, LIMITS) == pytest.approx(100 / 1.8 + 10 * 0.9 / (2 * 0.8))


@given(speed_mps=st.floats(0.1, 15.0), accel_mps2=st.floats(-0.9, 0.85), more=st.floats(0.0, 0.05))
def test_more_acceleration_now_never_shortens_the_way(speed_mps: float, accel_mps2: float, more: float) -> None:
    less_m = slowing_distance_m(speed_mps, accel_mps2, 0.0, LIMITS)
    assert slowing_distance_m(speed_mps + 0.05 * more, accel_mps2 + more, 0.0, LIMITS) >= less_m - 1e-9


@given(excess_mps=st.floats(-12.0, 12.0))
def test_a_speed_is_approached_from_both_sides_alike_and_within_the_limits(excess_mps: float) -> None:
    accel = approach_accel_mps2(excess_mps, LIMITS)
    assert abs(accel) <= LIMITS.accel_mps2
    assert accel == -approach_accel_mps2(-excess_mps, LIMITS)
    assert math.copysign(1.0, accel) == math.copysign(1.0, excess_mps)


def test_nearing_a_speed_never_exceeds_the_jerk() -> None:
    v, a, dt_s, hardest = 0.0, LIMITS.accel_mps2, 0.001, 0.0
    for _ in range(20_000):
        wanted = approach_accel_mps2(6.0 - v, LIMITS)
        hardest = max(hardest, abs(wanted - a) / dt_s)
        a = wanted
        v += a * dt_s
    assert v == pytest.approx(6.0, abs=1e-3)
    assert hardest <= LIMITS.jerk_mps3 * 1.01


BOLDNESS: list[Callable[[Manner], float]] = [
    lambda m: m.comfort.accel_mps2,
    lambda m: m.lateral_accel_mps2,
    lambda m: m.above_limit_mps,
    lambda m: -m.following.headway_s,  # type: ignore[union-attr]
    lambda m: -m.gaps.factor,  # type: ignore[union-attr]
    lambda m: -m.gaps.margin_s,  # type: ignore[union-attr]
    lambda m: -m.passing.patience_s,  # type: ignore[union-attr]
    lambda m: -m.passing.beside_m,  # type: ignore[union-attr]
]


@pytest.mark.parametrize("boldness", BOLDNESS)
def test_each_figure_is_ordered_as_the_names_are(boldness: Callable[[Manner], float]) -> None:
    assert boldness(CAUTIOUS) < boldness(NORMAL) < boldness(AGGRESSIVE)


@pytest.mark.parametrize("manner", [BASIC, CAUTIOUS, NORMAL, AGGRESSIVE])
def test_none_drives_what_is_counted_as_speeding(manner: Manner) -> None:
    assert manner.above_limit_mps + OVERSPEED_MPS < TOLERANCE_MPS


@pytest.mark.parametrize("manner", [CAUTIOUS, NORMAL, AGGRESSIVE])
def test_comfort_is_milder_than_firm_braking_and_within_what_cruise_controls_may_do(manner: Manner) -> None:
    assert manner.comfort.accel_mps2 < FIRM.accel_mps2
    assert manner.comfort.jerk_mps3 < FIRM.jerk_mps3
    assert manner.following is not None
    assert manner.following.headway_s >= 0.8  # ISO 15622: the least time gap that may be set
