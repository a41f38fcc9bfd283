"""Claims about stop signs: at rest, before the line, before crossing it."""

from dataclasses import replace

import pytest

from basu.metrics.stop_signs import signs_passed, stop_signs
from basu.records.history import History
from basu.thresholds import AT_REST_MPS
from fakes.drives import at, driven, ramp, stop_sign, straight_route

FRONT_M = 2.0


def approach(rest_with_front_at_m: float, lowest_mps: float = 0.0, lateral_m: float = 0.0) -> History:
    """Drive up to a line at 50 m, slow down to ``lowest_mps`` with the bumper at a place, hold 2 s, go on."""
    slowing = ramp(5.0, lowest_mps, 3.0)
    start_m = rest_with_front_at_m - FRONT_M - sum(slowing) * 0.05
    speeds_mps = [*slowing, *at(lowest_mps, 2.0), *ramp(lowest_mps, 6.0, 3.0), *at(6.0, 8.0)]
    route = straight_route(controls=(stop_sign(50.0),))
    return driven(speeds_mps, route=route, start_m=start_m, lateral_m=lateral_m)


@pytest.mark.parametrize("front_m", [47.2, 48.0, 49.5, 50.5])
def test_a_halt_shortly_before_the_line_is_a_stop(front_m: float) -> None:
    (passed,) = signs_passed(approach(front_m))
    assert passed.stopped
    assert passed.lowest_speed_mps == pytest.approx(0.0, abs=1e-9)
    assert passed.front_to_line_m == pytest.approx(50.0 - front_m, abs=1e-6)
    assert stop_signs(approach(front_m)) == ()


@pytest.mark.parametrize("off_m", [-4.0, 4.0])
@pytest.mark.parametrize("front_m", [48.5, 49.35, 50.0])
def test_a_line_that_is_four_metres_from_its_place_is_noticed(front_m: float, off_m: float) -> None:
    """BASU's own drivers stop 0.65 m before a line."""
    history = approach(front_m)
    assert stop_signs(history) == ()
    shifted = replace(history.facts.route, controls=(stop_sign(50.0 + off_m),))
    assert len(stop_signs(replace(history, facts=replace(history.facts, route=shifted)))) == 1


def test_a_halt_in_the_queue_ten_metres_before_is_none() -> None:
    (found,) = stop_signs(approach(40.0))
    assert "crossed the line of stop sign 7 at" in found.detail


def test_a_halt_after_the_line_is_none() -> None:
    assert len(stop_signs(approach(51.5))) == 1


def test_rolling_through_is_an_infraction_that_tells_the_lowest_speed() -> None:
    (found,) = stop_signs(approach(49.0, lowest_mps=0.4))
    assert "the lowest speed before it was 0.40 m/s" in found.detail
    assert found.other == "stop sign 7"


def test_slower_than_the_threshold_is_at_rest() -> None:
    assert stop_signs(approach(49.0, lowest_mps=AT_REST_MPS * 0.9)) == ()


def test_a_sign_that_was_not_reached_is_not_judged() -> None:
    route = straight_route(controls=(stop_sign(50.0), stop_sign(150.0)))
    assert signs_passed(driven(at(5.0, 5.0), route=route)) == ()


@pytest.mark.parametrize("lateral_m", [-3.5, 6.0])
def test_a_line_is_passed_wherever_the_vehicle_goes_round_it_and_a_stop_beside_the_route_is_none(
    lateral_m: float,
) -> None:
    history = approach(49.0, lateral_m=lateral_m)
    history.frames["lane_id"] = 1
    (passed,) = signs_passed(history)
    assert not passed.stopped


def test_the_sign_is_judged_in_the_frame_in_which_the_middle_crosses_the_line() -> None:
    route = straight_route(controls=(stop_sign(50.0),))
    (passed,) = signs_passed(driven(at(10.0, 8.0), route=route))
    assert passed.tick == 101
    assert passed.speed_mps == pytest.approx(10.0)
