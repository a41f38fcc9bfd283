"""Scheduler of RPC calls: each client's in order, clients in turn; sends the answers and publishes stream messages.

What a call or its answer waits for is decided in :mod:`linden.server.answer_order`.
"""

import logging
import math
import time
from collections.abc import Callable

from linden.errors import ProtocolError
from linden.protocol.wire.rpc import Call
from linden.protocol.wire.stream import WORLD_OBSERVER_ID
from linden.server.answer_order import CALLS_PER_TURN, AnswerOrder
from linden.server.cue import QUESTION, Cue
from linden.server.lamp_readers import READS_LAMPS, LampReaders
from linden.server.load_answers import LOAD, AnsweredLoad
from linden.server.peers import RpcPeer, StreamPeer
from linden.server.rpc import registry
from linden.server.rpc.context import Context
from linden.server.rpc.registry import SuspendedCall
from linden.server.subscribers import Subscribers

log = logging.getLogger("linden")

ABOUT_TO_LISTEN = "get_sensor_token"
JOINING_S = 0.05
"""What the official client needs from beginning to listen until it may stop again. It drops its stream when it loads an
episode, and a busy client that requested that stream just before ends its own process with ``bad_weak_ptr``:
LibCarla's ``streaming::detail::tcp::Client`` is gone before its first message is sent. CARLA's loads take seconds."""


class Calls:
    """Calls of clients that are not answered yet.

    Attributes:
        order: what the calls and answers wait for.
        load: begins the load that has been answered.
        unfinished: the clients with calls that wait for their turn; an ordered set.
        last_ticker: the client with the last call that made a frame.
        joined_s: the time of the last subscription.
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
        """``watch`` is called with a client that changed its state, ``close`` with one to close.

        ``wake`` lets the server look at what is unfinished; other threads call it.
        """
        self._wake = wake
        self._context = context
        self._subscribers = subscribers
        self._clock = clock
        self._watch = watch
        self._close = close
        self.order = AnswerOrder(context, subscribers, clock)
        self.load = AnsweredLoad(context)
        self._lamp_readers = LampReaders()
        self.unfinished: dict[RpcPeer, None] = {}
        self.last_ticker: RpcPeer | None = None
        self.joined_s = -math.inf
        self._shown_frame = context.world.frame

    def forget(self, peer: RpcPeer) -> None:
        """Drop the calls of a client that has gone."""
        peer.calls.clear()
        self.unfinished.pop(peer, None)
        self.order.forget(peer)

    def carry_out(self, peer: RpcPeer) -> None:
        """Carry out a client's calls in their order: some, and the rest at its next turn.

        A client is closed when its last calls are done and it sends nothing more.
        """
        self.unfinished.pop(peer, None)
        answers: list[bytes] = []
        unsent_bytes = 0
        try:
            while peer.calls and len(answers) < CALLS_PER_TURN and not self.order.must_wait(peer, unsent_bytes):
                if (cue := self.order.cue_of(peer)) is not None:
                    self._keep_order(peer, cue, answers)
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

    def _keep_order(self, peer: RpcPeer, cue: Cue, answers: list[bytes]) -> None:
        """Go on with a tick, or the question before it, of a client that runs a Traffic Manager; see ``server.cue``.

        Raises:
            OSError: the client is gone.
        """
        if answers:
            peer.outgoing.send(b"".join(answers))
            answers.clear()
        is_question = peer.bring_forward((QUESTION,)) is not None
        if cue.tick and not is_question:
            answers.append(self._done(peer, cue.finish()))
        elif (answer := self._answer(peer)) is not None:
            if is_question:
                peer.outgoing.send(answer)
                cue.answered(self._clock())
            else:
                answers.append(answer)

    def _answer(self, peer: RpcPeer) -> bytes | None:
        """Carry out a client's next call, or go on with it; None where the answer is not there yet.

        A call stays the first of its client's until it is answered.
        """
        if (kept := self.order.kept(peer)) is not None:
            return self._done(peer, kept)
        frame, call = self._context.world.frame, peer.calls[0]
        if peer.gate is not None and (refused := peer.gate.refuse(call)) is not None:
            return self._done(peer, refused)
        self._context.caller = peer.number
        if (work := self.order.resumed(peer)) is not None:
            answer = registry.go_on(self._context, work)
        else:
            self._prepare(peer, call)
            answer = registry.dispatch(self._context, call)
        if peer.gate is not None and isinstance(answer, bytes) and peer.gate.rewrites(call.method):
            answer = peer.gate.rewritten(call, answer)
        if self._context.world.frame != frame:
            self.last_ticker = peer
        self.publish()
        if isinstance(answer, SuspendedCall):
            self.order.suspend(peer, answer)
            answer.made.add_done_callback(lambda _: self._wake())
            return None
        if self.order.keep(peer, call, answer):
            return None
        return self.order.sent_with(peer, call, self._done(peer, answer))

    def _done(self, peer: RpcPeer, answer: bytes) -> bytes:
        peer.calls.popleft()
        return answer

    def _prepare(self, peer: RpcPeer, call: Call) -> None:
        """Note what follows from a call before it is carried out."""
        if self._context.pending_load is not None:
            self.load.begin_before(peer, call, self._clock())
        if call.method == LOAD:
            time.sleep(max(0.0, self.joined_s + JOINING_S - self._clock()))
            self.load.answered()
        if call.method == READS_LAMPS:
            self._lamp_readers.has_read()
        if call.method == ABOUT_TO_LISTEN and call.args and self._is_stream(call.args[0]):
            self.order.expected.asked(call.args[0], peer.number, self._clock())

    def _is_stream(self, stream_id: object) -> bool:
        """Whether that is the number of a stream on which something will come."""
        if type(stream_id) is not int:
            return False
        return stream_id == WORLD_OBSERVER_ID or self._context.world.has_stream(stream_id)

    def end_wait_s(self) -> float:
        """Return how long the end of the server waits at most for clients that are about to read the lamps."""
        is_heard = self._subscribers.count(WORLD_OBSERVER_ID)
        return self._lamp_readers.wait_s(self._clock()) if is_heard else 0.0

    def send_overdue(self) -> None:
        """Send the answers to destructions that no Traffic Manager has confirmed in time."""
        for peer, ready in self.order.overdue(self._clock()):
            try:
                peer.outgoing.send(ready)
            except OSError as error:
                log.info("%s is gone: %s", peer, error)
                self._close(peer)
                continue
            self._watch(peer)

    def publish(self) -> None:
        """Send what the last call or frame left in the outbox."""
        if self._context.world.frame != self._shown_frame:
            self._shown_frame = self._context.world.frame
            self.order.shown()
        if not self._context.outbox:
            return
        now_s = self._clock()
        may_drop = not self.order.is_synchronous()
        for stream_id, payload in self._context.outbox:
            if stream_id == WORLD_OBSERVER_ID and self._context.world.tells_to_read_lamps:
                self._lamp_readers.told(self._subscribers.count(stream_id), now_s)
            self._subscribers.publish(stream_id, payload, now_s, may_drop=may_drop)
        self._context.outbox.clear()

    def send_snapshot(self, peer: StreamPeer) -> None:
        """Send the present snapshot to a client that has just subscribed, also between two ticks."""
        now_s, world = self._clock(), self._context.world
        if world.tells_to_read_lamps:
            self._lamp_readers.told(1, now_s)
        payload = self._context.frames.world_payload(world)
        self._subscribers.send(peer, payload, now_s, may_drop=not self.order.is_synchronous())
