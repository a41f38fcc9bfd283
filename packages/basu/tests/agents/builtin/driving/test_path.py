"""Claims about the path and the place on it."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from basu.agents.builtin.driving.path import SMOOTHING_M, SPACING_M, SampledPath, make_path
from driving_plant import bends, line


def path_of(points_m: NDArray[np.float64]) -> SampledPath:
    s_m = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points_m[:, :2], axis=0).T))])
    return make_path(points_m, s_m)


def test_a_straight_street_stays_as_it_is() -> None:
    path = path_of(line(40.0))
    assert path.points_m[:, 0] == pytest.approx(np.arange(0.0, 40.0 + SPACING_M / 2, SPACING_M))
    assert np.abs(path.curvature_1pm).max() < 1e-9


def test_a_bend_is_cut_by_no_more_than_the_smoothing_says() -> None:
    radius_m = 6.0
    path = path_of(bends((radius_m * math.tau * 0.6, 1 / radius_m)))
    from_centre_m = np.hypot(path.points_m[:, 0], path.points_m[:, 1] - radius_m)
    assert from_centre_m.max() <= radius_m + 0.01
    assert from_centre_m.min() >= radius_m - SMOOTHING_M**2 / (12 * radius_m) - 0.03  # the way points' chords besides
    middle = np.array(path.curvature_1pm[10:-10])
    assert middle == pytest.approx(1 / radius_m, rel=0.05)


@given(s_m=st.floats(0.0, 95.0), right_m=st.floats(-1.5, 1.5))
def test_a_point_beside_the_path_is_found_where_it_was_put(s_m: float, right_m: float) -> None:
    path = path_of(bends((30.0, 0.0), (20.0, 1 / 12), (46.0, -1 / 30)))
    index = path.index_at(s_m)
    along_m = s_m - path.s_m[index]
    heading_rad = path.heading_rad[index] + path.curvature_1pm[index] * along_m
    x_m = path.x_m[index] + along_m * math.cos(heading_rad) - right_m * math.sin(heading_rad)
    y_m = path.y_m[index] + along_m * math.sin(heading_rad) + right_m * math.cos(heading_rad)
    place = path.follow(x_m, y_m, max(index - 6, 0))
    assert place.s_m == pytest.approx(s_m, abs=0.1)
    assert place.lateral_m == pytest.approx(right_m, abs=0.03)


def test_a_closed_loop_begins_at_its_beginning() -> None:
    path = path_of(bends((80.0, math.tau / 80.0)))
    assert path.find(0.3, 0.0, 0.0).s_m < 1.0


def test_the_other_side_of_a_street_driven_both_ways_is_known_by_the_heading() -> None:
    path = path_of(bends((60.0, 0.0), (4.0 * math.pi, 0.25), (60.0, 0.0)))
    there, back = path.find(30.0, 4.0, 0.0), path.find(30.0, 4.0, math.pi)
    assert there.s_m == pytest.approx(30.0, abs=0.6)
    assert back.s_m == pytest.approx(60.0 + 4.0 * math.pi + 30.0, abs=0.8)


def test_a_vehicle_put_elsewhere_is_found_again() -> None:
    path = path_of(line(200.0))
    assert path.track(150.0, 7.0, 0.0, 20).s_m == pytest.approx(157.0 - 7.0, abs=0.3)


def test_the_inside_of_a_tight_bend_does_not_trap_the_search() -> None:
    path = path_of(bends((12.0, 1 / 4)))
    assert 0.0 <= path.follow(0.0, 4.0, 2).s_m <= path.end_s_m  # the centre, from which every point is as far
