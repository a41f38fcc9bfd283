"""The times of frames in asynchronous mode, and the length of variable steps. The caller passes the time.

With a fixed step the frames keep real time, one step each. (The original runs as fast as it can, which is too fast for
driving by hand.) With a variable step there are :data:`VARIABLE_HZ` frames a second. A step is as long as the time
since the last one, at most :data:`LONGEST_STEP_S`. A server that cannot keep up makes frames one after the other and
lets simulated time fall behind; it never makes up for them in a burst.
"""

import math

VARIABLE_HZ = 30.0
"""Frames per second with a variable step: as smooth as manual driving needs, and little work for an idle server."""
LONGEST_STEP_S = 0.1
"""What CARLA's default substeps cover (10 of 0.01 s); after a pause the world goes on instead of jumping."""
SHORTEST_STEP_S = 1e-4
"""So that two ticks in a row have a step above zero between them."""


class FrameClock:
    """The rhythm of one server. All times in s of one steady clock.

    Attributes:
        speed: simulated seconds per second; above zero.
        is_paused: whether frames come by :meth:`one_step` only.
    """

    def __init__(self, now_s: float) -> None:
        self.speed, self.is_paused = 1.0, False
        self._steps_due = 0
        self._last_frame_s = now_s
        self._beat_s = now_s  # the last frame's time by the rhythm, from which the next one counts

    def wait_s(self, now_s: float, fixed_delta_s: float | None) -> float:
        """Return how long it is until the next frame is due; 0 where it is, inf while the world is paused."""
        if self._steps_due:
            return 0.0
        if self.is_paused:
            return math.inf
        return max(0.0, self._beat_s + _period_s(fixed_delta_s) / self._rate(fixed_delta_s) - now_s)

    def one_step(self) -> None:
        """Let one frame be made at once, though the world is paused."""
        self._steps_due += 1

    def _rate(self, fixed_delta_s: float | None) -> float:
        """Return how many times more often frames come; variable steps become longer or shorter instead."""
        return 1.0 if fixed_delta_s is None else self.speed

    def variable_step_s(self, now_s: float) -> float:
        """Return the length of a variable step that is made now."""
        return min(max((now_s - self._last_frame_s) * self.speed, SHORTEST_STEP_S), LONGEST_STEP_S)

    def frame_made(self, now_s: float, fixed_delta_s: float | None) -> None:
        """Note that a frame begins now; one that is late by less than a period keeps the rhythm."""
        self._steps_due = max(0, self._steps_due - 1)
        period_s = _period_s(fixed_delta_s) / self._rate(fixed_delta_s)
        on_time_s = self._beat_s + period_s
        self._beat_s = on_time_s if 0.0 <= now_s - on_time_s < period_s else now_s
        self._last_frame_s = now_s


def _period_s(fixed_delta_s: float | None) -> float:
    return 1.0 / VARIABLE_HZ if fixed_delta_s is None else fixed_delta_s
