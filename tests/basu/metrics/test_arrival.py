"""Claims about arrival and served stops: one definition, which run, criteria, passengers and result share."""

import numpy as np
import pytest

from basu.metrics.arrival import arrival_tick, arrivals, completion, has_arrived, serving
from basu.metrics.passengers.service import service
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


def test_the_record_tells_what_the_run_told_frame_by_frame() -> None:
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
