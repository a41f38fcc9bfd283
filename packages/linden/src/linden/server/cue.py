"""`Cue`: delays a tick's answer until the client's Traffic Manager thread sleeps, else LibCarla loses a wake-up.

In synchronous mode that thread of the client asks ``get_episode_settings`` once a step, then sleeps until the thread
that ticks has its new frame and wakes it. LibCarla 0.9.16 gives this signal without the lock: one that falls between
the sleeper's last look and its sleep is lost, and both threads wait for each other for ever. CARLA's frames take so
long that the sleeper is always first. Ours take half a millisecond: without this order, one tick in some thousands hung
on a busy machine.

The frame is made at once, and shown; only the answer to the tick waits, without which the client wakes no thread. The
wait is a state of the server's loop: other clients are served meanwhile.

The wait after the question is :data:`SETTLING_S`, whatever the machine and its load. A wait of 0.25 to 1 ms by the
thread's own pace was tried and taken out. On a busy machine the wake fell close to the sleep two to eleven times as
often (docs/decisions/0089).
"""

import math
from dataclasses import dataclass

from linden.server.peers import RpcPeer

QUESTION = "get_episode_settings"
TICK = "tick_cue"

PATIENCE_S = 0.02
"""How long a tick's answer waits for the question: a busy machine's time slices. Else it is there before the tick."""
SETTLING_S = 0.001
"""What a thread is left from the answer to its sleep: it needs a core and 0.1 ms. The frame's time is part of it."""
MOST_LATE = 2
"""Ticks in a row that waited in vain. Then none waits: the Traffic Manager is not in synchronous mode."""
TRUSTED_AGAIN = 50
"""Ticks in a row, each with its question before it, after which ticks wait for the question again."""


@dataclass(slots=True)
class Cue:
    """How far the Traffic Manager's thread of one client is. All times in s of one steady clock."""

    answered_s: float | None = None
    """When its question of this step was answered."""
    overdue: bool = False
    """Whether a tick was answered without a question: the next one belongs to that past step."""
    tick: bytes = b""
    """The answer of a tick that is carried out and waits; empty where none does."""
    until_s: float = -math.inf
    """Until when that answer waits for the question."""
    late: int = 0
    on_time: int = 0

    def ticked(self, answer: bytes, now_s: float) -> None:
        """Note that the tick is carried out."""
        self.tick = answer
        self.until_s = now_s + PATIENCE_S if self.late < MOST_LATE else now_s

    def waits(self, peer: RpcPeer, now_s: float) -> bool:
        """Return whether there is nothing to do yet but wait; the tick is the first of the client's calls.

        A question is to be answered. The tick is, where the Traffic Manager's thread stands in another call behind it:
        a Traffic Manager in synchronous mode calls nothing between the end of its step and its question.
        """
        behind = [call.method for call in list(peer.calls)[1:] if not call.is_async]
        has_come = QUESTION in behind if self.answered_s is not None else behind
        return not has_come and now_s < self.deadline_s

    @property
    def deadline_s(self) -> float:
        """When the present wait is over in any case."""
        return self.until_s if self.answered_s is None else self.answered_s + SETTLING_S

    def answered(self, now_s: float) -> None:
        """Note that a question has been answered."""
        if self.overdue:
            self.overdue = False
        else:
            self.answered_s = now_s

    def finish(self) -> bytes:
        """Return the tick's answer, for the client, and begin the next step."""
        answer, self.tick = self.tick, b""
        if self.answered_s is None:
            self.overdue, self.on_time = True, 0
            self.late = min(self.late + 1, MOST_LATE)
        else:
            self.on_time += 1
            if self.late < MOST_LATE or self.on_time >= TRUSTED_AGAIN:
                self.late = 0
        self.answered_s = None
        return answer
