"""The cue that a Traffic Manager's thread must not miss: its question comes before its client's tick.

In synchronous mode that thread of the client asks ``get_episode_settings`` once a step, then sleeps until the thread
that ticks has its new frame and wakes it. LibCarla 0.9.16 gives this signal without the lock: one that falls between
the sleeper's last look and its sleep is lost, and both threads wait for each other for ever. CARLA's frames take so
long that the sleeper is always first. Ours take half a millisecond: without this order, one tick in some thousands hung
on a busy machine.
"""

import selectors
import time
from collections.abc import Callable
from dataclasses import dataclass

from linden.server.peers import RpcPeer

QUESTION = "get_episode_settings"
TICK = "tick_cue"

PATIENCE_S = 0.02
"""How long a tick waits for the question: a busy machine's time slices. Without load it is there before the tick."""
SETTLING_S = 0.001
"""What a thread needs from the answer to its sleep, with a margin; the frame's own time comes on top."""


@dataclass(slots=True)
class Cue:
    """How far the Traffic Manager's thread of one client is."""

    answered_s: float | None = None
    """When its question of this step was answered."""
    overdue: bool = False
    """Whether a tick went ahead without a question: the next one belongs to that past step."""

    def answered(self, now_s: float) -> None:
        """Note that a question has been answered."""
        if self.overdue:
            self.overdue = False
        else:
            self.answered_s = now_s

    def settle(self, clock: Callable[[], float]) -> None:
        """Give the thread the time to go to sleep; the tick comes next."""
        if self.answered_s is not None:
            time.sleep(max(0.0, self.answered_s + SETTLING_S - clock()))
        else:
            self.overdue = True
        self.answered_s = None


def hear_question(peer: RpcPeer, clock: Callable[[], float]) -> bool:
    """Read on from a client until its Traffic Manager has asked, and put the question before the waiting tick.

    Returns:
        Whether the question is there, as the next of the client's calls.

    Raises:
        OSError: the client is gone.
    """
    deadline_s = clock() + PATIENCE_S
    with selectors.DefaultSelector() as selector:
        selector.register(peer.socket, selectors.EVENT_READ)
        while (question := next((call for call in peer.calls if call.method == QUESTION), None)) is None:
            left_s = deadline_s - clock()
            if peer.at_end or peer.connection.is_broken or left_s <= 0.0 or not selector.select(left_s):
                return False
            data = peer.read()
            if data:
                peer.calls.extend(peer.connection.receive(data))
            peer.at_end = data == b""
    peer.calls.remove(question)
    peer.calls.appendleft(question)
    return True
