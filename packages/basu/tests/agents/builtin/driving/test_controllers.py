"""Tests of ``basu.agents.builtin.driving.controllers``."""

import math

import numpy as np
import pytest

from basu.agents.builtin.driving.controllers import HOLD_BRAKE, DriveModel, PedalControl, steer_angle_rad
from basu.agents.builtin.driving.path import make_path
from basu.agents.builtin.scene import VehicleGeometry
from driving_plant import DT_S, SHUTTLE_BODY, Plant, bends, drive, line, make_driver, make_route


@pytest.mark.parametrize("radius_m", [6.0, 7.0, 8.0, 12.0])
@pytest.mark.parametrize("side", [1, -1])
def test_a_circle_is_held_within_a_hand(radius_m: float, side: int) -> None:
    route = make_route(bends((30.0, 0.0), (1.5 * math.pi * radius_m, side / radius_m), (20.0, 0.0)))
    log = drive(make_driver(route), Plant(0.0, 0.0, 0.0), 45.0)
    assert log.s_m[-1] > 30.0 + 1.5 * math.pi * radius_m
    assert np.abs(log.lateral_m).max() < 0.05  # of its path, which lies within 0.2 m of the lane's middle


def test_a_figure_of_eight_of_mini_roundabouts_is_driven() -> None:
    route = make_route(bends((45.0, 1 / 8), (45.0, -1 / 8), (45.0, 1 / 8)))
    log = drive(make_driver(route), Plant(0.0, 0.0, 0.0), 75.0)
    assert np.abs(log.lateral_m).max() < 0.05
    fine_m = np.column_stack(
        [np.interp(np.arange(0, route.length_m, 0.1), route.s_m, route.points_m[:, k]) for k in (0, 1)]
    )
    off_m = np.hypot(log.x_m[:, None] - fine_m[None, :, 0], log.y_m[:, None] - fine_m[None, :, 1]).min(axis=1)
    assert off_m.max() < 0.2


@pytest.mark.parametrize("offset_m", [-2.0, 1.0])
def test_from_beside_the_lane_it_comes_back_without_swinging_over(offset_m: float) -> None:
    log = drive(make_driver(make_route(line(150.0))), Plant(0.0, offset_m, 0.0, 4.0), 15.0)
    assert abs(log.lateral_m[-1]) < 0.01
    assert (log.lateral_m * math.copysign(1.0, offset_m)).min() > -0.02 * abs(offset_m)


def test_at_speed_the_wheel_is_turned_less_for_the_same_error() -> None:
    points_m = line(50.0)
    path = make_path(points_m, points_m[:, 0])
    place = path.find(20.0, 0.5, 0.0)
    slow, fast = (abs(steer_angle_rad(path, place, 0.05, v, SHUTTLE_BODY, DT_S)) for v in (2.0, 15.0))
    assert fast < 0.5 * slow


def test_on_a_steady_circle_the_angle_is_the_textbook_one() -> None:
    points_m = bends((60.0, 1 / 10))
    path = make_path(points_m, np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points_m[:, :2], axis=0).T))]))
    body = VehicleGeometry(wheelbase_m=2.8, rear_axle_m=1.4, front_m=2.0, rear_m=2.0, half_width_m=1.0)
    at = path.index_at(30.0)
    slip_rad = math.asin(1.4 * path.curvature_1pm[at])
    yaw_rad = path.heading_rad[at] - slip_rad  # the nose of a turning vehicle points outwards at its middle
    place = path.follow(path.x_m[at], path.y_m[at], at)
    angle_rad = steer_angle_rad(path, place, yaw_rad, 2.0, body, 0.0)
    rear_radius_m = math.sqrt(10.0**2 - 1.4**2)
    assert angle_rad == pytest.approx(math.atan(2.8 / rear_radius_m), rel=0.03)


MODEL = DriveModel((0.0, 5.0, 10.0), (2.0, 2.0, 1.0), 6.0)


def follow(pull: float, drag_mps2: float, seconds: float = 20.0) -> tuple[PedalControl, float, float]:
    """Accelerate at 0.5 m/s² up to 5 m/s a vehicle whose throttle does ``pull`` times what the model says."""
    control = PedalControl(MODEL, 0.05)
    speed, reference, worst = 0.0, 0.0, 0.0
    for _ in range(round(seconds / 0.05)):
        accel = 0.5 if reference < 5.0 else 0.0
        reference += accel * 0.05
        pedals = control.step(speed, reference, accel, holding=False)
        speed = max(
            0.0, speed + (pull * 2.0 * pedals.throttle - 6.0 * pedals.brake - (drag_mps2 if speed > 0 else 0)) * 0.05
        )
        worst = max(worst, abs(speed - reference))
    return control, speed, worst


@pytest.mark.parametrize("pull", [0.6, 1.0, 1.5])
@pytest.mark.parametrize("drag_mps2", [0.0, 0.4, -0.3])
def test_the_reference_is_followed_whatever_the_model_left_out(pull: float, drag_mps2: float) -> None:
    _, speed, worst = follow(pull, drag_mps2)
    assert speed == pytest.approx(5.0, abs=0.02)
    assert worst < 0.45


def test_an_exact_model_leaves_nothing_to_be_learnt() -> None:
    control, _, _ = follow(1.0, 0.0)
    assert control.disturbance_mps2 == pytest.approx(0.0, abs=0.01)


def test_drag_is_learnt() -> None:
    control, _, _ = follow(1.0, 0.4)
    assert control.disturbance_mps2 == pytest.approx(-0.4, abs=0.02)


def test_in_neutral_the_throttle_is_pressed_to_set_off_and_lifted_while_it_rolls() -> None:
    control = PedalControl(MODEL, 0.05)
    assert control.step(0.0, 0.05, 1.0, holding=False, gear=0).throttle > 0.0
    assert control.step(3.0, 3.05, 1.0, holding=False, gear=0).throttle == 0.0


def test_the_pedals_are_never_pressed_together_and_stay_in_range() -> None:
    control = PedalControl(MODEL, 0.05)
    for speed, accel in ((0.0, 9.0), (5.0, -20.0), (5.0, 0.2), (9.0, -0.1)):
        pedals = control.step(speed, speed + accel * 0.05, accel, holding=False)
        assert 0.0 <= pedals.throttle <= 1.0
        assert 0.0 <= pedals.brake <= 1.0
        assert 0.0 in pedals


def test_standing_the_brake_is_pressed_down_little_by_little_and_held() -> None:
    control = PedalControl(MODEL, 0.05)
    control.step(3.0, 3.0, 0.0, holding=False)
    brakes = [control.step(0.0, 0.0, 0.0, holding=True).brake for _ in range(40)]
    assert brakes[0] < 0.1
    assert brakes[-1] == HOLD_BRAKE
    assert sorted(brakes) == brakes


def test_the_throttle_gain_is_interpolated_between_speeds() -> None:
    assert MODEL.throttle_mps2(7.5) == pytest.approx(1.5)
    assert MODEL.throttle_mps2(50.0) == 1.0
