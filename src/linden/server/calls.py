"""Calls of the clients, carried out strictly in the order of each, and by turns between them."""

import logging
import math
import time
from collections.abc import Callable

from linden.errors import ProtocolError
from linden.handlers import registry
from linden.handlers.context import Context
from linden.server.cue import QUESTION, TICK, Cue, hear_question
from linden.server.expected import Expected
from linden.server.peers import RpcPeer
from linden.server.subscribers import Subscribers

log = logging.getLogger("linden")

CALLS_PER_TURN = 256
"""Calls of one client before the others have their turn: a scene's worth of controls, some ms."""
UNREAD_ANSWERS_BYTES = 1024 * 1024
"""A client that leaves more than this unread is not listened to until it has caught up."""

ABOUT_TO_LISTEN = "get_sensor_token"
LOAD = "load_new_episode"
JOINING_S = 0.05
"""What the official client needs from beginning to listen until it may stop again. It drops its stream when it loads an
episode, and a busy client that had asked for that stream just before ends its own process with ``bad_weak_ptr``:
LibCarla's ``streaming::detail::tcp::Client`` is gone before its first message is sent. CARLA's loads take seconds."""


class Calls:
    """What clients have asked for and not yet got.

    Attributes:
        unfinished: those whose calls wait for their turn; an ordered set.
        last_ticker: who made the last frame that was made by a call.
        joined_s: when somebody last began to listen to a stream.
        expected: the streams that somebody is about to listen to.
    """

    def __init__(
        self,
        context: Context,
        subscribers: Subscribers,
        clock: Callable[[], float],
        watch: Callable[[RpcPeer], None],
        close: Callable[[RpcPeer], None],
    ) -> None:
        """``watch`` is told of a client whose state has changed, ``close`` of one that is to go."""
        self._context = context
        self._subscribers = subscribers
        self._clock = clock
        self._watch = watch
        self._close = close
        self.unfinished: dict[RpcPeer, None] = {}
        self.last_ticker: RpcPeer | None = None
        self.joined_s = -math.inf
        self.expected = Expected()
        self._cues: dict[RpcPeer, Cue] = {}  # of those who run a Traffic Manager

    def forget(self, peer: RpcPeer) -> None:
        """Drop what a client that has gone had asked for."""
        peer.calls.clear()
        self.unfinished.pop(peer, None)
        self._cues.pop(peer, None)

    def carry_out(self, peer: RpcPeer) -> None:
        """Carry out a client's calls in their order: some, and the rest at its next turn.

        A client whose last calls are done and who sends nothing more is closed.
        """
        self.unfinished.pop(peer, None)
        answers: list[bytes] = []
        unsent_bytes = 0
        try:
            while peer.calls and len(answers) < CALLS_PER_TURN and not self.must_wait(peer, unsent_bytes):
                if peer.calls[0].method in (QUESTION, TICK) and self._leads_traffic(peer):
                    self._keep_order(peer, answers)
                else:
                    answers.append(self._answer(peer))
                unsent_bytes += len(answers[-1]) if answers else 0
            if answers:
                peer.outgoing.send(b"".join(answers))
            if not peer.calls and peer.connection.is_broken:
                peer.connection.receive(b"")
        except (OSError, ProtocolError) as error:
            log.warning("%s is closed: %s", peer, error)
            self._close(peer)
            return
        if peer.calls:
            self.unfinished[peer] = None
        elif peer.at_end:
            log.debug("%s has left", peer)
            self._close(peer)
            return
        self._watch(peer)

    def _leads_traffic(self, peer: RpcPeer) -> bool:
        owners = self._context.traffic_managers.values()
        return self.is_synchronous() and any(owner == peer.number for _, owner in owners)

    def _keep_order(self, peer: RpcPeer, answers: list[bytes]) -> None:
        """Carry out a tick, or the question before it, of a client that runs a Traffic Manager; see ``server.cue``.

        Raises:
            OSError: the client is gone.
        """
        if answers:
            peer.outgoing.send(b"".join(answers))
            answers.clear()
        cue = self._cues.setdefault(peer, Cue())
        if peer.calls[0].method == TICK:
            if cue.answered_s is None and hear_question(peer, self._clock):
                return
            cue.settle(self._clock)
            answers.append(self._answer(peer))
        else:
            peer.outgoing.send(self._answer(peer))
            cue.answered(self._clock())

    def _answer(self, peer: RpcPeer) -> bytes:
        """Carry out a client's next call."""
        self._context.caller = peer.number
        if peer.calls[0].method == LOAD:
            time.sleep(max(0.0, self.joined_s + JOINING_S - self._clock()))
        if peer.calls[0].method == ABOUT_TO_LISTEN and peer.calls[0].args and type(peer.calls[0].args[0]) is int:
            self.expected.asked(peer.calls[0].args[0], self._clock())
        frame = self._context.simulation.frame
        call = peer.calls.popleft()
        answer = registry.dispatch(self._context, call)
        if not call.is_async and not registry.advances(call):
            self._context.wait_for_the_scene()
        if self._context.simulation.frame != frame:
            self.last_ticker = peer
        self.publish()
        return answer

    def must_wait(self, peer: RpcPeer, unsent_bytes: int = 0) -> bool:
        """Whether a client's next call cannot be carried out yet."""
        return peer.outgoing.waiting_bytes + unsent_bytes > UNREAD_ANSWERS_BYTES or self.waits_for_subscribers(peer)

    def waits_for_subscribers(self, peer: RpcPeer) -> bool:
        """Whether a client's next call makes a frame, for which somebody who lags behind or comes is not ready."""
        return (
            registry.advances(peer.calls[0]) and self.is_synchronous() and self.frame_wait_s(self._clock()) is not None
        )

    def frame_wait_s(self, now_s: float) -> float | None:
        """Return how long synchronous mode's next frame waits at most for subscribers who lag behind or are coming."""
        waits = (self._subscribers.patience_s(now_s), self.expected.wait_s(now_s))
        return min((wait_s for wait_s in waits if wait_s is not None), default=None)

    def is_synchronous(self) -> bool:
        """Whether frames are made by calls alone."""
        return self._context.simulation.settings.synchronous_mode

    def publish(self) -> None:
        """Send what the last call or frame left in the outbox."""
        if not self._context.outbox:
            return
        now_s = self._clock()
        may_drop = not self.is_synchronous()
        for stream_id, payload in self._context.outbox:
            self._subscribers.publish(stream_id, payload, now_s, may_drop=may_drop)
        self._context.outbox.clear()
