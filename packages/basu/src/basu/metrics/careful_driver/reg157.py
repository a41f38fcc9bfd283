"""Reg157, the bound of UN Regulation 157 itself: a driver that brakes as late as the regulation allows.

Paragraph 5.2.5.2 demands that a collision is avoided if the time to collision is above a bound. It counts when the
other has come 0.3 m into the lane. The bound is v/(2 · 6 m/s²) + 0.35 s, with v the closing speed. The model brakes
with 6 m/s², 0.35 s after the time to collision has fallen to that bound and 0.1 s. The 0.1 s are those of the Joint
Research Centre's program.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from basu.metrics.careful_driver.model import HEADWAY_S, Situation

if TYPE_CHECKING:
    from basu.metrics.careful_driver.model import Flags, Numbers, View

SLACK_S = 0.1


@dataclass(frozen=True, slots=True, kw_only=True)
class Reg157:
    """Bound of UN Regulation 157 on the time to collision: a model of a driver, its parameters as attributes."""

    name: str = "Reg157"
    delay_s: float = 0.35
    coasting_mps2: float = 0.0
    brakes_mps2: float = 6.0
    beside_m: float = 0.5  # between the sides: nearer than this, the other is about to come into the path

    def bound_s(self, closing_mps: Numbers) -> Numbers:
        """Return the time to collision above which the regulation demands that a collision is avoided."""
        return closing_mps / (2.0 * self.brakes_mps2) + self.delay_s

    def perceives(self, view: View, situation: Situation) -> Flags:
        """Return where the time to collision has fallen to the bound; a vehicle that brakes or is uncovered counts."""
        if situation is not Situation.CUT_IN:
            return np.ones(len(view.gap_m), dtype=bool)
        with np.errstate(divide="ignore", invalid="ignore"):
            time_s = np.abs(
                view.gap_m / view.closing_mps
            )  # the absolute value, also beside each other: as in that program
        urgent = time_s <= self.bound_s(view.closing_mps) + SLACK_S
        return view.is_ahead & (view.clear_m <= self.beside_m) & urgent

    def dismisses(self, view: View, situation: Situation) -> Flags:  # noqa: ARG002 - it never does
        """Return nowhere: each moment is judged anew."""
        return np.zeros(len(view.gap_m), dtype=bool)

    def braking_mps2(self, view: View, before_mps2: Numbers, step_s: float) -> Numbers:  # noqa: ARG002 - it does not look
        """Return full braking at once."""
        return np.full_like(view.gap_m, self.brakes_mps2)

    def following_m(self, speed_mps: Numbers) -> Numbers:
        """Return the gaps, m, at which the model follows: what it drives in ``HEADWAY_S``."""
        return HEADWAY_S * speed_mps
