"""Disturbances of the ego's controls as actions: correlated noise, a constant steering offset."""

from __future__ import annotations

import math

from basu.scenarios.actions.one_frame import Action
from basu.scenarios.stage import Controls


def _steered(controls: Controls, steer: float, throttle: float = 0.0) -> Controls:
    """Controls with something added, within their range."""
    return Controls(
        min(max(controls.throttle + throttle, 0.0), 1.0),
        min(max(controls.steer + steer, -1.0), 1.0),
        controls.brake,
    )


class _Disturbance(Action):
    """Disturb for some seconds; subclasses say by how much."""

    def __init__(self, name: str, seconds: float) -> None:
        super().__init__(name)
        self.seconds = seconds
        self.steer = self.throttle = 0.0

    def begin(self) -> None:
        """Take the controls."""
        self.began_s = self.stage.time_s
        self.worst = 0.0
        self.stage.disturb(self.name, lambda controls: _steered(controls, self.steer, self.throttle))

    def act(self) -> str | None:
        """One frame's disturbance."""
        elapsed_s = self.stage.time_s - self.began_s
        if elapsed_s >= self.seconds - 1e-6:
            return f"{self.seconds:.3g} s, steering off by up to {self.worst:.2f}"
        self.change(elapsed_s)
        self.worst = max(self.worst, abs(self.steer))
        return None

    def change(self, elapsed_s: float) -> None:
        """Set ``steer`` and ``throttle`` for this frame, shares of their range."""
        raise NotImplementedError

    def leave(self, *, broken_off: bool) -> None:
        """Give the controls back."""
        del broken_off
        self.stage.disturb(self.name, None)


class JitterControls(_Disturbance):
    """Noise on steering and throttle: Gaussian, with these standard deviations, correlated over ``correlated_s``.

    An Ornstein-Uhlenbeck process in steps of a frame, so that its spread does not depend on the step.
    """

    def __init__(
        self, seconds: float, *, steer: float = 0.1, throttle: float = 0.2, correlated_s: float = 0.3, pull: float = 0.0
    ) -> None:
        """``pull`` is added to the steering all the time, positive to the right."""
        super().__init__(f"controls jitter for {seconds:.3g} s", seconds)
        self.steer_sd, self.throttle_sd, self.correlated_s, self.pull = steer, throttle, correlated_s, pull

    def begin(self) -> None:
        """Begin the noise at its mean."""
        self.noise = (0.0, 0.0)
        self.steer, self.throttle = self.pull, 0.0
        super().begin()

    def change(self, elapsed_s: float) -> None:
        """A step of the process."""
        del elapsed_s
        keep = math.exp(-self.stage.step_s / self.correlated_s)
        fresh = math.sqrt(1.0 - keep * keep)
        rng = self.stage.rng
        self.noise = (keep * self.noise[0] + fresh * rng.gauss(0, 1), keep * self.noise[1] + fresh * rng.gauss(0, 1))
        self.steer, self.throttle = self.pull + self.steer_sd * self.noise[0], self.throttle_sd * self.noise[1]


class PullSteering(_Disturbance):
    """Steering off by a constant share, reached within ``rising_s``, positive to the right: the incident of Linden."""

    def __init__(self, amount: float, seconds: float, rising_s: float = 0.3) -> None:
        super().__init__(f"steering pulls to the {'right' if amount > 0.0 else 'left'} for {seconds:.3g} s", seconds)
        self.amount, self.rising_s = amount, rising_s

    def change(self, elapsed_s: float) -> None:
        """More, until it is all there."""
        self.steer = self.amount * min(1.0, (elapsed_s + self.stage.step_s) / self.rising_s)
