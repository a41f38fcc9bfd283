"""`Person`: turns the `Input` of a tick (keys, sticks, pedals) from an `InputSource` into the vehicle's control.

The figures are those of CARLA's ``manual_control.py`` (0.9.16, ``_parse_vehicle_keys``) at its 20 frames a second, as
rates, so that they hold for every step: throttle is there after half a second, brake after a quarter, the wheel turns
by half its range a second up to 0.7. There the wheel snaps back when a key is let go; here it returns.
"""

from __future__ import annotations

import enum
from typing import TYPE_CHECKING, NamedTuple, Protocol

import carla

if TYPE_CHECKING:
    from basu_window.browser.page_input import PageInput


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
    QUIT = "quit"


DRIVING_STRIKES = frozenset({Strike.REVERSE, Strike.AUTOPILOT})  # the other one ends the run


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
    """Where a person's doing comes from: a page, or a recorded session."""

    def read(self, tick: int) -> Input:
        """What is done in ``tick``, which counts from 0 at the first step of the run; called once for each."""
        ...


THROTTLE_1PS = 2.0
BRAKE_1PS = 4.0
STEER_1PS = 0.5
CENTRE_1PS = 1.5  # back towards the middle, hands off or against the turn: three times as fast as into it
MOST_STEER = 0.7


class PedalsAndWheel(NamedTuple):
    """Pedals and wheel as keys have brought them, in CARLA's ranges."""

    throttle: float = 0.0
    brake: float = 0.0
    steer: float = 0.0


def after(hands: PedalsAndWheel, held: Held, dt_s: float) -> PedalsAndWheel:
    """Pedals and wheel after ``dt_s`` with these keys down."""
    return PedalsAndWheel(
        throttle=min(1.0, hands.throttle + THROTTLE_1PS * dt_s) if Held.THROTTLE in held else 0.0,
        brake=min(1.0, hands.brake + BRAKE_1PS * dt_s) if Held.BRAKE in held else 0.0,
        steer=steer_after(hands.steer, held, dt_s),
    )


def steer_after(steer: float, held: Held, dt_s: float) -> float:
    """The wheel after ``dt_s``; both keys at once are none."""
    way = float(Held.RIGHT in held) - float(Held.LEFT in held)
    if way * steer > 0.0 or (way != 0.0 and steer == 0.0):
        turned = steer + way * STEER_1PS * dt_s
        # a wheel that an agent had turned farther than keys can stays there until it is let go
        return max(-max(MOST_STEER, -steer), min(max(MOST_STEER, steer), turned))
    back = CENTRE_1PS * dt_s
    return max(0.0, steer - back) if steer > 0.0 else min(0.0, steer + back)


DEFT = 0.02  # less than this of a stick or pedal leaves the wheel and pedals to the keys


class Person:
    """The person at the wheel. Call ``step`` once a tick; ``latest`` is that tick's input, for windows.

    The key P changes between person and agent. With ``taken_by_any_input`` touching a key for driving, a stick or a
    pedal takes over, too.
    """

    def __init__(
        self,
        source: InputSource,
        *,
        drives_first: bool,
        taken_by_any_input: bool,
        live: bool,
        page: PageInput | None = None,
    ) -> None:
        self.source = source
        self.page = page  # None without one
        self._taken_by_any_input = taken_by_any_input
        self._hands = PedalsAndWheel()
        self._reverse = False
        self.driving = drives_first
        self.drives_first = drives_first
        self.live = live  # at a page, so the drive runs in real time
        self.latest = Input()

    def step(self, tick: int, dt_s: float, agents: carla.VehicleControl) -> carla.VehicleControl | None:
        """What the person's hands and feet do in this tick; None while they let drive.

        Args:
            tick: of the run, from 0.
            dt_s: simulated time from tick to tick.
            agents: the agent's control; the person takes over the wheel as it stands.
        """
        self.latest = done = self.source.read(tick)
        if self._takes_or_gives(done):
            self._hands = PedalsAndWheel(steer=float(agents.steer))
            self._reverse = bool(agents.reverse)
        if not self.driving:
            return None
        if done.strikes.count(Strike.REVERSE) % 2:
            self._reverse = not self._reverse
        self._hands = after(self._hands, done.held, dt_s)
        return _control(self._hands, done, reverse=self._reverse)

    def _takes_or_gives(self, done: Input) -> bool:
        """Change between person and agent on request; whether the person has just taken the wheel."""
        before = self.driving
        if done.strikes.count(Strike.AUTOPILOT) % 2:
            self.driving = not self.driving
        elif self._taken_by_any_input and done.drives:
            self.driving = True
        return self.driving and not before


def _control(hands: PedalsAndWheel, done: Input, *, reverse: bool) -> carla.VehicleControl:
    """Keys and axes together: of each pedal the one that is pressed more, of the wheel the axis where it is turned."""
    throttle, brake, steer, hand_brake = hands.throttle, hands.brake, hands.steer, Held.HAND_BRAKE in done.held
    if done.axes is not None:
        throttle, brake = max(throttle, done.axes.throttle), max(brake, done.axes.brake)
        steer = done.axes.steer if abs(done.axes.steer) >= DEFT else steer
        hand_brake = hand_brake or done.axes.hand_brake
    return carla.VehicleControl(throttle=throttle, steer=steer, brake=brake, hand_brake=hand_brake, reverse=reverse)
