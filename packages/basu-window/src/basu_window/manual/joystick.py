"""Gamepads and wheels: which axis and button does what (a file says it), and raw readings as steering and pedals."""

from __future__ import annotations

import configparser
import math
from typing import TYPE_CHECKING, NamedTuple

from basu.errors import UserError
from basu.files import PACKAGE_FOLDER
from basu_window.manual.inputs import Axes, Strike

if TYPE_CHECKING:
    from collections.abc import Sequence
    from collections.abc import Set as AbstractSet
    from pathlib import Path

PACKAGED = PACKAGE_FOLDER / "config" / "joysticks.ini"
CARLAS_FILE = "wheel_config.ini"  # what CARLA's manual_control_steeringwheel.py reads from the working folder
CARLAS_SECTION = "G29 Racing Wheel"  # and the only section it looks at, whatever the device
ANY_DEVICE = "gamepad"
SLACK = 0.03  # of a pedal's way: springs do not bring it back exactly


class Layout(NamedTuple):
    """Indices of axes and buttons, and how they behave; None: the device has no such button."""

    steer_axis: int
    throttle_axis: int
    brake_axis: int
    hand_brake: int | None
    strikes: tuple[tuple[int, Strike], ...]  # button and meaning
    rest: float  # of a pedal's axis, 1 or -1
    dead_zone: float
    power: float


def layout_for(name: str, folder: Path) -> Layout:
    """The layout of the device called ``name``; ``folder`` is where CARLA's file may lie.

    Raises:
        UserError: a file is not as it should be.
    """
    own = folder / CARLAS_FILE
    if own.is_file():
        sections = _sections(own)
        section = _named(sections, name) or (CARLAS_SECTION if CARLAS_SECTION in sections else None)
        if section is not None:
            return _layout(sections[section], f"[{section}] of {own}")
    sections = _sections(PACKAGED)
    section = _named(sections, name) or ANY_DEVICE
    return _layout(sections[section], f"[{section}] of {PACKAGED.name}")


def axes(layout: Layout, readings: Sequence[float], moved: AbstractSet[int], buttons: Sequence[bool]) -> Axes:
    """Steering and pedals out of raw readings.

    Args:
        layout: which is which; an index that the device does not have reads as rest.
        readings: of all axes, -1 to 1.
        moved: the axes that have moved since the start. The others read 0, half a pedal: they are at rest.
        buttons: whether each is down.
    """

    def pedal(axis: int) -> float:
        if axis not in moved or axis >= len(readings):
            return 0.0
        pressed = (layout.rest - readings[axis]) / (2.0 * layout.rest)
        return round(min(1.0, pressed), 2) if pressed > SLACK else 0.0

    turned = readings[layout.steer_axis] if layout.steer_axis < len(readings) else 0.0
    beyond = max(0.0, abs(turned) - layout.dead_zone) / (1.0 - layout.dead_zone)
    steer = round(math.copysign(min(1.0, beyond) ** layout.power, turned), 2)
    pulled = layout.hand_brake is not None and layout.hand_brake < len(buttons) and bool(buttons[layout.hand_brake])
    return Axes(steer, pedal(layout.throttle_axis), pedal(layout.brake_axis), pulled)


def _sections(path: Path) -> configparser.ConfigParser:
    """A file's sections."""
    parser = configparser.ConfigParser()
    try:
        parser.read_string(path.read_text(encoding="utf-8"), source=str(path))
    except (OSError, ValueError, configparser.Error) as error:
        raise UserError(f"the file of axes and buttons {path} cannot be read: {error}") from error
    return parser


def _named(sections: configparser.ConfigParser, device: str) -> str | None:
    """The section with a name that is part of the device's, the longest of several."""
    known = [name for name in sections.sections() if name.lower() in device.lower()]
    return max(known, key=len, default=None)


def _layout(section: configparser.SectionProxy, where: str) -> Layout:
    """A section's values; what CARLA's files do not have is a wheel's."""
    try:
        meanings = (("reverse", Strike.REVERSE), ("autopilot", Strike.AUTOPILOT))
        layout = Layout(
            steer_axis=int(section["steering_wheel"]),
            throttle_axis=int(section["throttle"]),
            brake_axis=int(section["brake"]),
            hand_brake=section.getint("handbrake"),
            strikes=tuple((int(section[name]), strike) for name, strike in meanings if name in section),
            rest=float(section.get("rest", "1")),
            dead_zone=float(section.get("dead_zone", "0.01")),
            power=float(section.get("power", "1")),
        )
    except KeyError as error:
        raise UserError(f"{where} lacks {error}; it needs steering_wheel, throttle and brake") from error
    except ValueError as error:
        raise UserError(f"{where} holds what is no number: {error}") from error
    if abs(layout.rest) != 1.0 or not 0.0 <= layout.dead_zone < 1.0 or layout.power <= 0.0:
        raise UserError(f"{where}: rest is 1 or -1, dead_zone from 0 to below 1, power above 0")
    return layout
