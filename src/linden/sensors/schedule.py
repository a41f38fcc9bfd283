"""When a sensor measures: its ``sensor_tick`` as Unreal's tick interval has it.

The first frame is due, then every frame that is at least the interval after the last due time. Where frames do not fall
on due times, the overrun is credited to the next (TickTaskManager.cpp), so the mean rate is right; but there is at most
one measurement a frame, and what was missed is not made up for.
"""

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
    if made and now_s < due_s - ROUNDING_S:
        return False, schedule
    following_s = (due_s if made else now_s) + interval_s
    following_s = max(following_s, now_s)  # what was missed stays missed: the next frame is due at once
    return True, Schedule(interval_s, following_s, made + 1)
