"""The cue that a Traffic Manager's thread must not miss: its question comes before its client's tick.

In synchronous mode that thread of the client asks ``get_episode_settings`` once a step, then sleeps until the thread
that ticks has its new frame and wakes it. LibCarla 0.9.16 gives this signal without the lock: one that falls between
the sleeper's last look and its sleep is lost, and both threads wait for each other for ever. CARLA's frames take so
long that the sleeper is always first. Ours take half a millisecond: without this order, one tick in some thousands hung
on a busy machine.

Both waits are states of the server's loop: other clients are served meanwhile.
"""

from dataclasses import dataclass

from linden.server.peers import RpcPeer

QUESTION = "get_episode_settings"
TICK = "tick_cue"

PATIENCE_S = 0.02
"""How long a tick waits for the question: a busy machine's time slices. Without load it is there before the tick."""
SETTLING_S = 0.001
"""What a thread needs from the answer to its sleep, with a margin; the frame's own time comes on top."""
MOST_LATE = 2
"""Ticks in a row that waited in vain. Then no tick waits: the Traffic Manager is not in synchronous mode."""
TRUSTED_AGAIN = 50
"""Ticks in a row, each with its question before it, after which ticks wait for the question again."""


@dataclass(slots=True)
class Cue:
    """How far the Traffic Manager's thread of one client is. All times in s of one steady clock."""

    answered_s: float | None = None
    """When its question of this step was answered."""
    overdue: bool = False
    """Whether a tick went ahead without a question: the next one belongs to that past step."""
    until_s: float | None = None
    """Until when the tick that is due waits for the question."""
    late: int = 0
    on_time: int = 0

    def waits(self, peer: RpcPeer, now_s: float) -> bool:
        """Return whether the tick that is the first of the client's calls has to wait.

        It does not where the Traffic Manager's thread stands in another call, which comes after the tick: a Traffic
        Manager in synchronous mode calls nothing between the end of its step and its question.
        """
        if self.answered_s is not None:
            return now_s < self.answered_s + SETTLING_S
        if self.late >= MOST_LATE or any(not call.is_async for call in list(peer.calls)[1:]):
            return False
        if self.until_s is None:
            self.until_s = now_s + PATIENCE_S
        return now_s < self.until_s

    @property
    def deadline_s(self) -> float | None:
        """When the present wait is over in any case, None where there is none."""
        return self.until_s if self.answered_s is None else self.answered_s + SETTLING_S

    def answered(self, now_s: float) -> None:
        """Note that a question has been answered."""
        self.until_s = None
        if self.overdue:
            self.overdue = False
        else:
            self.answered_s = now_s

    def ticked(self) -> None:
        """Note that the tick is carried out."""
        if self.answered_s is None:
            self.overdue, self.on_time = True, 0
            self.late = min(self.late + 1, MOST_LATE)
        else:
            self.on_time += 1
            if self.late < MOST_LATE or self.on_time >= TRUSTED_AGAIN:
                self.late = 0
        self.answered_s = self.until_s = None


def bring_question_forward(peer: RpcPeer) -> bool:
    """Put the Traffic Manager's question before the tick that waits; False where it is not there."""
    question = next((call for call in peer.calls if call.method == QUESTION), None)
    if question is None:
        return False
    peer.calls.remove(question)
    peer.calls.appendleft(question)
    return True
