"""Claims about the pedals."""

import pytest

from basu.agents.builtin.driving.longitudinal import HOLD_BRAKE, DriveModel, PedalControl

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
