"""Claims about gamepads and wheels: files of axes and buttons, and readings as steering and pedals."""

from pathlib import Path

import pytest

from basu.errors import UserError
from basu_window.manual.inputs import Axes, Strike
from basu_window.manual.joystick import CARLAS_FILE, axes, layout_for

CARLAS = """[G29 Racing Wheel]
steering_wheel = 0
clutch = 2
throttle = 1
brake = 3
handbrake = 5
reverse = 4
"""
ALL = frozenset(range(6))


def test_a_gamepad_that_no_actor_knows_is_laid_out_as_an_xbox_controller(tmp_path: Path) -> None:
    layout = layout_for("Some Pad", tmp_path)
    assert axes(layout, [0.0, 0.0, -1.0, 0.0, 0.0, 1.0], ALL, [False] * 8) == Axes(0.0, 1.0, 0.0)
    assert axes(layout, [-1.0, 0.0, 1.0, 0.0, 0.0, -1.0], ALL, [True] + [False] * 7) == Axes(-1.0, 0.0, 1.0, True)
    assert (3, Strike.AUTOPILOT) in layout.strikes


def test_a_stick_is_fine_near_the_middle_and_dead_in_it(tmp_path: Path) -> None:
    layout = layout_for("Some Pad", tmp_path)
    steers = [axes(layout, [at, 0, -1, 0, 0, -1], ALL, []).steer for at in (0.05, 0.55, 1.0)]
    assert steers == [0.0, 0.25, 1.0]
    assert axes(layout, [-0.55, 0, -1, 0, 0, -1], ALL, []).steer == -0.25


def test_pedals_that_were_never_touched_are_not_half_pressed(tmp_path: Path) -> None:
    layout = layout_for("G29 Racing Wheel", tmp_path)
    assert axes(layout, [0.0] * 4, frozenset(), [False] * 12) == Axes(0.0, 0.0, 0.0)
    assert axes(layout, [0.0] * 4, frozenset({2}), [False] * 12) == Axes(0.0, 0.5, 0.0)


def test_a_wheel_steers_in_proportion_and_its_pedals_rest_at_one(tmp_path: Path) -> None:
    layout = layout_for("Logitech G29 Racing Wheel", tmp_path)
    assert axes(layout, [0.505, 1.0, -1.0, 1.0], ALL, []) == Axes(0.5, 1.0, 0.0)


def test_a_device_with_fewer_axes_and_buttons_than_the_file_says_rests(tmp_path: Path) -> None:
    assert axes(layout_for("Some Pad", tmp_path), [0.0, 0.0], ALL, []) == Axes(0.0, 0.0, 0.0)


def test_carlas_own_file_goes_first_and_holds_for_any_wheel(tmp_path: Path) -> None:
    (tmp_path / CARLAS_FILE).write_text(CARLAS)
    layout = layout_for("Thrustmaster T300", tmp_path)
    assert (layout.throttle_axis, layout.brake_axis, layout.hand_brake) == (1, 3, 5)
    assert layout.strikes == ((4, Strike.REVERSE),)
    assert layout.rest == 1.0


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (CARLAS.replace("brake = 3", "", 1), "lacks 'brake'; it needs steering_wheel, throttle and brake"),
        (CARLAS.replace("throttle = 1", "throttle = one"), "holds what is no number"),
        (CARLAS + "rest = 0.5\n", "rest is 1 or -1"),
        ("steering_wheel = 0", "cannot be read"),
    ],
)
def test_a_file_with_a_mistake_gets_a_sentence(tmp_path: Path, text: str, sentence: str) -> None:
    (tmp_path / CARLAS_FILE).write_text(text)
    with pytest.raises(UserError, match=sentence):
        layout_for("Logitech G29", tmp_path)
