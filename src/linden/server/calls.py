"""Calls of the clients, carried out strictly in the order of each, and by turns between them."""

import logging
import math
import time
from collections.abc import Callable

from linden.errors import ProtocolError
from linden.handlers import registry
from linden.handlers.context import Context
from linden.handlers.registry import Unanswered
from linden.server.cue import QUESTION, TICK, Cue, hear_question
from linden.server.expected import Expected
from linden.server.peers import RpcPeer
from linden.server.subscribers import Subscribers
from linden.wire.rpc import Call
from linden.wire.stream import WORLD_OBSERVER_ID

log = logging.getLogger("linden")

CALLS_PER_TURN = 256
"""Calls of one client before the others have their turn: a scene's worth of controls, some ms."""
UNREAD_ANSWERS_BYTES = 1024 * 1024
"""A client that leaves more than this unread is not listened to until it has caught up."""

SCENE_S = 0.8
"""How long an answer waits at most for the scene that sensors look at: so each of the calls that lead to a first
picture waits a little, rather than the tick all the time. CARLA's examples give a call two seconds, and two may
stand in line, the Traffic Manager's behind the program's own."""

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
        wake: Callable[[], None],
    ) -> None:
        """``watch`` is told of a client whose state has changed, ``close`` of one that is to go.

        ``wake`` lets the server look at what is unfinished; other threads call it.
        """
        self._wake = wake
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
        self._working: dict[RpcPeer, Unanswered] = {}  # whose call has work in the background
        self._held: dict[RpcPeer, tuple[bytes, float]] = {}  # answers that wait for the scene, and until when

    def forget(self, peer: RpcPeer) -> None:
        """Drop what a client that has gone had asked for."""
        peer.calls.clear()
        self.unfinished.pop(peer, None)
        self._cues.pop(peer, None)
        self._working.pop(peer, None)  # what it asked for is made, and nobody gets it
        self._held.pop(peer, None)
        self.expected.forget(peer.number)

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
                elif (answer := self._answer(peer)) is not None:
                    answers.append(answer)
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
            if (answer := self._answer(peer)) is not None:
                answers.append(answer)
        elif (answer := self._answer(peer)) is not None:
            peer.outgoing.send(answer)
            cue.answered(self._clock())

    def _answer(self, peer: RpcPeer) -> bytes | None:
        """Carry out a client's next call, or go on with it; None where the answer is not there yet.

        A call stays the first of its client's until it is answered.
        """
        if peer in self._held:
            return self._done(peer, self._held.pop(peer)[0])
        self._context.caller = peer.number
        frame, call = self._context.simulation.frame, peer.calls[0]
        if peer in self._working:
            answer = registry.go_on(self._context, self._working.pop(peer))
        else:
            self._prepare(peer, call)
            answer = registry.dispatch(self._context, call)
        if self._context.simulation.frame != frame:
            self.last_ticker = peer
        self.publish()
        if isinstance(answer, Unanswered):
            self._working[peer] = answer
            answer.made.add_done_callback(lambda _: self._wake())
            return None
        if not call.is_async and not registry.advances(call) and self._context.builds_the_scene():
            self._held[peer] = answer, self._clock() + SCENE_S
            return None
        return self._done(peer, answer)

    def _prepare(self, peer: RpcPeer, call: Call) -> None:
        """Note what follows from a call before it is carried out."""
        if call.method == LOAD:
            time.sleep(max(0.0, self.joined_s + JOINING_S - self._clock()))
        if call.method == ABOUT_TO_LISTEN and call.args and self._is_stream(call.args[0]):
            self.expected.asked(call.args[0], peer.number, self._clock())

    def _is_stream(self, stream_id: object) -> bool:
        """Whether that is the number of a stream on which something will come."""
        if type(stream_id) is not int:
            return False
        return stream_id == WORLD_OBSERVER_ID or self._context.simulation.has_stream(stream_id)

    def _done(self, peer: RpcPeer, answer: bytes) -> bytes:
        peer.calls.popleft()
        return answer

    def must_wait(self, peer: RpcPeer, unsent_bytes: int = 0) -> bool:
        """Whether a client's next call cannot be carried out yet."""
        if peer in self._working:
            return not self._working[peer].made.done()
        if peer in self._held:
            return self._context.builds_the_scene() and self._clock() < self._held[peer][1]
        return (
            peer.outgoing.waiting_bytes + unsent_bytes > UNREAD_ANSWERS_BYTES
            or self.waits_for_subscribers(peer)
            or (registry.advances(peer.calls[0]) and self._context.waits_for_the_scene())
        )

    def held_s(self, now_s: float) -> float | None:
        """Return how long the first of the answers that wait for the scene waits at most; None where none does."""
        return min((max(0.0, until_s - now_s) for _, until_s in self._held.values()), default=None)

    def waits_for_subscribers(self, peer: RpcPeer) -> bool:
        """Whether a client's next call makes a frame, for which somebody who lags behind or comes is not ready."""
        return (
            peer not in self._working
            and registry.advances(peer.calls[0])
            and self.is_synchronous()
            and self.frame_wait_s(self._clock()) is not None
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
