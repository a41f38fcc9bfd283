"""Service stops: halt where the passengers wait, stand for the dwell time, go on."""

from __future__ import annotations

import enum
from typing import TYPE_CHECKING

from basu.agents.builtin.rules.lines import REST_MPS
from basu.agents.builtin.scene import Restriction, Urgency
from basu.metrics.arrival import serves

if TYPE_CHECKING:
    from basu.agents.builtin.scene import Ego

DWELL_S = 10.0


class Phase(enum.Enum):
    """Where a driver is with one service stop."""

    APPROACHING = "approaching"
    DWELLING = "dwelling"
    LEFT = "left"


class ServiceStop:
    """One service stop on the way; the vehicle's origin, where its door is, halts at ``s_m``.

    The stop is served as `basu.metrics.arrival` defines it, so a driver never waits for what already counts.
    """

    def __init__(self, s_m: float, name: str, dwell_s: float = DWELL_S) -> None:
        self.s_m = s_m
        self.name = name
        self.phase = Phase.APPROACHING
        self._dwell_s = dwell_s
        self._halted_at_s = 0.0

    def step(self, ego: Ego, ego_s_m: float) -> Restriction | None:
        """What the stop asks for now; None once it has been served."""
        left_m = self.s_m - ego_s_m
        stands = abs(ego.speed_mps) < REST_MPS  # the doors open at a standstill, below what the metric calls rest
        if self.phase is Phase.APPROACHING and stands and serves(left_m, ego.speed_mps):
            self.phase, self._halted_at_s = Phase.DWELLING, ego.time_s
        if self.phase is Phase.DWELLING and ego.time_s - self._halted_at_s >= self._dwell_s - 1e-6:
            self.phase = Phase.LEFT
        if self.phase is Phase.LEFT:
            return None
        return Restriction(left_m, 0.0, Urgency.GENTLE, f"service stop {self.name}")
