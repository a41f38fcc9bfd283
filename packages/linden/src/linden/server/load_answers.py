"""`LoadAnswers`: delays a map load's answer until Traffic Manager threads are blocked in calls, so no client crashes.

When its load is answered, LibCarla's ``Simulator::LoadEpisode`` drops its ``Episode``, asks for the version and for
``get_episode_info``, and makes another. A Traffic Manager in asynchronous mode has a thread that goes on meanwhile and
reads the episode without a look whether there is one: the program ended with a segmentation fault in each of 11 loads.
That thread makes a call every few milliseconds. So the load is answered only when each such thread stands in a call,
and those calls are answered only when the client has its new episode.
"""

import enum
import math
from dataclasses import dataclass

from linden.protocol.wire.rpc import Call
from linden.server.peers import RpcPeer
from linden.server.rpc.context import Context

LOAD = "load_new_episode"
OF_A_LOAD = ("version", "get_episode_info")
"""What the loading thread calls between the answer to its load and its new episode; the last makes that episode."""

GATHERING_S = 0.2
"""How long a load's answer waits for calls of the Traffic Managers. One in synchronous mode makes none: it sleeps."""
ASKING_S = 2.0
"""How long the calls of Traffic Managers wait for the episode to be asked for."""
SETTLING_S = 0.005
"""What the client needs from the last answer to its new episode, with a margin: it is a few instructions."""
LOADING_S = 0.5
"""How long an answered load waits for its client to ask which episode there is."""


class Phase(enum.Enum):
    """How far a load has come for its client."""

    GATHERING = enum.auto()
    ASKING = enum.auto()
    SETTLING = enum.auto()


@dataclass(slots=True)
class LoadAnswers:
    """The load of one client. All times in s of one steady clock."""

    answer: bytes
    threads: int  # Traffic Managers of the client
    until_s: float
    phase: Phase = Phase.GATHERING

    def waits(self, peer: RpcPeer, now_s: float) -> bool:
        """Return whether the client's next call has to wait; ``peer.calls`` begins with the load while gathering."""
        if now_s >= self.until_s:
            return False
        if self.phase is Phase.GATHERING:
            return sum(not call.is_async for call in peer.calls) <= self.threads
        return self.phase is Phase.SETTLING or not any(call.method in OF_A_LOAD for call in peer.calls)

    def answered(self, now_s: float) -> bytes:
        """Return the load's answer; from now on the client asks for its episode."""
        self.phase, self.until_s = Phase.ASKING, now_s + ASKING_S
        return self.answer

    def bring_forward(self, peer: RpcPeer, now_s: float) -> bool:
        """Put the loading thread's next call before those of the Traffic Managers; False where there is none."""
        method = peer.bring_forward(OF_A_LOAD)
        if method == OF_A_LOAD[-1]:
            self.phase, self.until_s = Phase.SETTLING, now_s + SETTLING_S
        return method is not None


class AnsweredLoad:
    """Begins the load that has been answered, before a call or frame that has to find the new episode."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._until_s = math.inf  # when it begins in any case

    def answered(self) -> None:
        """Note that a load is about to be answered: the wait for its client begins anew."""
        self._until_s = math.inf

    def begin_before(self, peer: RpcPeer, call: Call, now_s: float) -> None:
        """Begin an answered load before a call that has to find the new episode.

        The client that loads asks for the version and the present episode first. Others go on in that episode
        meanwhile, but not for long.
        """
        pending = self._context.pending_load
        if pending is None:
            return
        is_due = self.is_due(now_s)
        if peer.number != pending.client:
            if is_due:
                self._context.begin_pending_load()
        elif call.method not in OF_A_LOAD:
            self._context.begin_pending_load()
        elif call.method == OF_A_LOAD[-1]:
            self._until_s = now_s

    def is_due(self, now_s: float) -> bool:
        """Return whether an answered load begins before the next frame that is made by the clock."""
        if self._context.pending_load is None:
            return False
        if self._until_s == math.inf:
            self._until_s = now_s + LOADING_S
        return now_s >= self._until_s
