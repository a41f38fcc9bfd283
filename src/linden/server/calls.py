"""Calls of the clients, carried out strictly in the order of each, and by turns between them."""

import logging
import math
import time
from collections.abc import Callable

from linden.errors import ProtocolError
from linden.protocol.wire.rpc import Call
from linden.protocol.wire.stream import WORLD_OBSERVER_ID
from linden.server.cue import QUESTION, TICK, Cue
from linden.server.driven_vehicles import BATCH, DESTROY, DrivenVehicles
from linden.server.load_answers import GATHERING_S, OF_A_LOAD, LoadAnswers, Phase
from linden.server.peers import RpcPeer
from linden.server.rpc import registry
from linden.server.rpc.context import Context
from linden.server.rpc.registry import SuspendedCall
from linden.server.subscribers import Expected, Subscribers

log = logging.getLogger("linden")

CALLS_PER_TURN = 256
"""Calls of one client before the others have their turn: a scene's worth of controls, some ms."""
UNREAD_ANSWERS_BYTES = 1024 * 1024
"""A client that leaves more than this unread is not listened to until it has caught up."""

SCENE_S = 0.8
"""How long an answer waits at most for the sensor scene. So the calls before a first picture wait a little each, and
the tick does not wait all the time. CARLA's examples give a call two seconds. Two calls may wait in line: the
program's own and the Traffic Manager's."""

OF_TRAFFIC = frozenset(
    (
        QUESTION,
        "get_actor_bounding_box",
        "get_vehicle_light_states",
        "get_weather_parameters",
        "set_actor_simulate_physics",
        "get_traffic_light_state",
        "set_traffic_light_state",
    )
)
"""What a Traffic Manager's thread calls in a step, but for its batch."""
ABOUT_TO_LISTEN = "get_sensor_token"
LOAD = "load_new_episode"
LOADING_S = 0.5
"""How long an answered load waits for its client to ask which episode there is."""
JOINING_S = 0.05
"""What the official client needs from beginning to listen until it may stop again. It drops its stream when it loads an
episode, and a busy client that requested that stream just before ends its own process with ``bad_weak_ptr``:
LibCarla's ``streaming::detail::tcp::Client`` is gone before its first message is sent. CARLA's loads take seconds."""


class Calls:
    """Calls of clients that are not answered yet.

    Attributes:
        unfinished: the clients with calls that wait for their turn; an ordered set.
        last_ticker: the client with the last call that made a frame.
        joined_s: the time of the last subscription.
        expected: the streams that clients are about to subscribe to.
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
        self.unfinished: dict[RpcPeer, None] = {}
        self.last_ticker: RpcPeer | None = None
        self.joined_s = -math.inf
        self.expected = Expected()
        self._cues: dict[RpcPeer, Cue] = {}  # of clients with a Traffic Manager
        self._driven: dict[RpcPeer, DrivenVehicles] = {}  # of those too
        self._shown_frame = context.world.frame
        self._working: dict[RpcPeer, SuspendedCall] = {}  # clients with work in the background
        self._load_answers: dict[RpcPeer, LoadAnswers] = {}  # of loads by clients with a Traffic Manager
        self._load_until_s = math.inf  # when a pending load begins in any case
        self._held: dict[RpcPeer, tuple[bytes, float]] = {}  # answers that wait for the scene, and until when

    def forget(self, peer: RpcPeer) -> None:
        """Drop the calls of a client that has gone."""
        peer.calls.clear()
        self.unfinished.pop(peer, None)
        self._cues.pop(peer, None)
        self._driven.pop(peer, None)
        self._working.pop(peer, None)  # its result is made and dropped
        self._held.pop(peer, None)
        self._load_answers.pop(peer, None)
        self.expected.forget(peer.number)

    def carry_out(self, peer: RpcPeer) -> None:
        """Carry out a client's calls in their order: some, and the rest at its next turn.

        A client is closed when its last calls are done and it sends nothing more.
        """
        self.unfinished.pop(peer, None)
        answers: list[bytes] = []
        unsent_bytes = 0
        try:
            while peer.calls and len(answers) < CALLS_PER_TURN and not self.must_wait(peer, unsent_bytes):
                if self._keeps_order(peer):
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

    def _keeps_order(self, peer: RpcPeer) -> bool:
        """Return whether a client's next call is a tick that waits, or a tick or question of one that leads traffic."""
        if self._waiting_tick(peer) is not None:
            return True
        return peer.calls[0].method in (QUESTION, TICK) and self.is_synchronous() and self._traffic_managers(peer) > 0

    def _keep_order(self, peer: RpcPeer, answers: list[bytes]) -> None:
        """Go on with a tick, or the question before it, of a client that runs a Traffic Manager; see ``server.cue``.

        Raises:
            OSError: the client is gone.
        """
        if answers:
            peer.outgoing.send(b"".join(answers))
            answers.clear()
        cue = self._cues.setdefault(peer, Cue())
        is_question = peer.bring_forward((QUESTION,)) is not None
        if cue.tick and not is_question:
            answers.append(self._done(peer, cue.finish()))
        elif (answer := self._answer(peer)) is not None:
            if is_question:
                peer.outgoing.send(answer)
                cue.answered(self._clock())
            else:
                answers.append(answer)

    def _waiting_tick(self, peer: RpcPeer) -> Cue | None:
        """Return the cue that a client's tick waits for; None where its next call is no tick that is carried out."""
        cue = self._cues.get(peer)
        return cue if cue is not None and cue.tick else None

    def _answer(self, peer: RpcPeer) -> bytes | None:
        """Carry out a client's next call, or go on with it; None where the answer is not there yet.

        A call stays the first of its client's until it is answered.
        """
        if peer in self._held:
            return self._done(peer, self._held.pop(peer)[0])
        if peer in self._load_answers and (load := self._hand_over(peer)) is not None:
            return load
        self._context.caller = peer.number
        frame, call = self._context.world.frame, peer.calls[0]
        if peer in self._working:
            answer = registry.go_on(self._context, self._working.pop(peer))
        else:
            self._prepare(peer, call)
            answer = registry.dispatch(self._context, call)
        if self._context.world.frame != frame:
            self.last_ticker = peer
        self.publish()
        if isinstance(answer, SuspendedCall):
            self._working[peer] = answer
            answer.made.add_done_callback(lambda _: self._wake())
            return None
        if self._keep(peer, call, answer):
            return None
        self._done(peer, answer)
        return answer if not self._traffic_managers(peer) else self._with_driven(peer, call, answer)

    def _with_driven(self, peer: RpcPeer, call: Call, answer: bytes) -> bytes | None:
        """Return what to send for a call of a client that runs Traffic Managers; see ``server.driven_vehicles``."""
        if call.method == BATCH and call.args:
            ready = self._driven.setdefault(peer, DrivenVehicles()).batch(call.args[0])
            return b"".join((answer, *ready))
        if call.method != DESTROY or peer not in self._driven or call.is_async or not call.args:
            return answer
        frames_come = not self.is_synchronous() and not self._context.waits_for_the_scene()
        waits = self._driven[peer].destroyed(call.args[0], answer, self._clock(), frames_come=frames_come)
        self._context.frame_is_due |= waits
        return None if waits else answer

    def send_overdue(self) -> None:
        """Send the answers to destructions that no Traffic Manager has confirmed in time."""
        now_s = self._clock()
        for peer, driven in list(self._driven.items()):
            if ready := driven.overdue(now_s):
                try:
                    peer.outgoing.send(b"".join(ready))
                except OSError as error:
                    log.info("%s is gone: %s", peer, error)
                    self._close(peer)
                    continue
                self._watch(peer)

    def traffic_wait_s(self, now_s: float) -> float:
        """Return how long asynchronous mode's next frame waits at most for Traffic Managers; 0 where it need not.

        A frame that lacks a car must not come while a Traffic Manager works on the car; see ``server.driven_vehicles``.
        """
        if not self._driven:
            return 0.0
        actors = self._context.world.episode.actors
        return max(one.frame_wait_s(now_s, actors.__contains__) for one in self._driven.values())

    def _keep(self, peer: RpcPeer, call: Call, answer: bytes) -> bool:
        """Return whether an answer has to wait, and keep it where it has."""
        now_s = self._clock()
        if call.method == TICK and self._keeps_order(peer):
            self._cues[peer].ticked(answer, now_s)
        elif call.method == LOAD and (threads := self._traffic_managers(peer)):
            self._load_answers[peer] = LoadAnswers(answer, threads, now_s + GATHERING_S)
        elif self._leads_to_a_picture(peer, call) and self._context.builds_the_scene():
            self._held[peer] = answer, now_s + SCENE_S
        else:
            return False
        return True

    def _leads_to_a_picture(self, peer: RpcPeer, call: Call) -> bool:
        """Return whether an answer may wait for the scene.

        A Traffic Manager's calls may not: its first step makes two for each car, and would take seconds. Cars that are
        destroyed meanwhile end the client's process.
        """
        if call.is_async or registry.advances(call):
            return False
        if not self._traffic_managers(peer):
            return True
        return self.is_synchronous() and call.method not in OF_TRAFFIC

    def _prepare(self, peer: RpcPeer, call: Call) -> None:
        """Note what follows from a call before it is carried out."""
        self._begin_load_before(peer, call)
        if call.method == LOAD:
            time.sleep(max(0.0, self.joined_s + JOINING_S - self._clock()))
            self._load_until_s = math.inf
        if call.method == ABOUT_TO_LISTEN and call.args and self._is_stream(call.args[0]):
            self.expected.asked(call.args[0], peer.number, self._clock())

    def _begin_load_before(self, peer: RpcPeer, call: Call) -> None:
        """Begin an answered load before a call that has to find the new episode.

        The client that loads asks for the version and the present episode first. Others go on in that episode
        meanwhile, but not for long.
        """
        pending, now_s = self._context.pending_load, self._clock()
        if pending is None:
            return
        is_due = self.load_is_due(now_s)
        if peer.number != pending.client:
            if is_due:
                self._context.begin_pending_load()
        elif call.method not in OF_A_LOAD:
            self._context.begin_pending_load()
        elif call.method == OF_A_LOAD[-1]:
            self._load_until_s = now_s

    def _hand_over(self, peer: RpcPeer) -> bytes | None:
        """Return the answer to a load that is due, None where the client's next call has to be carried out."""
        answers = self._load_answers[peer]
        if answers.phase is Phase.GATHERING:
            return self._done(peer, answers.answered(self._clock()))
        if answers.phase is Phase.SETTLING or not answers.bring_forward(peer, self._clock()):
            del self._load_answers[peer]
        return None

    def _traffic_managers(self, peer: RpcPeer) -> int:
        return sum(owner == peer.number for _, owner in self._context.traffic_managers.values())

    def hears(self, peer: RpcPeer) -> bool:
        """Return whether to read on from a client although calls of its wait, since what they wait for is a call."""
        waits = peer in self._load_answers or self._waiting_tick(peer) is not None
        return waits and len(peer.calls) < CALLS_PER_TURN

    def _is_stream(self, stream_id: object) -> bool:
        """Whether that is the number of a stream on which something will come."""
        if type(stream_id) is not int:
            return False
        return stream_id == WORLD_OBSERVER_ID or self._context.world.has_stream(stream_id)

    def _done(self, peer: RpcPeer, answer: bytes) -> bytes:
        peer.calls.popleft()
        return answer

    def must_wait(self, peer: RpcPeer, unsent_bytes: int = 0) -> bool:
        """Whether a client's next call cannot be carried out yet."""
        if peer in self._working:
            return not self._working[peer].made.done()
        if peer in self._held:
            return self._context.builds_the_scene() and self._clock() < self._held[peer][1]
        if peer in self._load_answers:
            return self._load_answers[peer].waits(peer, self._clock())
        if (cue := self._waiting_tick(peer)) is not None:
            return cue.waits(peer, self._clock())
        return (
            peer.outgoing.waiting_bytes + unsent_bytes > UNREAD_ANSWERS_BYTES
            or self.waits_for_subscribers(peer)
            or (registry.advances(peer.calls[0]) and self._context.waits_for_the_scene())
        )

    def load_is_due(self, now_s: float) -> bool:
        """Return whether an answered load begins before the next frame that is made by the clock."""
        if self._context.pending_load is None:
            return False
        if self._load_until_s == math.inf:
            self._load_until_s = now_s + LOADING_S
        return now_s >= self._load_until_s

    def held_s(self, now_s: float) -> float | None:
        """Return how long the first of the answers that wait for the scene or a load waits at most; None for none."""
        until_s = [until_s for _, until_s in self._held.values()]
        until_s += [answers.until_s for answers in self._load_answers.values()]
        until_s += [one.until_s for driven in self._driven.values() for one in driven.waiting]
        until_s += [cue.deadline_s for cue in self._cues.values() if cue.tick]
        return max(0.0, min(until_s) - now_s) if until_s else None

    def waits_for_subscribers(self, peer: RpcPeer) -> bool:
        """Whether a client's next call makes a frame, while a slow or an expected subscriber is not ready."""
        return (
            peer not in self._working
            and registry.advances(peer.calls[0])
            and self.is_synchronous()
            and self.frame_wait_s(self._clock()) is not None
        )

    def frame_wait_s(self, now_s: float) -> float | None:
        """Return how long synchronous mode's next frame waits at most for slow and expected subscribers."""
        waits = (self._subscribers.patience_s(now_s), self.expected.wait_s(now_s))
        return min((wait_s for wait_s in waits if wait_s is not None), default=None)

    def is_synchronous(self) -> bool:
        """Whether frames are made by calls alone."""
        return self._context.world.settings.synchronous_mode

    def publish(self) -> None:
        """Send what the last call or frame left in the outbox."""
        if self._context.world.frame != self._shown_frame:
            self._shown_frame = self._context.world.frame
            for driven in self._driven.values():
                driven.shown()
        if not self._context.outbox:
            return
        now_s = self._clock()
        may_drop = not self.is_synchronous()
        for stream_id, payload in self._context.outbox:
            self._subscribers.publish(stream_id, payload, now_s, may_drop=may_drop)
        self._context.outbox.clear()
