"""RSS, Responsibility-Sensitive Safety: brake where the gap is neither along nor across the path a safe one.

S. Shalev-Shwartz, S. Shammah, A. Shashua: On a formal model of safe and scalable self-driving cars. arXiv:1708.06374,
2017, definitions 1 and 6. The values are those of the Joint Research Centre's comparison with the models of the
regulation. In it only the other moves across, and both vehicles brake with 6 m/s² at the most.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from basu.metrics.careful_driver.model import DELAY_S, ramped_mps2

if TYPE_CHECKING:
    from basu.metrics.careful_driver.model import Flags, Numbers, Situation, View


@dataclass(frozen=True, slots=True, kw_only=True)
class Rss:
    """Responsibility-sensitive safety: a model of a careful driver, with its parameters as attributes."""

    name: str = "RSS"
    delay_s: float = DELAY_S
    coasting_mps2: float = 0.0
    accelerates_mps2: float = 3.0  # what the own vehicle may do during the delay
    brakes_mps2: float = 6.0  # of both
    across_mps2: float = 1.0  # of the other
    margin_m: float = 0.3  # across

    def perceives(self, view: View, situation: Situation) -> Flags:  # noqa: ARG002 - one rule for all situations
        """Return where both gaps are below the safe ones."""
        along = view.gap_m < self._safe_along_m(view.own_mps, view.other_mps)
        return view.is_ahead & along & (view.clear_m < self._safe_across_m(view.across_mps))

    def dismisses(self, view: View, situation: Situation) -> Flags:  # noqa: ARG002 - it never does
        """Return nowhere: each moment is judged anew."""
        return np.zeros(len(view.gap_m), dtype=bool)

    def braking_mps2(self, view: View, before_mps2: Numbers, step_s: float) -> Numbers:  # noqa: ARG002 - it does not look
        """Return full braking, which is reached after 0.6 s."""
        return ramped_mps2(before_mps2, step_s)

    def following_m(self, speed_mps: Numbers) -> Numbers:
        """Return the gap that is still a safe one if the vehicle ahead brakes fully during the whole delay."""
        loses_m = self.brakes_mps2 * self.delay_s**2 / 2.0
        slowed_mps = np.maximum(speed_mps - self.delay_s * self.brakes_mps2, 0.0)
        return self._safe_along_m(speed_mps, slowed_mps) + loses_m

    def _safe_along_m(self, own_mps: Numbers, other_mps: Numbers) -> Numbers:
        """Return the safe gap along the path: definition 1."""
        fastest_mps = own_mps + self.delay_s * self.accelerates_mps2
        delay_m = own_mps * self.delay_s + self.accelerates_mps2 * self.delay_s**2 / 2.0
        return delay_m + fastest_mps**2 / (2.0 * self.brakes_mps2) - other_mps**2 / (2.0 * self.brakes_mps2)

    def _safe_across_m(self, across_mps: Numbers) -> Numbers:
        """Return the safe gap across the path: definition 6, where the own vehicle keeps its lateral place."""
        speed_mps = np.abs(across_mps)
        fastest_mps = speed_mps + self.across_mps2 * self.delay_s
        delay_m = (speed_mps + fastest_mps) * self.delay_s / 2.0
        return self.margin_m + delay_m + fastest_mps**2 / (2.0 * self.across_mps2)
