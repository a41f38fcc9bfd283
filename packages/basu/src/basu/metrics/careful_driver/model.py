"""The interface of a careful driver's model: what it sees of one moment, and what it answers.

All arrays have one element for each encounter (N,). The road is straight: positions are along the path of the own
vehicle and across it.
"""

from __future__ import annotations

import enum
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Numbers = NDArray[np.float64]
    Flags = NDArray[np.bool_]

G_MPS2 = 9.81
# UN Regulation 157, annex on the careful driver: 0.774 g, reached 0.6 s after braking begins; 12.65 m/s³ is the ratio.
BRAKE_MPS2 = 0.774 * G_MPS2
BRAKE_JERK_MPS3 = 12.65
DELAY_S = 0.75  # from perceived risk to braking, likewise
HEADWAY_S = 2.0  # a choice of the Joint Research Centre's program: the gap behind a vehicle of the own speed


class Situation(enum.Enum):
    """The three situations that UN Regulation 157 describes."""

    CUT_IN = "cut-in"
    CUT_OUT = "cut-out"
    DECELERATION = "deceleration"


class View(NamedTuple):
    """One moment of N encounters."""

    gap_m: Numbers  # from the own front to the other's rear, negative where the two are beside each other
    length_m: Numbers  # half the sum of both lengths
    clear_m: Numbers  # between the sides of both, negative where one is in the path of the other
    own_mps: Numbers
    own_mps2: Numbers  # acceleration in the last step
    other_mps: Numbers  # along the path
    across_mps: Numbers  # the other's lateral speed, positive towards the path
    is_ahead: Flags  # whether the other's middle is not behind the own one

    @property
    def closing_mps(self) -> Numbers:
        """Speed at which the gap shrinks."""
        return self.own_mps - self.other_mps

    @property
    def ttc_s(self) -> Numbers:
        """Time until the gap is closed at the present speeds; inf where it does not shrink."""
        closing = self.closing_mps
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(closing > 0.0, self.gap_m / closing, np.inf)


class CarefulDriver(Protocol):
    """One model with its parameters."""

    @property
    def name(self) -> str:
        """The name by which reports call the model."""

    @property
    def delay_s(self) -> float:
        """Time from the perceived danger to the beginning of braking."""

    @property
    def coasting_mps2(self) -> float:
        """Deceleration during the delay: the foot has left the pedal."""

    def perceives(self, view: View, situation: Situation) -> Flags:
        """Return where the model sees a danger that it has to react to."""

    def dismisses(self, view: View, situation: Situation) -> Flags:
        """Return where the model holds the manoeuvre to be harmless for good."""

    def braking_mps2(self, view: View, before_mps2: Numbers, step_s: float) -> Numbers:
        """Return the deceleration of this step; ``before_mps2`` is that of the last step in which it braked."""

    def following_m(self, speed_mps: Numbers) -> Numbers:
        """Return the gap that the model keeps behind a vehicle of its own speed."""


def ramped_mps2(before_mps2: Numbers, step_s: float, most_mps2: float = BRAKE_MPS2) -> Numbers:
    """Return a deceleration that rises by the jerk of the regulation up to its full value."""
    return np.minimum(before_mps2 + BRAKE_JERK_MPS3 * step_s, most_mps2)
