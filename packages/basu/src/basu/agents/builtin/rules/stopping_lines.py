"""Lines to stop at: their common state, traffic lights and service stops."""

from __future__ import annotations

import enum
from typing import TYPE_CHECKING

from basu.agents.builtin.driving.manner import slowing_distance_m
from basu.agents.builtin.driving.planner import FIRM
from basu.agents.builtin.scene import Restriction, Urgency
from basu.metrics.path_following import serves
from basu.thresholds import STANDSTILL_MPS

if TYPE_CHECKING:
    from basu.agents.builtin.scene import DrivenVehicle


BEFORE_LINE_M = 0.7  # where the front bumper comes to rest
AT_LINE_M = 1.6  # a bumper that rests farther from the line than this has not stopped at it


def hold_at(line_s_m: float, front_s_m: float, reason: str) -> Restriction:
    """Stop before the line. Both places are arc lengths along the path."""
    return Restriction(line_s_m - BEFORE_LINE_M - front_s_m, 0.0, Urgency.FIRM, reason)


def is_resting_at(line_s_m: float, front_s_m: float, speed_mps: float) -> bool:
    """Whether the vehicle stands with its front bumper at the line."""
    return abs(speed_mps) < STANDSTILL_MPS and line_s_m - front_s_m <= AT_LINE_M


LOOK_M = 60.0  # a light is obeyed from here on


class Light(enum.Enum):
    """What a traffic light shows."""

    GREEN = "green"
    YELLOW = "yellow"
    RED = "red"
    DARK = "dark"


class TrafficLight:
    """One traffic light on the way."""

    def __init__(self, line_s_m: float, landmark_id: str) -> None:
        self.line_s_m = line_s_m
        self.landmark_id = landmark_id
        self._drives_through_yellow = False

    def step(self, shows: Light, front_s_m: float, speed_mps: float) -> Restriction | None:
        """What the light asks for now."""
        left_m = self.line_s_m - front_s_m
        if not 0.0 <= left_m <= LOOK_M:
            return None
        if shows in (Light.GREEN, Light.DARK):
            self._drives_through_yellow = False
            return None
        if shows is Light.YELLOW:
            # decided once, when it turns yellow: a stop that has begun goes on, and none begins later
            if self._drives_through_yellow or is_too_late(left_m, speed_mps):
                self._drives_through_yellow = True
                return None
        elif self._drives_through_yellow and is_too_late(left_m, speed_mps):
            return None
        return hold_at(self.line_s_m, front_s_m, "traffic light")


def is_too_late(left_m: float, speed_mps: float) -> bool:
    """Return whether even firm braking would end beyond the line."""
    return slowing_distance_m(speed_mps, 0.0, 0.0, FIRM) > left_m - BEFORE_LINE_M / 2


DWELL_S = 10.0


class ServicePhase(enum.Enum):
    """Where a driver is with one service stop."""

    APPROACHING = "approaching"
    DWELLING = "dwelling"
    LEFT = "left"


class ServiceStop:
    """One service stop on the way; the vehicle's origin, where its door is, halts at ``s_m`` for ``dwell_s``.

    The stop is served as `basu.metrics.path_following` defines it, so a driver never waits for what already counts.
    """

    def __init__(self, s_m: float, name: str, dwell_s: float = DWELL_S) -> None:
        self.s_m = s_m
        self.name = name
        self.phase = ServicePhase.APPROACHING
        self.dwell_s = dwell_s
        self._halted_at_s = 0.0

    def step(self, ego: DrivenVehicle, ego_s_m: float) -> Restriction | None:
        """What the stop asks for now; None once it has been served."""
        left_m = self.s_m - ego_s_m
        stands = abs(ego.speed_mps) < STANDSTILL_MPS  # the doors open at a standstill, below what the metric calls rest
        if self.phase is ServicePhase.APPROACHING and stands and serves(left_m, ego.speed_mps):
            self.phase, self._halted_at_s = ServicePhase.DWELLING, ego.time_s
        if self.phase is ServicePhase.DWELLING and ego.time_s - self._halted_at_s >= self.dwell_s - 1e-6:
            self.phase = ServicePhase.LEFT
        if self.phase is ServicePhase.LEFT:
            return None
        return Restriction(left_m, 0.0, Urgency.GENTLE, f"service stop {self.name}")
