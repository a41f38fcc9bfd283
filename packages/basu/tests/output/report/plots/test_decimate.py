"""Claims about thinning out: no extreme is lost, no gap is closed, no path leaves its sleeve."""

import time

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from basu.output.report.plots.decimate import curve, path

VALUES = hnp.arrays(np.float64, st.integers(1, 3000), elements=st.floats(-100.0, 100.0))


@given(VALUES)
def test_the_extremes_and_the_ends_of_a_curve_are_kept(values: np.ndarray) -> None:
    (kept,) = curve(values, buckets=50)
    assert kept[0] == 0
    assert kept[-1] == len(values) - 1
    assert np.all(np.diff(kept) > 0)
    assert values[kept].max() == values.max()
    assert values[kept].min() == values.min()


def test_a_peak_of_one_tick_survives_in_a_long_run() -> None:
    values = np.zeros(22_000)
    values[12_345] = 9.0
    (kept,) = curve(values)
    assert 12_345 in kept
    assert len(kept) < 10  # a level line needs no more


def test_a_long_curve_is_drawn_with_few_points() -> None:
    values = np.random.default_rng(1).normal(size=100_000)
    (kept,) = curve(values, buckets=700)
    assert len(kept) <= 2 * 700 + 2


def test_stretches_without_a_value_stay_open() -> None:
    values = np.array([1.0, 2.0, np.nan, np.nan, 3.0, np.nan, 4.0])
    assert [stretch.tolist() for stretch in curve(values)] == [[0, 1], [4], [6]]


def test_a_curve_without_values_has_no_points() -> None:
    assert curve(np.full(5, np.nan)) == []


def distance(point: np.ndarray, line: list[tuple[float, float]]) -> float:
    """From a point to a polyline, the obvious way."""
    nearest = np.inf
    for begin, end in zip(np.array(line[:-1]), np.array(line[1:]), strict=True):
        along = end - begin
        length = float(along @ along)
        share = 0.0 if length == 0.0 else float(np.clip((point - begin) @ along / length, 0.0, 1.0))
        nearest = min(nearest, float(np.hypot(*(point - begin - share * along))))
    return nearest


@given(st.integers(0, 10_000), st.floats(0.05, 2.0))
def test_no_point_of_a_path_is_farther_off_than_the_tolerance(seed: int, tolerance_m: float) -> None:
    rng = np.random.default_rng(seed)
    points = np.cumsum(rng.normal(size=(60, 2)) * rng.choice([0.0, 0.05, 1.0], size=(60, 1)), axis=0)
    kept = path(points, tolerance_m)
    assert kept[0] == tuple(points[0])
    assert kept[-1] == tuple(points[-1])
    assert max(distance(point, kept) for point in points) <= tolerance_m + 1e-9


def test_a_straight_street_is_two_points() -> None:
    points = np.column_stack([np.linspace(0.0, 500.0, 1000), np.linspace(0.0, 80.0, 1000)])
    assert len(path(points, 0.1)) == 2


def test_there_and_back_again_is_not_nowhere() -> None:
    there = np.column_stack([np.linspace(0.0, 50.0, 100), np.zeros(100)])
    kept = path(np.concatenate([there, there[::-1]]), 0.1)
    assert max(x for x, _ in kept) > 49.0


def test_time_grows_with_the_number_of_points_and_no_faster() -> None:
    def seconds(count: int) -> float:
        angles = np.linspace(0.0, 40.0, count)
        points = np.column_stack([np.cos(angles), np.sin(angles)]) * 300.0
        began = time.process_time()
        path(points, 0.1)
        return time.process_time() - began

    seconds(2000)
    assert min(seconds(40_000) for _ in range(3)) < 40.0 * max(min(seconds(4000) for _ in range(3)), 1e-3)
