"""Tests of ``basu.agents.builtin.rules.stopping_lines``."""

import numpy as np
import pytest

from basu.agents.builtin.rules.stopping_lines import DWELL_S, LOOK_M, Light, ServicePhase, ServiceStop, TrafficLight
from basu.agents.builtin.scene import DrivenVehicle
from basu.metrics.path_following import SERVED_M, serves
from basu.routing import ControlKind
from driving_plant import SHUTTLE_BODY, Plant, drive, line, make_driver, make_route


def ego(time_s: float, speed_mps: float) -> DrivenVehicle:
    return DrivenVehicle(time_s, 0.0, 0.0, 0.0, speed_mps)


def test_it_dwells_and_then_leaves_once_and_for_all() -> None:
    stop = ServiceStop(50.0, "S1")
    assert stop.step(ego(0.0, 5.0), 30.0) is not None
    assert stop.step(ego(9.0, 0.0), 49.9) is not None
    assert stop.phase is ServicePhase.DWELLING
    assert stop.step(ego(9.0 + DWELL_S - 0.1, 0.0), 49.9) is not None
    assert stop.step(ego(9.0 + DWELL_S, 0.0), 49.9) is None
    assert stop.step(ego(30.0, 0.0), 49.9) is None


def test_standing_in_a_queue_before_the_stop_is_not_halting_at_it() -> None:
    stop = ServiceStop(50.0, "S1")
    assert all(stop.step(ego(float(t), 0.0), 45.0) is not None for t in range(30))
    assert stop.phase is ServicePhase.APPROACHING


@pytest.mark.parametrize("left_m", [SERVED_M - 0.1, -SERVED_M + 0.1])
def test_what_the_metric_counts_as_served_is_served_for_the_driver(left_m: float) -> None:
    stop = ServiceStop(50.0, "S1")
    assert serves(left_m, 0.0)
    stop.step(ego(0.0, 0.0), 50.0 - left_m)
    assert stop.phase is ServicePhase.DWELLING
    assert not serves(SERVED_M + 0.1, 0.0)


def test_driven_the_door_halts_at_the_stop_and_nothing_is_rougher_than_comfort() -> None:
    log = drive(make_driver(make_route(line(160.0), stops_at_s_m=[80.0])), Plant(0.0, 0.0, 0.0), 60.0)
    halted = (log.speed_mps < 0.02) & (log.s_m > 70.0) & (log.s_m < 90.0)
    assert np.abs(log.s_m[halted] - 80.0).max() < 0.3
    assert DWELL_S <= halted.sum() * 0.05 <= DWELL_S + 1.0
    assert np.abs(log.accel_mps2).max() <= 1.0
    assert np.percentile(np.abs(log.jerk_mps3), 99) <= 1.2


LINE_S_M = 100.0


@pytest.mark.parametrize(
    ("shows", "front_s_m", "speed_mps", "asks"),
    [
        pytest.param(Light.GREEN, 80.0, 6.0, False, id="green"),
        pytest.param(Light.DARK, 80.0, 6.0, False, id="dark"),
        pytest.param(Light.RED, 80.0, 6.0, True, id="red"),
        pytest.param(Light.RED, 98.0, 6.0, True, id="red, however near"),
        pytest.param(Light.RED, LINE_S_M - LOOK_M - 1.0, 6.0, False, id="too far to matter"),
        pytest.param(Light.RED, 100.5, 6.0, False, id="passed"),
        pytest.param(Light.YELLOW, 75.0, 6.0, True, id="yellow with room to stop"),
        pytest.param(Light.YELLOW, 95.0, 6.0, False, id="yellow too near"),
    ],
)
def test_what_a_light_asks_for(shows: Light, front_s_m: float, speed_mps: float, asks: bool) -> None:  # noqa: FBT001
    assert (TrafficLight(LINE_S_M, "1").step(shows, front_s_m, speed_mps) is not None) == asks


def test_an_actor_that_drives_through_yellow_is_not_stopped_by_the_red_that_follows() -> None:
    light = TrafficLight(LINE_S_M, "1")
    assert light.step(Light.YELLOW, 94.0, 6.0) is None
    assert light.step(Light.RED, 97.0, 6.0) is None


def test_an_actor_that_has_begun_to_stop_at_yellow_goes_on_stopping() -> None:
    light = TrafficLight(LINE_S_M, "1")
    assert light.step(Light.YELLOW, 80.0, 6.0) is not None
    assert light.step(Light.YELLOW, 92.0, 3.5) is not None
    assert light.step(Light.RED, 97.0, 1.0) is not None


def test_driven_it_waits_at_red_before_the_line_and_goes_at_green() -> None:
    route = make_route(line(200.0), controls=[(ControlKind.TRAFFIC_LIGHT, LINE_S_M)])
    log = drive(make_driver(route), Plant(0.0, 0.0, 0.0), 55.0, shows=lambda t: Light.RED if t < 35.0 else Light.GREEN)
    gap_m = LINE_S_M - (log.s_m[log.time_s < 35.0].max() + SHUTTLE_BODY.front_m)
    assert 0.3 <= gap_m <= 1.5
    assert log.s_m[-1] > 150.0
    assert np.abs(log.accel_mps2).max() <= 1.0
