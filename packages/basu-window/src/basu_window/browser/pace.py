"""`Pace` lets a drive run in real time; `Meter` counts its steps."""

from __future__ import annotations

import time
from collections import deque

RATE_S = 2.0
"""Wall time over which rates are taken."""
LATE_S = 0.25
"""A larger lag behind real time is dropped, not caught up."""


class Meter:
    """Counts the steps of the last ``RATE_S``; times are of ``time.perf_counter``."""

    def __init__(self) -> None:
        self._ticks_s: deque[float] = deque()

    def tick(self, now_s: float) -> None:
        """Count a step of the server."""
        self._ticks_s.append(now_s)
        while now_s - self._ticks_s[0] > RATE_S:
            self._ticks_s.popleft()

    @property
    def ticks_per_s(self) -> float:
        """Steps for each second of wall time; 0 before the second step."""
        times_s = self._ticks_s
        return (len(times_s) - 1) / (times_s[-1] - times_s[0]) if len(times_s) > 1 else 0.0


class Pace:
    """Waits so that steps come no faster than real time."""

    def __init__(self) -> None:
        self._due_s: float | None = None

    def wait(self, step_s: float) -> None:
        """Wait until this step's time has come."""
        now_s = time.perf_counter()
        due_s = now_s if self._due_s is None or now_s - self._due_s > LATE_S else self._due_s
        if due_s > now_s:
            time.sleep(due_s - now_s)
        self._due_s = due_s + step_s
