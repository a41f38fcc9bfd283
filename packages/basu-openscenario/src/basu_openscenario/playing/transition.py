"""`Transition`: a value on its way to a target, along a step, a line, half a sine or a cubic curve."""

from __future__ import annotations

import math
from dataclasses import dataclass

SMALL = 1e-6
_PEAK_SLOPE = {"linear": 1.0, "sinusoidal": math.pi / 2.0, "cubic": 1.5}
"""The steepest slope of each shape, for a change of 1 over a range of 1."""


def sign(value: float) -> float:
    """Return -1 for negative values, otherwise 1."""
    return -1.0 if value < 0.0 else 1.0


def away_from_zero(value: float) -> float:
    """Return a value that one may divide by: at least `SMALL` in size."""
    return sign(value) * max(abs(value), SMALL)


@dataclass(slots=True)
class Transition:
    """A value that changes from ``start`` to ``target`` while a parameter grows from 0 to ``range``.

    The parameter is a time in s or a distance in m. By ``rate``, the range follows from the steepest slope.
    """

    shape: str
    dimension: str
    value: float
    start: float = 0.0
    target: float = 0.0
    at: float = 0.0
    stretch: float = 1.0
    """The range is this much longer, to keep the slope below a limit."""

    @property
    def range(self) -> float:
        """Return the parameter at the end."""
        if self.dimension != "rate":
            return self.value
        if self.shape == "step" or abs(self.value) < SMALL:
            return 0.0
        return max(_PEAK_SLOPE[self.shape] * abs(self.target - self.start) / abs(self.value), SMALL)

    @property
    def is_step(self) -> bool:
        """Return whether the target is reached at once."""
        return self.shape == "step" or (self.dimension != "rate" and self.range < SMALL)

    def limit_slope(self, most: float) -> None:
        """Stretch the range so that no slope is steeper than ``most``."""
        peak = self.peak_slope()
        self.stretch = abs(peak) / max(abs(most), SMALL) if abs(peak) > abs(most) else 1.0

    def peak_slope(self) -> float:
        """Return the steepest slope."""
        if self.dimension == "rate":
            return abs(self.value) * sign(self.target - self.start)
        if self.is_step:
            return 1e10 * sign(self.target - self.start)
        return _PEAK_SLOPE[self.shape] * (self.target - self.start) / away_from_zero(self.range)

    def advance(self, by: float) -> None:
        """Move the parameter, inside its range."""
        self.at = min(max(self.at + by / self.stretch, 0.0), self.range)

    def now(self, shape: str | None = None) -> float:
        """Return the present value."""
        if self.is_step:
            return self.target
        share = self.at / away_from_zero(self.range)
        change = self.target - self.start
        kind = shape or self.shape
        if kind == "linear":
            return self.start + share * change
        if kind == "sinusoidal":
            return self.start + change * (1.0 - math.cos(math.pi * share)) / 2.0
        return self.start + change * share * share * (3.0 - 2.0 * share)

    def slope(self) -> float:
        """Return the present slope."""
        change, length = self.target - self.start, self.range
        if self.is_step:
            return 1e10 * sign(change)
        length = away_from_zero(length)
        if self.shape == "linear":
            return change / length
        if self.shape == "sinusoidal":
            return math.pi * change * math.sin(math.pi * self.at / length) / (2.0 * length)
        return 6.0 * change * (length - self.at) * self.at / length**3

    @property
    def is_over(self) -> bool:
        """Return whether the parameter has reached its end."""
        return self.at > self.range - SMALL

    def has_passed(self, value: float) -> bool:
        """Return whether ``value`` has reached the target or gone beyond it."""
        beyond = sign(value - self.target) != sign(self.start - self.target)
        return self.is_over or abs(value - self.target) < SMALL or (self.at > 0.0 and beyond)


def range_by_peak_bend(shape: str, change: float, most: float) -> float:
    """Return the range over which a change bends at most by ``most``; a line counts as a cubic curve."""
    if shape == "step":
        return 0.0
    if shape == "sinusoidal":
        return math.pi * math.sqrt(abs(change) / (2.0 * most))
    return math.sqrt(6.0 * abs(change) / most)
