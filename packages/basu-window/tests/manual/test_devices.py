"""Claims about reading the keyboard through pygame, with SDL's dummy driver."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pygame
import pytest

from basu.errors import UserError
from basu_window.manual.devices import Devices, check_display
from basu_window.manual.inputs import Axes, Held, Input, Strike


@pytest.fixture
def devices(monkeypatch: pytest.MonkeyPatch) -> Iterator[Devices]:
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    pygame.display.init()
    pygame.display.set_mode((64, 64))
    yield Devices()
    pygame.display.quit()


def key(kind: str, name: str) -> None:
    pygame.event.post(pygame.event.Event(getattr(pygame, kind), key=getattr(pygame, f"K_{name}")))


def test_keys_hold_from_down_to_up(devices: Devices) -> None:
    key("KEYDOWN", "w")
    key("KEYDOWN", "LEFT")
    assert devices.read(0) == Input(Held.THROTTLE | Held.LEFT)
    key("KEYUP", "LEFT")
    assert devices.read(1) == Input(Held.THROTTLE)
    key("KEYUP", "w")
    assert devices.read(2) == Input()


def test_a_tap_between_two_ticks_is_not_lost(devices: Devices) -> None:
    key("KEYDOWN", "SPACE")
    key("KEYUP", "SPACE")
    assert devices.read(0) == Input(Held.HAND_BRAKE)
    assert devices.read(1) == Input()


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("q", Strike.REVERSE),
        ("p", Strike.AUTOPILOT),
        ("h", Strike.HELP),
        ("TAB", Strike.VIEW),
        ("F12", Strike.SCREENSHOT),
        ("ESCAPE", Strike.QUIT),
    ],
)
def test_struck_keys_mean_something_once(devices: Devices, name: str, meant: Strike) -> None:
    key("KEYDOWN", name)
    assert devices.read(0) == Input(strikes=(meant,))
    assert devices.read(1) == Input()


class Pad:
    """An unknown gamepad: the stick to the left, the right trigger half pressed, both triggers said to be at 0."""

    def __init__(self, _number: int) -> None: ...

    def get_name(self) -> str:
        return "Some Pad"

    def get_numaxes(self) -> int:
        return 6

    def get_axis(self, axis: int) -> float:
        return (-1.0, 0.0, 0.0, 0.0, 0.0, 0.0)[axis]

    def get_numbuttons(self) -> int:
        return 11

    def get_button(self, button: int) -> bool:
        return button == 0


def test_a_gamepad_steers_presses_and_strikes(
    devices: Devices, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)  # where no wheel_config.ini lies
    monkeypatch.setattr(pygame.joystick, "get_count", lambda: 1)
    monkeypatch.setattr(pygame.joystick, "Joystick", Pad)
    assert devices.read(0).axes == Axes(-1.0, 0.0, 0.0, True)
    pygame.event.post(pygame.event.Event(pygame.JOYAXISMOTION, axis=5, value=0.0))
    pygame.event.post(pygame.event.Event(pygame.JOYBUTTONDOWN, button=3))
    done = devices.read(1)
    assert done.axes == Axes(-1.0, 0.5, 0.0, True)
    assert done.strikes == (Strike.AUTOPILOT,)


def test_closing_the_window_quits(devices: Devices) -> None:
    pygame.event.post(pygame.event.Event(pygame.QUIT))
    assert devices.read(0).strikes == (Strike.QUIT,)


def test_without_pygame_a_sentence_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pygame", None)
    with pytest.raises(UserError, match="pip install basu-window"):
        check_display()


def test_without_a_display_a_sentence_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER"):
        monkeypatch.delenv(name, raising=False)
    pygame.display.quit()
    try:
        with pytest.raises(UserError, match=r"no window can be opened here.*SDL_VIDEODRIVER=dummy"):
            check_display()
    finally:
        pygame.display.quit()


def test_an_actor_that_was_refused_a_window_may_have_one_with_another_driver(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER"):
        monkeypatch.delenv(name, raising=False)
    pygame.display.quit()
    with pytest.raises(UserError):
        check_display()
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    check_display()
    pygame.display.quit()
