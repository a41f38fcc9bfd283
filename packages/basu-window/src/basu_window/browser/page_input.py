"""`PageInput`: keys, gamepad and wheel of a person at the page, as an input source of a drive."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from basu_window.manual.inputs import Axes, Held, Input, Strike
from basu_window.manual.joystick import axes, layout_for

if TYPE_CHECKING:
    from basu_window.manual.joystick import Layout

_HELD = {
    "throttle": Held.THROTTLE,
    "brake": Held.BRAKE,
    "left": Held.LEFT,
    "right": Held.RIGHT,
    "hand_brake": Held.HAND_BRAKE,
}
_STRIKES = {"reverse": Strike.REVERSE, "autopilot": Strike.AUTOPILOT, "quit": Strike.QUIT}
_MOST_STRIKES = 20
"""Strikes of one tick; a person manages two."""
_LEFT_STICK, _BRAKE_TRIGGER, _THROTTLE_TRIGGER, _HAND_BRAKE = 0, 6, 7, 0
"""Axis and buttons of the "standard gamepad" of the W3C's Gamepad API."""
_STANDARD_STRIKES = {2: Strike.REVERSE, 3: Strike.AUTOPILOT}
_DEAD_ZONE = 0.1


class PageInput:
    """What the page with the wheel sent last. The first page that drives has the wheel until it leaves."""

    def __init__(self) -> None:
        self._page: int | None = None
        self._held = Held.NOTHING
        self._touched = Held.NOTHING
        self._strikes: list[Strike] = []
        self._axes: Axes | None = None
        self._moved: set[int] = set()
        self._rest: list[float] | None = None
        self._down: set[int] = set()
        self._layout: tuple[str, Layout] | None = None

    def take(self, order: dict[str, Any]) -> None:
        """Take an order ``drive`` of a page, or notice that a page has left; what cannot be read is ignored."""
        page = order.get("page")
        if order["order"] == "left":
            if page == self._page:  # hands off: the vehicle must not go on by keys of a closed page
                self._page, self._held, self._axes, self._rest = None, Held.NOTHING, None, None
                self._moved = set()
            return
        if order["order"] != "drive":
            return
        if self._page is None:
            self._page = page
        if page != self._page:
            return
        held = Held.NOTHING
        for name in order.get("held") or ():
            held |= _HELD.get(name, Held.NOTHING) if isinstance(name, str) else Held.NOTHING
        self._held = held
        self._touched |= held
        strikes = [_STRIKES[name] for name in order.get("strikes") or () if isinstance(name, str) and name in _STRIKES]
        self._strikes = [*self._strikes, *strikes][:_MOST_STRIKES]
        self._axes = self._of_pad(order.get("pad"))

    def read(self, tick: int) -> Input:
        """Return what is down now, and what was struck since the last reading."""
        del tick
        touched, self._touched = self._touched, Held.NOTHING
        strikes, self._strikes = tuple(self._strikes), []
        return Input(self._held | touched, strikes, self._axes)

    def _of_pad(self, pad: object) -> Axes | None:
        """Return steering and pedals of a gamepad or wheel as the browser names its axes."""
        if not isinstance(pad, dict):
            return None
        readings, buttons = _numbers(pad.get("axes")), _numbers(pad.get("buttons"))
        pressed = {number for number, value in enumerate(buttons) if value > 0.5}
        fresh, self._down = pressed - self._down, pressed
        if pad.get("standard") is True:
            self._strike(fresh, _STANDARD_STRIKES)
            return _standard(readings, buttons)
        name = str(pad.get("name", ""))[:100]
        if self._layout is None or self._layout[0] != name:
            self._layout = name, layout_for(name, Path.cwd())
        layout = self._layout[1]
        self._strike(fresh, dict(layout.strikes))
        if self._rest is None or len(self._rest) != len(readings):
            self._rest = readings
        self._moved |= {axis for axis, value in enumerate(readings) if value != self._rest[axis]}
        return axes(layout, readings, self._moved, [value > 0.5 for value in buttons])

    def _strike(self, fresh: set[int], meanings: dict[int, Strike]) -> None:
        self._strikes += [meanings[number] for number in sorted(fresh) if number in meanings]


def _standard(readings: list[float], buttons: list[float]) -> Axes:
    """Return steering and pedals of a gamepad with the standard layout: left stick and triggers."""
    turned = readings[_LEFT_STICK] if readings else 0.0
    beyond = max(0.0, abs(turned) - _DEAD_ZONE) / (1.0 - _DEAD_ZONE)

    def pressed(button: int) -> float:
        return round(min(1.0, max(0.0, buttons[button])), 2) if button < len(buttons) else 0.0

    return Axes(
        round(math.copysign(min(1.0, beyond), turned), 2),
        pressed(_THROTTLE_TRIGGER),
        pressed(_BRAKE_TRIGGER),
        pressed(_HAND_BRAKE) > 0.5,
    )


def _numbers(values: object) -> list[float]:
    """Return the numbers of a list from -1 to 1; what is no number counts as 0."""
    if not isinstance(values, list):
        return []
    return [
        max(-1.0, min(1.0, float(value))) if isinstance(value, int | float) and math.isfinite(value) else 0.0
        for value in values[:32]
    ]
