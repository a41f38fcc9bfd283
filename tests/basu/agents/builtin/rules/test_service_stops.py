"""Claims about halting for passengers."""

import numpy as np
import pytest

from basu.agents.builtin.rules.service_stops import DWELL_S, Phase, ServiceStop
from basu.agents.builtin.scene import Ego
from basu.metrics.arrival import SERVED_M, serves
from driving_plant import Plant, drive, line, make_driver, make_route


def ego(time_s: float, speed_mps: float) -> Ego:
    return Ego(time_s, 0.0, 0.0, 0.0, speed_mps)


def test_it_dwells_and_then_leaves_once_and_for_all() -> None:
    stop = ServiceStop(50.0, "S1")
    assert stop.step(ego(0.0, 5.0), 30.0) is not None
    assert stop.step(ego(9.0, 0.0), 49.9) is not None
    assert stop.phase is Phase.DWELLING
    assert stop.step(ego(9.0 + DWELL_S - 0.1, 0.0), 49.9) is not None
    assert stop.step(ego(9.0 + DWELL_S, 0.0), 49.9) is None
    assert stop.step(ego(30.0, 0.0), 49.9) is None


def test_standing_in_a_queue_before_the_stop_is_not_halting_at_it() -> None:
    stop = ServiceStop(50.0, "S1")
    assert all(stop.step(ego(float(t), 0.0), 45.0) is not None for t in range(30))
    assert stop.phase is Phase.APPROACHING


@pytest.mark.parametrize("left_m", [SERVED_M - 0.1, -SERVED_M + 0.1])
def test_what_the_metric_counts_as_served_is_served_for_the_driver(left_m: float) -> None:
    stop = ServiceStop(50.0, "S1")
    assert serves(left_m, 0.0)
    stop.step(ego(0.0, 0.0), 50.0 - left_m)
    assert stop.phase is Phase.DWELLING
    assert not serves(SERVED_M + 0.1, 0.0)


def test_driven_the_door_halts_at_the_stop_and_nothing_is_rougher_than_comfort() -> None:
    log = drive(make_driver(make_route(line(160.0), stops_at_s_m=[80.0])), Plant(0.0, 0.0, 0.0), 60.0)
    halted = (log.speed_mps < 0.02) & (log.s_m > 70.0) & (log.s_m < 90.0)
    assert np.abs(log.s_m[halted] - 80.0).max() < 0.3
    assert DWELL_S <= halted.sum() * 0.05 <= DWELL_S + 1.0
    assert np.abs(log.accel_mps2).max() <= 1.0
    assert np.percentile(np.abs(log.jerk_mps3), 99) <= 1.2
