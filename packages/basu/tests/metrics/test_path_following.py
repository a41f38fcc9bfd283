"""Tests of ``basu.metrics.path_following``."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from basu.metrics.passengers.service import service
from basu.metrics.path_following import (
    arc_length_m,
    arrival_tick,
    arrivals,
    completion,
    has_arrived,
    path_following,
    serving,
)
from basu.metrics.result import judge
from basu.outcome import Outcome, Status
from basu.routing import Stop
from fakes.drives import at, driven, ramp, straight_route


@pytest.mark.parametrize(
    ("left_m", "speed_mps", "there"),
    [(0.9, 8.0, True), (1.1, 8.0, False), (4.9, 0.05, True), (4.9, 0.15, False), (5.1, 0.0, False)],
)
def test_at_the_end_or_at_rest_just_before_it(left_m: float, speed_mps: float, *, there: bool) -> None:
    assert has_arrived(left_m, speed_mps) is there


def test_the_record_tells_what_the_run_reported_frame_by_frame() -> None:
    history = driven([*at(8.0, 11.7), *ramp(8.0, 0.0, 1.0), *at(0.0, 1.0)], route=straight_route(100.0))
    told = [has_arrived(100.0 - float(frame["route_s_m"]), float(frame["velocity_x_mps"])) for frame in history.frames]
    assert arrivals(history).tolist() == told
    assert arrival_tick(history) == int(np.argmax(told))
    assert completion(history) == 1.0


def test_a_drive_that_did_not_arrive_has_its_share_of_the_route() -> None:
    history = driven(at(5.0, 10.0), route=straight_route(100.0))
    assert arrival_tick(history) is None
    assert completion(history) == pytest.approx(0.5, abs=0.01)


@pytest.mark.parametrize("off_m", [-3.5, -2.5, 0.0, 2.5, 3.5])
def test_result_and_passengers_have_one_answer_to_whether_a_stop_was_served(off_m: float) -> None:
    stop = Stop(id="A", name="A", s_m=50.0 + off_m, x_m=50.0 + off_m, y_m=0.0, z_m=0.0, yaw_rad=0.0)
    history = driven([*at(10.0, 5.0), *at(0.0, 5.0), *at(10.0, 14.0)], route=straight_route(stops=(stop,)))
    result = judge(Outcome(Status.COMPLETED, "arrived"), history)
    served = abs(off_m) <= 3.0
    assert serving(history, stop.s_m).any() == served
    assert result.metrics["stops"][0]["served"] == service(history)[0].served == served


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
    found = path_following(history)
    assert found.score == pytest.approx(0.1)
    assert found.driven_m == pytest.approx(400.0 * np.pi, rel=0.02)


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
