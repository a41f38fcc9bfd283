"""Traffic lights: stop at red, and at yellow where firm braking still does it; a dark one asks for nothing."""

from __future__ import annotations

import enum
from typing import TYPE_CHECKING

from basu.agents.builtin.driving.comfort import slowing_distance_m
from basu.agents.builtin.driving.planner import FIRM
from basu.agents.builtin.rules.lines import BEFORE_LINE_M, hold_at

if TYPE_CHECKING:
    from basu.agents.builtin.scene import Restriction

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
            # decided once, when it turns yellow: who has begun to stop stops, who has not begun does not begin
            if self._drives_through_yellow or self._is_too_late(left_m, speed_mps):
                self._drives_through_yellow = True
                return None
        elif self._drives_through_yellow and self._is_too_late(left_m, speed_mps):
            return None
        return hold_at(self.line_s_m, front_s_m, "traffic light")

    @staticmethod
    def _is_too_late(left_m: float, speed_mps: float) -> bool:
        """Whether even firm braking would end beyond the line."""
        return slowing_distance_m(speed_mps, 0.0, 0.0, FIRM) > left_m - BEFORE_LINE_M / 2
