"""Claims about the shape of a way round."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from basu.agents.builtin.driving.manner import NORMAL
from basu.agents.builtin.driving.path import SPACING_M, SampledPath, make_path
from basu.agents.builtin.passing.detour import TIGHTEST_1PM, Extent, make_detour, swing_m, tightest_swing_m
from driving_plant import SHUTTLE_BODY, bends, line

EXTENT = Extent(40.0, 56.0, 70.0, 86.0)


def path_of(points_m: np.ndarray) -> SampledPath:
    steps = np.hypot(*np.diff(points_m[:, :2], axis=0).T)
    return make_path(points_m, np.concatenate([[0.0], np.cumsum(steps)]), np.full(len(points_m), 3.2), SHUTTLE_BODY)


STRAIGHT = path_of(line(140.0))
BEND = path_of(bends((30.0, 0.0), (80.0, 1 / 60), (30.0, 0.0)))


def beside_m(path: SampledPath, s_m: float) -> float:
    return float(path.points_m[path.index_at(s_m), 1])


def test_it_is_aside_where_it_should_be_and_in_the_lane_elsewhere() -> None:
    path = make_detour(STRAIGHT, EXTENT, -2.7, NORMAL, 4.5).path
    assert [beside_m(path, s) for s in (10.0, 39.0, 60.0, 70.0, 87.0, 120.0)] == pytest.approx(
        [0.0, 0.0, -2.7, -2.7, 0.0, 0.0], abs=1e-9
    )
    assert beside_m(path, 48.0) == pytest.approx(-1.35, abs=1e-9)  # half the way, half the offset


@pytest.mark.parametrize("lane", [STRAIGHT, BEND])
@pytest.mark.parametrize("offset_m", [-2.7, 3.0])
def test_headings_and_curvature_are_those_of_its_points(lane: SampledPath, offset_m: float) -> None:
    path = make_detour(lane, EXTENT, offset_m, NORMAL, 4.5).path
    dx_m, dy_m = np.gradient(path.points_m[:, 0]), np.gradient(path.points_m[:, 1])
    heading_rad = np.unwrap(np.arctan2(dy_m, dx_m))
    inner = slice(4, -4)
    assert np.asarray(path.heading_rad)[inner] == pytest.approx(heading_rad[inner], abs=0.02)
    bend_1pm = np.gradient(heading_rad) / np.hypot(dx_m, dy_m)
    assert np.asarray(path.curvature_1pm)[inner] == pytest.approx(bend_1pm[inner], abs=0.03)


def test_outside_of_its_extent_it_is_the_lane_itself() -> None:
    path = make_detour(BEND, EXTENT, -2.7, NORMAL, 4.5).path
    first, end = path.index_at(EXTENT.from_s_m - 2.0), path.index_at(EXTENT.to_s_m + 2.0)
    assert path.s_m == BEND.s_m
    assert path.x_m[:first] == BEND.x_m[:first]
    assert path.curvature_1pm[end:] == BEND.curvature_1pm[end:]


@given(offset_m=st.floats(0.3, 4.0))
def test_the_tightest_swing_is_as_tight_as_a_vehicle_can_steer(offset_m: float) -> None:
    length_m = tightest_swing_m(offset_m)
    extent = Extent(30.0, 30.0 + length_m, 80.0, 80.0 + length_m)
    bend_1pm = np.abs(make_detour(STRAIGHT, extent, -offset_m, NORMAL, 4.5).path.curvature_1pm).max()
    assert bend_1pm < 1.15 * TIGHTEST_1PM


@given(offset_m=st.floats(1.0, 3.5), speed_mps=st.floats(3.0, 6.0))
def test_at_its_speed_it_pushes_sideways_no_more_than_the_manner_allows(offset_m: float, speed_mps: float) -> None:
    length_m = swing_m(offset_m, speed_mps, NORMAL.lateral_accel_mps2)
    extent = Extent(25.0, 25.0 + length_m, 80.0, 80.0 + length_m)
    detour = make_detour(STRAIGHT, extent, -offset_m, NORMAL, speed_mps)
    push_mps2 = detour.speed_mps**2 * np.abs(detour.path.curvature_1pm).max()
    assert push_mps2 <= NORMAL.lateral_accel_mps2 + 0.01
    assert detour.speed_mps > 0.6 * speed_mps


def test_it_may_begin_beside_the_lane() -> None:
    path = make_detour(STRAIGHT, EXTENT, -2.7, NORMAL, 4.5, begin_m=-1.0).path
    assert beside_m(path, 40.0) == pytest.approx(-1.0, abs=0.01)
    assert beside_m(path, 60.0) == pytest.approx(-2.7)
    assert math.isclose(path.s_m[1] - path.s_m[0], SPACING_M)
