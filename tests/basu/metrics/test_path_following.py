"""Claims about path following: two arc lengths, and what a run that ends early may count."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from basu.metrics.path_following import arc_length_m, path_following
from fakes.drives import at, driven


def test_driving_the_plan_scores_one() -> None:
    found = path_following(driven(at(10.0, 20.1)))
    assert found.planned_m == pytest.approx(200.0)
    assert found.score == 1.0


def test_half_the_way_scores_a_half() -> None:
    assert path_following(driven([*at(10.0, 10.0), 0.0])).score == pytest.approx(0.5)


def test_a_run_that_never_moved_scores_nothing() -> None:
    assert path_following(driven(at(0.0, 10.0))).score == 0.0


def test_driving_in_circles_does_not_count_as_getting_ahead() -> None:
    history = driven(at(5.0, 10.0))
    angle = np.linspace(0.0, 40.0 * np.pi, len(history.frames))
    history.frames["x_m"], history.frames["y_m"] = 10.0 * np.cos(angle), 10.0 * np.sin(angle)
    history.frames["route_s_m"] = 20.0
    assert path_following(history).driven_m == pytest.approx(20.0)


def test_a_long_way_round_to_the_end_is_no_more_than_one() -> None:
    history = driven(at(10.0, 20.1))
    history.frames["y_m"] = 10.0 * np.sin(history.frames["x_m"] / 10.0)
    assert path_following(history).driven_m > 200.0
    assert path_following(history).score == 1.0


def test_jitter_at_a_standstill_adds_no_length() -> None:
    rng = np.random.default_rng(5)
    assert arc_length_m(rng.normal(0.0, 0.02, (2000, 2))) < 0.25


@given(st.integers(50, 400), st.floats(5.0, 80.0))
def test_a_circle_has_its_textbook_length(points: int, radius_m: float) -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, points)
    length_m = arc_length_m(radius_m * np.column_stack([np.cos(angle), np.sin(angle)]))
    assert length_m == pytest.approx(2.0 * np.pi * radius_m, rel=0.01)


@given(st.lists(st.tuples(st.floats(-50, 50), st.floats(-50, 50)), min_size=1, max_size=30))
def test_no_path_is_shorter_than_its_straight_line(points: list[tuple[float, float]]) -> None:
    path = np.array(points)
    assert arc_length_m(path) >= np.hypot(*(path[-1] - path[0])) - 1e-9
