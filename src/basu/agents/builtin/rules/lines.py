"""What stop signs, yield signs and lights have in common: a line that the front bumper is not to cross yet."""

from __future__ import annotations

from basu.agents.builtin.scene import Restriction, Urgency

BEFORE_LINE_M = 0.7  # where the front bumper comes to rest
AT_LINE_M = 1.6  # a bumper that rests farther from the line than this has not stopped at it
REST_MPS = 0.05  # slower is standing


def hold_at(line_s_m: float, front_s_m: float, reason: str) -> Restriction:
    """Stop before the line. Both places are arc lengths along the path."""
    return Restriction(line_s_m - BEFORE_LINE_M - front_s_m, 0.0, Urgency.FIRM, reason)


def is_resting_at(line_s_m: float, front_s_m: float, speed_mps: float) -> bool:
    """Whether the vehicle stands with its front bumper at the line."""
    return abs(speed_mps) < REST_MPS and line_s_m - front_s_m <= AT_LINE_M
