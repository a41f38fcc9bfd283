"""The order of answers round a load, for a client that runs Traffic Managers.

When its load is answered, LibCarla's ``Simulator::LoadEpisode`` drops its ``Episode``, asks for the version and for
``get_episode_info``, and makes another. A Traffic Manager in asynchronous mode has a thread that goes on meanwhile and
reads the episode without a look whether there is one: the program ended with a segmentation fault in each of 11 loads.
That thread makes a call every few milliseconds. So the load is answered only when each such thread stands in a call,
and those calls are answered only when the client has its new episode.
"""

import enum
from dataclasses import dataclass

from linden.server.peers import RpcPeer

OF_A_LOAD = ("version", "get_episode_info")
"""What the loading thread calls between the answer to its load and its new episode; the last makes that episode."""

GATHERING_S = 0.2
"""How long a load's answer waits for calls of the Traffic Managers. One in synchronous mode makes none: it sleeps."""
ASKING_S = 2.0
"""How long the calls of Traffic Managers wait for the episode to be asked for."""
SETTLING_S = 0.005
"""What the client needs from the last answer to its new episode, with a margin: it is a few instructions."""


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
