"""FSM, the fuzzy safety model: two fuzzy measures of danger, of which each asks for a share of the braking.

K. Mattas and others: Fuzzy surrogate safety metrics for real-time assessment of rear-end collision risk. Accident
Analysis and Prevention 148, 105794, 2020. UN Regulation 157 (01 series of amendments) has it as one of its models.
The values are those of the regulation, as the Joint Research Centre's public program has them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from basu.metrics.careful_driver.model import DELAY_S, ramped_mps2

if TYPE_CHECKING:
    from basu.metrics.careful_driver.model import Flags, Numbers, Situation, View

MARGIN_S = 0.1  # the own vehicle has passed so long before the other comes into its path: no conflict


@dataclass(frozen=True, slots=True, kw_only=True)
class Fsm:
    """Fuzzy safety model: a model of a careful driver, with its parameters as attributes."""

    name: str = "FSM"
    delay_s: float = DELAY_S
    coasting_mps2: float = 0.0
    comfortable_mps2: float = 4.0
    hard_mps2: float = 6.0
    leader_mps2: float = 7.0  # the hardest braking that is expected of the vehicle ahead
    standing_gap_m: float = 2.0
    margin_m: float = 2.0

    def perceives(self, view: View, situation: Situation) -> Flags:  # noqa: ARG002 - one rule for all situations
        """Return where one of the fuzzy measures is above 0 and the other comes, or is, in the path."""
        with np.errstate(divide="ignore", invalid="ignore"):
            until_in_path_s = view.clear_m / view.across_mps
            until_passed_s = (view.gap_m + 2.0 * view.length_m) / view.closing_mps
        comes = (view.across_mps > 0.0) & ~(until_in_path_s > until_passed_s + MARGIN_S)
        is_relevant = view.is_ahead & ((view.clear_m <= 0.0) | comes)
        found: Flags = is_relevant & (self.critical(view) + self.proactive(view) != 0.0)
        return found

    def dismisses(self, view: View, situation: Situation) -> Flags:  # noqa: ARG002 - it never does
        """Return nowhere: each moment is judged anew."""
        return np.zeros(len(view.gap_m), dtype=bool)

    def proactive(self, view: View) -> Numbers:
        """PFS, 0 to 1: how far the gap is below the one that suffices if the other brakes as hard as it can."""
        own, gap = view.own_mps, view.gap_m - self.standing_gap_m
        stops_m = view.other_mps**2 / (2.0 * self.leader_mps2)
        safe = own * self.delay_s + own**2 / (2.0 * self.comfortable_mps2) - stops_m + self.margin_m
        unsafe = own * self.delay_s + own**2 / (2.0 * self.hard_mps2) - stops_m
        return _between(gap, safe, unsafe)

    def critical(self, view: View) -> Numbers:
        """CFS, 0 to 1: how far the gap is below the one that suffices if both go on as they do."""
        own_mps2 = np.maximum(view.own_mps2, -self.comfortable_mps2)
        then_mps = view.closing_mps + own_mps2 * self.delay_s
        delay_m = (view.closing_mps + own_mps2 * self.delay_s / 2.0) * self.delay_s
        safe = delay_m + then_mps**2 / (2.0 * self.comfortable_mps2)
        unsafe = delay_m + then_mps**2 / (2.0 * self.hard_mps2)
        found = _between(view.gap_m, safe, unsafe)
        with np.errstate(divide="ignore", invalid="ignore"):
            stops_closing_m = view.closing_mps**2 / np.abs(2.0 * view.own_mps2)
        slower = np.where(view.gap_m < stops_closing_m, 1.0, 0.0)
        return np.where(view.closing_mps <= 0.0, 0.0, np.where(then_mps < 0.0, slower, found))

    def braking_mps2(self, view: View, before_mps2: Numbers, step_s: float) -> Numbers:
        """Return the measure's share of the braking: up to the comfortable one, above it where CFS is."""
        critical = self.critical(view)
        hard = critical * (self.hard_mps2 - self.comfortable_mps2) + self.comfortable_mps2
        wanted = np.where(critical > 0.0, hard, self.proactive(view) * self.comfortable_mps2)
        braking_mps2: Numbers = np.minimum(ramped_mps2(before_mps2, step_s), wanted)
        return braking_mps2

    def following_m(self, speed_mps: Numbers) -> Numbers:
        """Return the gap at which the proactive measure begins to rise."""
        stops_m, leader_stops_m = speed_mps**2 / (2.0 * self.comfortable_mps2), speed_mps**2 / (2.0 * self.leader_mps2)
        gap_m: Numbers = speed_mps * self.delay_s + stops_m - leader_stops_m + self.margin_m + self.standing_gap_m
        return gap_m


def _between(gap_m: Numbers, safe_m: Numbers, unsafe_m: Numbers) -> Numbers:
    """Return 0 above the safe gap, 1 below the unsafe one, and a straight line between them."""
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (gap_m - safe_m) / (unsafe_m - safe_m)
    return np.where(gap_m > safe_m, 0.0, np.where(gap_m < unsafe_m, 1.0, share))
