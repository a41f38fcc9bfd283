"""Stop signs: come to rest at the line, let those go who were there first, then go on, once and for all.

::

    APPROACHING ── at rest at the line ──► WAITING ── rested, and the way is clear ──► PASSED
         └─────────────────── already beyond the line ────────────────────────────────────►
"""

from __future__ import annotations

import enum
import math
from typing import TYPE_CHECKING

from basu.agents.builtin.rules.conflicts import crossing, waiting
from basu.agents.builtin.rules.gaps import START_S
from basu.agents.builtin.rules.lines import BEFORE_LINE_M, hold_at, is_resting_at

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.agents.builtin.rules.conflicts import Zone
    from basu.agents.builtin.rules.gaps import GapRule
    from basu.agents.builtin.scene import Ego, Other, Restriction

REST_S = 1.2  # how long one stands at least
COURTESY_S = 4.0  # who was there first and has not moved by then is parked, or waves us on
IMPATIENCE_S = 45.0  # after this a gap that is just long enough will do, so that no stream of cars holds one for ever
BEYOND_M = 1.0  # a bumper this far over the line is in the crossing, where stopping endangers
PULL_AWAY_MPS2 = 0.8  # how it accelerates over the crossing
SHORT_GAP_S = 3.0  # the gap that will do after the patience is spent


class Phase(enum.Enum):
    """Where a driver is with one stop sign."""

    APPROACHING = "approaching"
    WAITING = "waiting"
    PASSED = "passed"


class StopSign:
    """One stop sign on the way; a route that passes it twice has it twice."""

    def __init__(self, line_s_m: float, zone: Zone, body_length_m: float, rule: GapRule | None = None) -> None:
        """Without a ``rule``, a gap is long enough in which ``PULL_AWAY_MPS2`` brings the vehicle through."""
        self.line_s_m = line_s_m
        self.phase = Phase.APPROACHING
        self._zone = zone
        self._rule = rule
        self._way_m = zone.length_m + body_length_m + BEFORE_LINE_M
        self._needed_gap_s = START_S + math.sqrt(2.0 * (zone.length_m + body_length_m) / PULL_AWAY_MPS2)
        self._rest_since_s = 0.0
        self._before_us: frozenset[int] = frozenset()

    def step(self, ego: Ego, front_s_m: float, others: Sequence[Other]) -> Restriction | None:
        """What the sign asks for now; None once it is done with."""
        if self.phase is Phase.APPROACHING and front_s_m > self.line_s_m + BEYOND_M:
            self.phase = Phase.PASSED
        if self.phase is Phase.APPROACHING and is_resting_at(self.line_s_m, front_s_m, ego.speed_mps):
            self.phase = Phase.WAITING
            self._rest_since_s = ego.time_s
            self._before_us = waiting(self._zone, ego, others)
        if self.phase is Phase.WAITING and self._may_go(ego, others):
            self.phase = Phase.PASSED
        return None if self.phase is Phase.PASSED else hold_at(self.line_s_m, front_s_m, "stop sign")

    def _may_go(self, ego: Ego, others: Sequence[Other]) -> bool:
        """Whether one has rested and nobody with a better right is in the way."""
        rested_s = ego.time_s - self._rest_since_s
        if rested_s < REST_S - 1e-6:
            return False
        if self._before_us and rested_s < COURTESY_S:
            self._before_us &= waiting(self._zone, ego, others)  # who has set off is seen as crossing from now on
            if self._before_us:
                return False
        return not crossing(self._zone, ego, others, self._gap_s(rested_s))

    def _gap_s(self, rested_s: float) -> float:
        """How long nobody may come."""
        if self._rule is not None:
            return self._rule.needed_s(self._way_m, 0.0, rested_s)
        return self._needed_gap_s if rested_s < IMPATIENCE_S else min(SHORT_GAP_S, self._needed_gap_s)
