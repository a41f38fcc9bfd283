"""The person: whether they drive or let drive, and what the vehicle gets from them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import carla

from basu.agents.manual.inputs import Held, Input, Strike
from basu.agents.manual.keyboard import Hands, after

if TYPE_CHECKING:
    from basu.agents.manual.inputs import InputSource

DEFT = 0.02  # less than this of a stick or pedal leaves the wheel and pedals to the keys


class Person:
    """Sits at the wheel. ``step`` once a tick; ``latest`` is what was done in it, for whoever shows windows.

    Whoever drives at first, P changes it. With ``taken_by_any_input`` touching a key for driving, a stick or a pedal
    takes over, too.
    """

    def __init__(self, source: InputSource, *, drives_first: bool, taken_by_any_input: bool, live: bool) -> None:
        self.source = source
        self._taken_by_any_input = taken_by_any_input
        self._hands = Hands()
        self._reverse = False
        self.driving = drives_first
        self.drives_first = drives_first
        self.live = live  # at devices, so time has to pass as it does
        self.latest = Input()

    def step(self, tick: int, dt_s: float, agents: carla.VehicleControl) -> carla.VehicleControl | None:
        """What the person's hands and feet do in this tick; None while they let drive.

        Args:
            tick: of the run, from 0.
            dt_s: simulated time from tick to tick.
            agents: the control of the one who is relieved: the wheel is taken over as it stands.
        """
        self.latest = done = self.source.read(tick)
        if self._takes_or_gives(done):
            self._hands = Hands(steer=float(agents.steer))
            self._reverse = bool(agents.reverse)
        if not self.driving:
            return None
        if done.strikes.count(Strike.REVERSE) % 2:
            self._reverse = not self._reverse
        self._hands = after(self._hands, done.held, dt_s)
        return _control(self._hands, done, reverse=self._reverse)

    def _takes_or_gives(self, done: Input) -> bool:
        """Change who drives where that is wished; whether the person has just taken the wheel."""
        before = self.driving
        if done.strikes.count(Strike.AUTOPILOT) % 2:
            self.driving = not self.driving
        elif self._taken_by_any_input and done.drives:
            self.driving = True
        return self.driving and not before


def _control(hands: Hands, done: Input, *, reverse: bool) -> carla.VehicleControl:
    """Keys and axes together: of each pedal the one that is pressed more, of the wheel the axis where it is turned."""
    throttle, brake, steer, hand_brake = hands.throttle, hands.brake, hands.steer, Held.HAND_BRAKE in done.held
    if done.axes is not None:
        throttle, brake = max(throttle, done.axes.throttle), max(brake, done.axes.brake)
        steer = done.axes.steer if abs(done.axes.steer) >= DEFT else steer
        hand_brake = hand_brake or done.axes.hand_brake
    return carla.VehicleControl(throttle=throttle, steer=steer, brake=brake, hand_brake=hand_brake, reverse=reverse)
