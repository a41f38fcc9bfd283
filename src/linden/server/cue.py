"""Delay of the answer to a tick until the thread of the client's Traffic Manager has made its next call.

In synchronous mode that thread of the client asks ``get_episode_settings`` once a step, then sleeps until the thread
that ticks has its new frame and wakes it. LibCarla 0.9.16 gives this signal without the lock: one that falls between
the sleeper's last look and its sleep is lost, and both threads wait for each other for ever. CARLA's frames take so
long that the sleeper is always first. Ours take half a millisecond: without this order, one tick in some thousands hung
on a busy machine.

The frame is made at once, and shown; only the answer to the tick waits, without which the client wakes no thread. The
wait is a state of the server's loop: other clients are served meanwhile.

On a machine with more runnable programs than cores, the sleeper may lose its core just before it sleeps. There the
answer waits longer: the other programs use the cores meanwhile.
"""

import math
import os
from dataclasses import dataclass

from linden.server.peers import RpcPeer

QUESTION = "get_episode_settings"
TICK = "tick_cue"

PATIENCE_S = 0.02
"""How long a tick's answer waits for the question: a busy machine's time slices. Else it is there before the tick."""
SETTLING_S = 0.001
"""What a thread needs from the answer to its sleep: 0.1 ms, with a margin. The frame's own time is part of it."""
MOST_SETTLING_S = 0.02
"""The same at the highest load: more than a time slice of the system."""
UNLOADED = 1.0
"""Runnable programs a core of a machine that is busy and not overloaded: a server and its client on two cores."""
LOAD_LASTS_S = 1.0
"""How long a reading of the load is used."""
MOST_LATE = 2
"""Ticks in a row that waited in vain. Then none waits: the Traffic Manager is not in synchronous mode."""
TRUSTED_AGAIN = 50
"""Ticks in a row, each with its question before it, after which ticks wait for the question again."""


def settling_s(load: float, cores: int) -> float:
    """Return the wait after the question's answer, in s, at a load average of ``load`` runnable programs."""
    a_core = load / cores
    return min(MOST_SETTLING_S, SETTLING_S * max(1.0, a_core - UNLOADED) ** 2)


class Load:
    """The wait for the machine's present load, read at most once a second."""

    def __init__(self) -> None:
        self._settling_s, self._read_s = SETTLING_S, -math.inf

    def settling_s(self, now_s: float) -> float:
        """Return the wait, in s; ``now_s``: time of a steady clock."""
        if now_s - self._read_s >= LOAD_LASTS_S:
            self._read_s = now_s
            if hasattr(os, "getloadavg"):  # not on every system
                self._settling_s = settling_s(os.getloadavg()[0], os.cpu_count() or 1)
        return self._settling_s


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
    settling_s: float = SETTLING_S
    """How long it waits after the question's answer."""
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
        return self.until_s if self.answered_s is None else self.answered_s + self.settling_s

    def answered(self, now_s: float, settling_s: float = SETTLING_S) -> None:
        """Note that a question has been answered, and how long its thread may take to sleep."""
        if self.overdue:
            self.overdue = False
        else:
            self.answered_s, self.settling_s = now_s, settling_s

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
