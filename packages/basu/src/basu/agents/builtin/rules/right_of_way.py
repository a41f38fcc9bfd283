"""Right of way: stop signs and yield signs, each a state machine of its own.

::

    APPROACHING ── at rest at the line ──► WAITING ── rested, and the way is clear ──► PASSED
         └─────────────────── already beyond the line ────────────────────────────────────►

A left turn from a street that has the right of way gives way likewise, to oncoming traffic alone (Ohio Revised Code
4511.42).
"""

from __future__ import annotations

import enum
import math
from typing import TYPE_CHECKING

from basu.agents.builtin.rules.gap_acceptance import START_S, crossing, waiting
from basu.agents.builtin.rules.stopping_lines import BEFORE_LINE_M, hold_at, is_resting_at, is_too_late

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.agents.builtin.rules.gap_acceptance import GapRule, Zone
    from basu.agents.builtin.scene import DrivenVehicle, Other, Restriction


REST_S = 1.2  # how long one stands at least
COURTESY_S = 4.0  # an actor that was there first and has not moved by then is parked, or waves us on
IMPATIENCE_S = 45.0  # after this a gap that is just long enough will do, so that no stream of cars holds one for ever
BEYOND_M = 1.0  # a bumper this far over the line is in the crossing, where stopping endangers
PULL_AWAY_MPS2 = 0.8  # how it accelerates over the crossing
SHORT_GAP_S = 3.0  # the gap that will do after the patience is spent


class StopPhase(enum.Enum):
    """Where a driver is with one stop sign."""

    APPROACHING = "approaching"
    WAITING = "waiting"
    PASSED = "passed"


class StopSign:
    """One stop sign on the way; a route that passes it twice has it twice."""

    def __init__(self, line_s_m: float, zone: Zone, body_length_m: float, rule: GapRule | None = None) -> None:
        """Without a ``rule``, a gap is long enough in which ``PULL_AWAY_MPS2`` brings the vehicle through."""
        self.line_s_m = line_s_m
        self.phase = StopPhase.APPROACHING
        self._zone = zone
        self._rule = rule
        self._way_m = zone.length_m + body_length_m + BEFORE_LINE_M
        self._needed_gap_s = START_S + math.sqrt(2.0 * (zone.length_m + body_length_m) / PULL_AWAY_MPS2)
        self._rest_since_s = 0.0
        self._before_us: frozenset[int] = frozenset()

    def step(self, ego: DrivenVehicle, front_s_m: float, others: Sequence[Other]) -> Restriction | None:
        """What the sign asks for now; None once it is done with."""
        if self.phase is StopPhase.APPROACHING and front_s_m > self.line_s_m + BEYOND_M:
            self.phase = StopPhase.PASSED
        if self.phase is StopPhase.APPROACHING and is_resting_at(self.line_s_m, front_s_m, ego.speed_mps):
            self.phase = StopPhase.WAITING
            self._rest_since_s = ego.time_s
            self._before_us = waiting(self._zone, ego, others)
        if self.phase is StopPhase.WAITING and self._may_go(ego, others):
            self.phase = StopPhase.PASSED
        return None if self.phase is StopPhase.PASSED else hold_at(self.line_s_m, front_s_m, "stop sign")

    def _may_go(self, ego: DrivenVehicle, others: Sequence[Other]) -> bool:
        """Whether the vehicle has rested and no actor with a better right is in the way."""
        rested_s = ego.time_s - self._rest_since_s
        if rested_s < REST_S - 1e-6:
            return False
        if self._before_us and rested_s < COURTESY_S:
            self._before_us &= waiting(self._zone, ego, others)  # an actor that sets off counts as crossing from now on
            if self._before_us:
                return False
        return not crossing(self._zone, ego, others, self._gap_s(rested_s))

    def _gap_s(self, rested_s: float) -> float:
        """Return the time in s for which the crossing has to stay free."""
        if self._rule is not None:
            return self._rule.needed_s(self._way_m, 0.0, rested_s)
        return self._needed_gap_s if rested_s < IMPATIENCE_S else min(SHORT_GAP_S, self._needed_gap_s)


LOOK_M = 20.0  # from here on the circulating traffic is watched
ARRIVED_MPS = 0.3  # slower than this one waits
ENTRY_MPS = 2.5  # about how fast one goes in
MARGIN_S = 1.5  # kept to the others on top of the time that one needs oneself
SURE_S = 0.5  # after waiting, the gap must have been there for this long
ONCOMING_RAD = math.radians(120.0)  # off our own heading


class YieldPhase(enum.Enum):
    """Where a driver is with one yield sign."""

    APPROACHING = "approaching"
    GIVING_WAY = "giving way"
    PASSED = "passed"


class YieldSign:
    """One yield sign on the way."""

    def __init__(
        self,
        line_s_m: float,
        zone: Zone,
        body_length_m: float,
        rule: GapRule | None = None,
        oncoming_to_rad: float | None = None,
    ) -> None:
        """Give way at a line.

        Args:
            line_s_m: along the path.
            zone: what is crossed behind the line.
            body_length_m: of the own vehicle.
            rule: which gap will do; without one, that in which the entry is driven at ``ENTRY_MPS``.
            oncoming_to_rad: the path's heading at the line, where oncoming actors alone count.
        """
        self.line_s_m = line_s_m
        self.phase = YieldPhase.APPROACHING
        self._zone = zone
        self._body_length_m = body_length_m
        self._rule = rule
        self._oncoming_to_rad = oncoming_to_rad
        self._arrived_at_s: float | None = None
        self._clear_since_s: float | None = None

    def step(self, ego: DrivenVehicle, front_s_m: float, others: Sequence[Other]) -> Restriction | None:
        """What the sign asks for now; None where one may go on."""
        left_m = self.line_s_m - front_s_m
        if self.phase is YieldPhase.PASSED or left_m > LOOK_M:
            return None
        if left_m < 0.0 or (self.phase is YieldPhase.APPROACHING and is_too_late(left_m, ego.speed_mps)):
            self.phase = YieldPhase.PASSED
            return None
        if crossing(self._zone, ego, self._heeded(others), self._within_s(ego, left_m)):
            self.phase, self._clear_since_s = YieldPhase.GIVING_WAY, None
        elif self.phase is YieldPhase.GIVING_WAY:
            self._clear_since_s = ego.time_s if self._clear_since_s is None else self._clear_since_s
            if ego.time_s - self._clear_since_s >= SURE_S:
                self.phase = YieldPhase.APPROACHING
        return hold_at(self.line_s_m, front_s_m, self._reason) if self.phase is YieldPhase.GIVING_WAY else None

    @property
    def _reason(self) -> str:
        """What the waiting is owed to."""
        return "yield sign" if self._oncoming_to_rad is None else "left turn"

    def _heeded(self, others: Sequence[Other]) -> Sequence[Other]:
        """The actors with a better right."""
        if self._oncoming_to_rad is None:
            return others
        heading_rad = self._oncoming_to_rad
        return [o for o in others if abs(math.remainder(o.yaw_rad - heading_rad, math.tau)) > ONCOMING_RAD]

    def _within_s(self, ego: DrivenVehicle, left_m: float) -> float:
        """How long the crossing has to stay free, in s."""
        inside_m = left_m + self._zone.length_m + self._body_length_m
        if self._rule is None:
            return inside_m / max(ego.speed_mps, ENTRY_MPS) + MARGIN_S
        if self._arrived_at_s is None and ego.speed_mps < ARRIVED_MPS:
            self._arrived_at_s = ego.time_s
        waited_s = 0.0 if self._arrived_at_s is None else ego.time_s - self._arrived_at_s
        return self._rule.needed_s(inside_m, ego.speed_mps, waited_s)
