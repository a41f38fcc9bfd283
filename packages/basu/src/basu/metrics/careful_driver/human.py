"""CC, the competent and careful human driver of UN Regulation 157: no reaction or full braking.

UN Regulation 157 (original version, annex 4, appendix 3): a cut-in is a risk if the time to collision is 2 s or less.
The driver brakes 0.75 s later and reaches 0.774 g within 0.6 s. During the delay the foot leaves the accelerator.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from basu.metrics.careful_driver.model import DELAY_S, HEADWAY_S, Situation, ramped_mps2

if TYPE_CHECKING:
    from basu.metrics.careful_driver.model import Flags, Numbers, View


@dataclass(frozen=True, slots=True, kw_only=True)
class CarefulHuman:
    """Careful and competent human of UN Regulation 157: a model of a driver, with its parameters as attributes."""

    name: str = "CC"
    delay_s: float = DELAY_S
    coasting_mps2: float = 0.4
    critical_s: float = 2.0

    def perceives(self, view: View, situation: Situation) -> Flags:
        """Return where a vehicle in the path is critical; one that brakes, or is uncovered by another, always is."""
        if situation is not Situation.CUT_IN:
            return np.ones(len(view.gap_m), dtype=bool)
        return self._cuts_in(view) & (view.ttc_s <= self.critical_s)

    def dismisses(self, view: View, situation: Situation) -> Flags:
        """Return where a vehicle has come into the path with so much time that the regulation has no risk in it."""
        if situation is not Situation.CUT_IN:
            return np.zeros(len(view.gap_m), dtype=bool)
        return self._cuts_in(view) & (view.ttc_s > self.critical_s)

    def braking_mps2(self, view: View, before_mps2: Numbers, step_s: float) -> Numbers:  # noqa: ARG002 - it does not look
        """Return full braking, which is reached after 0.6 s."""
        return ramped_mps2(before_mps2, step_s)

    def following_m(self, speed_mps: Numbers) -> Numbers:
        """Return the gaps, m, at which the model follows: what it drives in ``HEADWAY_S``."""
        return HEADWAY_S * speed_mps

    def _cuts_in(self, view: View) -> Flags:
        """Return where the other is ahead, and in the path."""
        return view.is_ahead & (view.clear_m <= 0.0)
