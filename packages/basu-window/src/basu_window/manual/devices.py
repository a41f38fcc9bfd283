"""Reads keyboard, gamepad or wheel through pygame: the one place that touches devices. It needs a window.

The rest of this package works without pygame, which is an extra.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from basu.errors import UserError
from basu_window.manual.inputs import Axes, Held, Input, Strike
from basu_window.manual.joystick import axes, layout_for

if TYPE_CHECKING:
    from collections.abc import Mapping

HELD_BY = {
    Held.THROTTLE: ("w", "UP"),
    Held.BRAKE: ("s", "DOWN"),
    Held.LEFT: ("a", "LEFT"),
    Held.RIGHT: ("d", "RIGHT"),
    Held.HAND_BRAKE: ("SPACE",),
}
STRUCK_BY = {
    Strike.REVERSE: ("q",),
    Strike.AUTOPILOT: ("p",),
    Strike.HELP: ("h", "QUESTION"),
    Strike.PANEL: ("F1",),
    Strike.VIEW: ("TAB",),
    Strike.SENSOR: ("n",),
    Strike.SCREENSHOT: ("F12",),
    Strike.QUIT: ("ESCAPE",),
}
"""Keys as pygame's constants are called behind their ``K_``."""


def import_pygame() -> Any:  # noqa: ANN401 - a module that may not be there
    """The module.

    Raises:
        UserError: it is not installed.
    """
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")  # stdout belongs to the run's table
    try:
        import pygame  # noqa: PLC0415 - an extra
    except ImportError as error:
        raise UserError("a window for the HUD needs pygame, which is not installed; `pip install basu-window`") from (
            error
        )
    return pygame


def check_display() -> None:
    """Find out whether a window can be opened, before anything else is begun.

    Raises:
        UserError: there is no pygame or no display.
    """
    pygame = import_pygame()
    try:
        pygame.display.init()
        driver = pygame.display.get_driver()
    except pygame.error as error:
        raise UserError(
            f"no window can be opened here ({error}); run where there is a display, or with SDL_VIDEODRIVER=dummy to "
            "draw without showing"
        ) from error
    if driver == "offscreen" and os.environ.get("SDL_VIDEODRIVER") != "offscreen":
        pygame.display.quit()  # the next caller may have another driver
        raise UserError(
            "no window can be opened here: there is no display; run where there is one, or with SDL_VIDEODRIVER=dummy "
            "to draw without showing"
        )


class Devices:
    """Keyboard and the first gamepad or wheel. To be read in the thread that opened the window."""

    def __init__(self) -> None:
        self._pygame = pygame = import_pygame()
        self._held = _by_key(pygame, HELD_BY)
        self._struck = _by_key(pygame, STRUCK_BY)
        self._joystick: Any = None
        self._moved: set[int] = set()
        self._down = Held.NOTHING
        self._ready = False

    def read(self, tick: int) -> Input:
        """What is down now, and what was struck since the last reading."""
        del tick
        pygame = self._pygame
        if not self._ready:
            self._ready = True
            self._find_joystick()
        strikes: list[Strike] = []
        touched = Held.NOTHING
        for event in pygame.event.get():
            touched |= self._heed(event, strikes)
        return Input(touched | self._down, tuple(strikes), self._axes())

    def _find_joystick(self) -> None:
        """Take the first one there is."""
        pygame = self._pygame
        pygame.joystick.init()
        if pygame.joystick.get_count():
            self._joystick = pygame.joystick.Joystick(0)
            self._layout = layout_for(self._joystick.get_name(), Path.cwd())

    def _heed(self, event: Any, strikes: list[Strike]) -> Held:  # noqa: ANN401 - pygame is untyped
        """Take an event in; what it holds down, if only for a moment between two readings."""
        pygame = self._pygame
        touched = Held.NOTHING
        strike: Strike | None = None
        if event.type == pygame.QUIT:
            strike = Strike.QUIT
        elif event.type == pygame.KEYDOWN:
            strike = self._struck.get(event.key)
            touched = self._held.get(event.key, Held.NOTHING)
            self._down |= touched
        elif event.type == pygame.KEYUP:
            self._down &= ~self._held.get(event.key, Held.NOTHING)
        elif event.type == pygame.JOYAXISMOTION:
            self._moved.add(event.axis)
        elif event.type == pygame.JOYBUTTONDOWN and self._joystick is not None:
            strike = dict(self._layout.strikes).get(event.button)
        strikes.extend(() if strike is None else (strike,))
        return touched

    def _axes(self) -> Axes | None:
        """The gamepad or wheel, where there is one."""
        stick = self._joystick
        if stick is None:
            return None
        readings = [stick.get_axis(axis) for axis in range(stick.get_numaxes())]
        buttons = [bool(stick.get_button(button)) for button in range(stick.get_numbuttons())]
        return axes(self._layout, readings, self._moved, buttons)


def _by_key(pygame: Any, names: Mapping[Any, tuple[str, ...]]) -> dict[int, Any]:  # noqa: ANN401 - likewise
    """Meanings by pygame's number of the key."""
    return {getattr(pygame, f"K_{name}"): meant for meant, keys in names.items() for name in keys}
