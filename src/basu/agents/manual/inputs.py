"""What a person does in one tick: keys held down, keys struck, and how far sticks and pedals are moved."""

from __future__ import annotations

import enum
from typing import NamedTuple, Protocol


class Held(enum.Flag):
    """Keys that work for as long as they are down."""

    NOTHING = 0
    THROTTLE = enum.auto()
    BRAKE = enum.auto()
    LEFT = enum.auto()
    RIGHT = enum.auto()
    HAND_BRAKE = enum.auto()


class Strike(enum.Enum):
    """Keys that work once, when they go down."""

    REVERSE = "reverse"
    AUTOPILOT = "autopilot"
    HELP = "help"
    PANEL = "panel"
    VIEW = "view"
    SENSOR = "sensor"
    SCREENSHOT = "screenshot"
    QUIT = "quit"


DRIVING_STRIKES = frozenset({Strike.REVERSE, Strike.AUTOPILOT})  # the rest concern the window, not the vehicle


class Axes(NamedTuple):
    """Stick or wheel and pedals, in steps of a hundredth so that a recording of them plays as it was driven."""

    steer: float  # -1 (left) to 1
    throttle: float  # 0 to 1
    brake: float  # 0 to 1
    hand_brake: bool = False


class Input(NamedTuple):
    """One tick of a person."""

    held: Held = Held.NOTHING
    strikes: tuple[Strike, ...] = ()
    axes: Axes | None = None  # None: there is no gamepad or wheel

    @property
    def drives(self) -> bool:
        """Whether this is meant for the vehicle: a key for driving is down, or a stick or pedal is off its rest."""
        return self.held is not Held.NOTHING or (self.axes is not None and self.axes != (0.0, 0.0, 0.0, False))


class InputSource(Protocol):
    """Where a person's doing comes from: devices, or a recorded session."""

    def read(self, tick: int) -> Input:
        """What is done in ``tick``, which counts from 0 at the first step of the run; called once for each."""
        ...
