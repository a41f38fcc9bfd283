"""Claims about keys, gamepads and wheels of a page as the input of a drive."""

import pytest

from basu_window.browser.page_input import PageInput
from basu_window.manual.inputs import Axes, Held, Input, Strike


def drive(page: int = 1, **values: object) -> dict[str, object]:
    return {"order": "drive", "page": page, "held": [], "strikes": [], "pad": None, **values}


def test_keys_are_held_until_the_page_says_otherwise() -> None:
    source = PageInput()
    source.take(drive(held=["throttle", "left"]))
    assert [source.read(tick).held for tick in (0, 1)] == [Held.THROTTLE | Held.LEFT] * 2
    source.take(drive())
    assert source.read(2) == Input()


def test_a_key_that_was_down_between_two_readings_counts_once() -> None:
    source = PageInput()
    source.take(drive(held=["brake"]))
    source.take(drive())
    assert [source.read(tick).held for tick in (0, 1)] == [Held.BRAKE, Held.NOTHING]


def test_strikes_count_once_and_in_their_order() -> None:
    source = PageInput()
    source.take(drive(strikes=["reverse"]))
    source.take(drive(strikes=["autopilot", "quit"]))
    assert source.read(0).strikes == (Strike.REVERSE, Strike.AUTOPILOT, Strike.QUIT)
    assert source.read(1).strikes == ()


def test_one_page_has_the_wheel_until_it_leaves() -> None:
    source = PageInput()
    source.take(drive(page=1, held=["throttle"]))
    source.take(drive(page=2, held=["brake"]))
    assert source.read(0).held is Held.THROTTLE
    source.take({"order": "left", "page": 1})
    assert source.read(1).held is Held.NOTHING
    source.take(drive(page=2, held=["brake"]))
    assert source.read(2).held is Held.BRAKE


def test_a_gamepad_steers_with_its_stick_and_drives_with_its_triggers() -> None:
    source = PageInput()
    buttons = [0.0] * 17
    buttons[7], buttons[6] = 0.5, 0.25
    source.take(drive(pad={"name": "Pad", "standard": True, "axes": [-1.0, 0, 0, 0], "buttons": buttons}))
    assert source.read(0).axes == Axes(-1.0, 0.5, 0.25)
    buttons[0] = buttons[3] = 1.0
    for _ in range(3):  # held down, the button is struck once
        source.take(drive(pad={"name": "Pad", "standard": True, "axes": [0.05, 0, 0, 0], "buttons": buttons}))
    assert source.read(1) == Input(axes=Axes(0.0, 0.5, 0.25, True), strikes=(Strike.AUTOPILOT,))


def test_a_wheel_is_laid_out_by_the_file_of_devices_and_a_pedal_is_at_rest_until_it_moves() -> None:
    source = PageInput()

    def pad(*axes: float) -> dict[str, object]:
        name = "Logitech G29 Driving Force Racing Wheel (Vendor: 046d Product: c24f)"
        return {"name": name, "standard": False, "axes": [*axes], "buttons": [0.0] * 24}

    source.take(drive(pad=pad(0.0, 0.0, 0.0, 0.0)))
    assert source.read(0).axes == Axes(0.0, 0.0, 0.0)
    moved = [pad(0.5, 0.0, -1.0, 0.0), pad(0.5, 0.0, -1.0, 0.0)]
    for each in moved:
        source.take(drive(pad=each))
    found = source.read(1).axes
    assert found is not None
    assert found.steer > 0.2
    assert (found.throttle, found.brake).count(1.0) == 1


@pytest.mark.parametrize(
    "values",
    [
        {"held": ["unknown", 5, None], "strikes": ["x", 3]},
        {"held": "throttle", "strikes": None},
        {"pad": {"standard": True, "axes": ["x", None], "buttons": {}}},
        {"pad": {"standard": True, "axes": [float("nan")] * 1000, "buttons": [1e9] * 1000}},
        {"pad": 5},
    ],
)
def test_what_cannot_be_read_leaves_the_vehicle_within_its_range(values: dict[str, object]) -> None:
    source = PageInput()
    source.take(drive(**values))
    done = source.read(0)
    assert done.held is Held.NOTHING
    assert done.axes is None or all(-1.0 <= value <= 1.0 for value in done.axes[:3])
