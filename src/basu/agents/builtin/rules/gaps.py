"""Which gap in the traffic of others is long enough to cross it or to join it: critical headways, and one's own time.

Whatever the critical headway of the handbook says, a slow vehicle needs the time that it takes to leave the crossing
behind; the longer of the two counts. Who has waited past all patience takes a gap of the bare time of the crossing.
"""

from __future__ import annotations

import enum
import math
from typing import TYPE_CHECKING, NamedTuple

from basu.agents.builtin.driving.manner import LEFT_FROM_MINOR_S, RIGHT_FROM_MINOR_S, THROUGH_FROM_MINOR_S

if TYPE_CHECKING:
    from basu.agents.builtin.driving.manner import Gaps, Manner
    from basu.agents.builtin.driving.path import Path

START_S = 1.5  # from the decision until the vehicle really moves, with a margin
USED_SHARE = 0.8  # of the comfortable acceleration that is there on average: it has to build up first
TURN_RAD = math.radians(45.0)  # a way that turns by less than this goes through


class Movement(enum.Enum):
    """What a way does in a junction; the value is the critical headway of one who comes from a minor street, s."""

    LEFT = LEFT_FROM_MINOR_S
    THROUGH = THROUGH_FROM_MINOR_S
    RIGHT = RIGHT_FROM_MINOR_S


def movement(path: Path, from_s_m: float, to_s_m: float) -> Movement:
    """What the path does between two arc lengths."""
    turn_rad = path.heading_at_rad(to_s_m) - path.heading_at_rad(from_s_m)
    if abs(turn_rad) < TURN_RAD:
        return Movement.THROUGH
    return Movement.LEFT if turn_rad < 0.0 else Movement.RIGHT


def time_to_cover_s(distance_m: float, speed_mps: float, accel_mps2: float, top_mps: float) -> float:
    """Seconds for a distance, speeding up evenly to ``top_mps`` and no further; who is faster keeps its speed."""
    if distance_m <= 0.0:
        return 0.0
    speed_mps = max(speed_mps, 0.0)
    top_mps = max(top_mps, speed_mps, 0.1)
    rise_m = (top_mps * top_mps - speed_mps * speed_mps) / (2.0 * accel_mps2)
    if distance_m <= rise_m:
        return (math.sqrt(speed_mps * speed_mps + 2.0 * accel_mps2 * distance_m) - speed_mps) / accel_mps2
    return (top_mps - speed_mps) / accel_mps2 + (distance_m - rise_m) / top_mps


class GapRule(NamedTuple):
    """What one vehicle accepts at one line."""

    critical_s: float  # the handbook's headway times the manner's factor
    margin_s: float
    patience_s: float
    accel_mps2: float  # with which it crosses …
    top_mps: float  # … up to this speed

    def needed_s(self, distance_m: float, speed_mps: float, waited_s: float) -> float:
        """Until nobody may come: ``distance_m`` from the rear bumper here to its having left the crossing."""
        start_s = START_S if speed_mps < 1.0 else 0.0
        own_s = start_s + time_to_cover_s(distance_m, speed_mps, self.accel_mps2, self.top_mps)
        return own_s if waited_s > self.patience_s else max(self.critical_s, own_s + self.margin_s)


def make_rule(gaps: Gaps, manner: Manner, critical_s: float, top_mps: float) -> GapRule:
    """The rule at a line behind which one drives ``top_mps`` at most."""
    accel_mps2 = USED_SHARE * manner.comfort.accel_mps2
    return GapRule(gaps.factor * critical_s, gaps.margin_s, gaps.patience_s, accel_mps2, top_mps)
