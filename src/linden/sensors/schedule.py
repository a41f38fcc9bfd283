"""When a sensor measures: its ``sensor_tick`` as Unreal's tick interval has it.

The first frame is due, and from there on the first frame in every interval. So where frames do not fall on due times,
the overrun is credited to the next (as TickTaskManager.cpp does) and the mean rate is right. There is at most one
measurement a frame, and what was missed in a long one is not made up for.
"""

import math
from typing import NamedTuple

ROUNDING_S = 1e-6
"""A frame that should fall on a due time counts as on it, whatever the last bits of the sum of steps are."""


class Schedule(NamedTuple):
    """Seconds of simulated time; ``due_s`` is when the next measurement is wanted, ``made`` how many were made."""

    interval_s: float = 0.0
    due_s: float = 0.0
    made: int = 0


def advance(schedule: Schedule, now_s: float) -> tuple[bool, Schedule]:
    """Return whether the frame at ``now_s`` is one of the sensor's, and its schedule after it."""
    interval_s, due_s, made = schedule
    if not made:
        due_s = now_s
    late_s = now_s - due_s + ROUNDING_S
    if late_s < 0.0:
        return False, schedule
    missed = math.floor(late_s / interval_s) if interval_s > 0.0 else 0
    return True, Schedule(interval_s, due_s + (missed + 1) * interval_s, made + 1)
