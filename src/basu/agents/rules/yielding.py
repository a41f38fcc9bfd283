"""Yield signs, as at the entries of a roundabout: go in without stopping where the gap is long enough, else wait."""

from __future__ import annotations

import enum
from typing import TYPE_CHECKING

from basu.agents.driving.comfort import slowing_distance_m
from basu.agents.driving.planner import FIRM
from basu.agents.rules.conflicts import crossing
from basu.agents.rules.lines import BEFORE_LINE_M, hold_at

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.agents.rules.conflicts import Zone
    from basu.agents.scene import Ego, Other, Restriction

LOOK_M = 20.0  # from here on the circulating traffic is watched
ENTRY_MPS = 2.5  # about how fast one goes in
MARGIN_S = 1.5  # kept to the others on top of the time that one needs oneself
SURE_S = 0.5  # after waiting, the gap must have been there for this long


class Phase(enum.Enum):
    """Where a driver is with one yield sign."""

    APPROACHING = "approaching"
    GIVING_WAY = "giving way"
    PASSED = "passed"


class YieldSign:
    """One yield sign on the way."""

    def __init__(self, line_s_m: float, zone: Zone, body_length_m: float) -> None:
        self.line_s_m = line_s_m
        self.phase = Phase.APPROACHING
        self._zone = zone
        self._body_length_m = body_length_m
        self._clear_since_s: float | None = None

    def step(self, ego: Ego, front_s_m: float, others: Sequence[Other]) -> Restriction | None:
        """What the sign asks for now; None where one may go on."""
        left_m = self.line_s_m - front_s_m
        if self.phase is Phase.PASSED or left_m > LOOK_M:
            return None
        if left_m < 0.0 or (self.phase is Phase.APPROACHING and self._is_too_late(left_m, ego.speed_mps)):
            self.phase = Phase.PASSED
            return None
        inside_m = left_m + self._zone.length_m + self._body_length_m
        within_s = inside_m / max(ego.speed_mps, ENTRY_MPS) + MARGIN_S
        if crossing(self._zone, ego, others, within_s):
            self.phase, self._clear_since_s = Phase.GIVING_WAY, None
        elif self.phase is Phase.GIVING_WAY:
            self._clear_since_s = ego.time_s if self._clear_since_s is None else self._clear_since_s
            if ego.time_s - self._clear_since_s >= SURE_S:
                self.phase = Phase.APPROACHING
        return hold_at(self.line_s_m, front_s_m, "yield sign") if self.phase is Phase.GIVING_WAY else None

    @staticmethod
    def _is_too_late(left_m: float, speed_mps: float) -> bool:
        """Whether even firm braking would end beyond the line."""
        return slowing_distance_m(speed_mps, 0.0, 0.0, FIRM) > left_m - BEFORE_LINE_M / 2
