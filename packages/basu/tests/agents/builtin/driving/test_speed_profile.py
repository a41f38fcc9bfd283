"""Claims about the speeds along a path."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from basu.agents.builtin.driving.manner import BASIC
from basu.agents.builtin.driving.path import SPACING_M, SampledPath, make_path
from basu.agents.builtin.driving.speed_profile import (
    BRAKING_MPS2,
    LATERAL_ACCEL_MPS2,
    SAVED_MPS,
    SLOWEST_MPS,
    STEP_MPS,
    SpeedProfile,
    bend_limit_mps,
    make_profile,
)
from driving_plant import bends

PIECES = st.lists(st.tuples(st.floats(5.0, 40.0), st.floats(-0.16, 0.16)), min_size=1, max_size=5)


def laid_out(pieces: list[tuple[float, float]], posted_mps: float, cap_mps: float) -> tuple[SampledPath, SpeedProfile]:
    points_m = bends(*pieces)
    s_m = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points_m[:, :2], axis=0).T))])
    path = make_path(points_m, s_m)
    return path, make_profile(path, np.full(len(path.s_m), posted_mps), cap_mps, SPACING_M)


def reachable_mps(limit_mps: NDArray[np.float64], spacing_m: float, braking_mps2: float) -> NDArray[np.float64]:
    """The backward pass: ``limit_mps`` lowered so that braking never exceeds ``braking_mps2`` (v² = v₁² + 2 a d)."""
    speeds = np.array(limit_mps, dtype=np.float64)
    for i in range(len(speeds) - 2, -1, -1):
        speeds[i] = min(speeds[i], (speeds[i + 1] ** 2 + 2.0 * braking_mps2 * spacing_m) ** 0.5)
    return speeds


@given(pieces=PIECES, posted_mps=st.floats(3.0, 16.0), cap_mps=st.floats(2.0, 20.0))
def test_no_speed_is_above_a_limit(pieces: list[tuple[float, float]], posted_mps: float, cap_mps: float) -> None:
    path, profile = laid_out(pieces, posted_mps, cap_mps)
    speeds = np.array(profile.limit_mps)
    assert (speeds <= max(min(posted_mps + BASIC.above_limit_mps, cap_mps), SLOWEST_MPS) + 1e-9).all()
    sideways = speeds**2 * np.abs(path.curvature_1pm)
    assert sideways[speeds > SLOWEST_MPS].max(initial=0.0) <= LATERAL_ACCEL_MPS2 + 1e-9


@given(pieces=PIECES)
def test_a_driver_that_keeps_to_the_slowdowns_keeps_to_every_limit(
    pieces: list[tuple[float, float]],
) -> None:
    path, profile = laid_out(pieces, 11.0, 9.0)
    reachable = reachable_mps(np.array(profile.limit_mps), SPACING_M, BRAKING_MPS2)
    for i, s_m in enumerate(path.s_m):
        ahead = profile.slowdowns(s_m, 1e9)
        implied = min([(v * v + 2 * BRAKING_MPS2 * d) ** 0.5 for d, v in ahead], default=np.inf)
        assert min(implied, profile.limit_mps[i]) <= reachable[i] + SAVED_MPS + 1e-6


@given(limit=st.lists(st.floats(1.0, 15.0), min_size=2, max_size=60).map(np.array))
def test_the_backward_pass_bounds_braking_and_raises_nothing(limit: NDArray[np.float64]) -> None:
    speeds = reachable_mps(limit, SPACING_M, 0.8)
    assert (speeds <= limit).all()
    assert (speeds[:-1] ** 2 - speeds[1:] ** 2 <= 2 * 0.8 * SPACING_M + 1e-9).all()
    assert speeds.min() == limit.min()


def test_a_steady_bend_is_driven_at_the_speed_of_the_lateral_limit() -> None:
    speeds = bend_limit_mps(np.full(50, 1 / 8), SPACING_M)
    assert speeds == pytest.approx(np.sqrt(LATERAL_ACCEL_MPS2 * 8), abs=STEP_MPS)
    assert speeds.max() <= np.sqrt(LATERAL_ACCEL_MPS2 * 8)


def test_an_unposted_street_is_driven_at_the_cap() -> None:
    _, profile = laid_out([(50.0, 0.0)], float("nan"), 6.7)
    assert set(profile.limit_mps) == {6.7}
    assert profile.slowdowns(0.0, 100.0) == []


def test_one_bend_is_one_or_two_slowdowns_not_a_hundred() -> None:
    _, profile = laid_out([(60.0, 0.0), (12.0, 1 / 7), (60.0, 0.0)], 11.0, 6.7)
    assert 1 <= len(profile.slowdown_s_m) <= 4
    assert 55.0 < profile.slowdown_s_m[0] < 64.0
