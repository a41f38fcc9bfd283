"""Claims about red lights: the rear decides, as in the leaderboard; what the front saw is reported beside it."""

import numpy as np
import pytest

from basu.metrics.red_lights import lights_passed, red_lights
from basu.records.history import History
from basu.records.history.model import NO_LIGHT
from fakes.drives import at, driven, straight_route, traffic_light

RED, YELLOW, GREEN = 0, 1, 2
LINE_M = 50.0


def past_the_light(
    turns_red_with_rear_at_m: float | None, *, speed_mps: float = 10.0, lateral_m: float = 0.0
) -> History:
    """At a steady speed over a line at 50 m; the light is yellow before it turns red, green where it never does.

    The vehicle reaches 2 m to either end of its origin.
    """
    route = straight_route(controls=(traffic_light(LINE_M),))
    history = driven(at(speed_mps, 10.0), route=route, lateral_m=lateral_m)
    frames = history.frames
    rear_m = frames["x_m"] - 2.0
    if turns_red_with_rear_at_m is None:
        frames["route_light"] = GREEN
    else:
        frames["route_light"] = np.where(rear_m >= turns_red_with_rear_at_m - 1e-6, RED, YELLOW)
    frames["route_light"][rear_m - 1.0 > LINE_M + 1e-6] = NO_LIGHT
    return history


def test_driving_through_on_red_is_run() -> None:
    (found,) = red_lights(past_the_light(0.0))
    assert found.other == "traffic light 12"
    assert found.speed_mps == pytest.approx(10.0)
    assert found.x_m == pytest.approx(52.0, abs=0.51)  # 0.8 of the half length is past the line
    assert "on red at 10.00 m/s; it was red when the front crossed" in found.detail


def test_on_green_it_is_passed_and_reported() -> None:
    history = past_the_light(None)
    (passed,) = lights_passed(history)
    assert not passed.run
    assert (passed.state, passed.front_state) == ("green", "green")
    assert red_lights(history) == ()


def test_red_before_the_tail_is_across_counts_though_the_front_crossed_on_yellow() -> None:
    (found,) = red_lights(past_the_light(49.0))
    assert "it was yellow when the front crossed" in found.detail


def test_red_once_the_tail_is_a_metre_beyond_the_line_is_no_concern_of_the_vehicles() -> None:
    assert len(red_lights(past_the_light(50.5))) == 1
    assert red_lights(past_the_light(51.2)) == ()


def test_an_actor_that_stops_with_the_front_beyond_the_line_has_not_run_it() -> None:
    route = straight_route(controls=(traffic_light(LINE_M),))
    history = driven([*at(10.0, 4.9), *at(0.0, 5.0)], route=route)
    history.frames["route_light"] = RED
    assert history.frames["x_m"][-1] == pytest.approx(49.0)  # its front 1 m beyond
    assert lights_passed(history) == ()


@pytest.mark.parametrize("lateral_m", [-3.5, 3.0])
def test_a_light_is_run_in_whichever_lane_of_the_approach(lateral_m: float) -> None:
    assert len(red_lights(past_the_light(0.0, lateral_m=lateral_m))) == 1


def test_a_zone_that_ends_at_a_line_of_the_route_is_no_second_light() -> None:
    history = past_the_light(0.0, lateral_m=-3.5)
    history.frames["traffic_light_state"] = np.where(history.frames["x_m"] <= LINE_M, RED, NO_LIGHT)
    assert len(red_lights(history)) == 1


def test_a_light_is_run_once_however_slowly() -> None:
    assert len(red_lights(past_the_light(0.0, speed_mps=5.2))) == 1


@pytest.mark.parametrize(
    ("lateral_m", "state", "forward_mps", "number"),
    [(8.0, RED, 5.0, 1), (8.0, GREEN, 5.0, 0), (8.0, RED, -5.0, 0), (0.0, RED, 5.0, 0)],
    ids=["on red", "on green", "backwards out of it", "on the plan, with known lights"],
)
def test_off_the_route_the_zone_of_a_light_is_what_counts(
    lateral_m: float, state: int, forward_mps: float, number: int
) -> None:
    history = driven(at(forward_mps, 6.0), lateral_m=lateral_m)
    history.frames["traffic_light_state"][40:80] = state
    found = red_lights(history)
    assert [event.tick for event in found] == [80] * number


def test_standing_in_a_lights_zone_at_the_end_of_the_run_is_nothing() -> None:
    history = driven(at(0.0, 6.0), lateral_m=8.0)
    history.frames["traffic_light_state"][40:] = RED
    assert red_lights(history) == ()
