"""The server: one thread and one selector. It carries out calls in their order, makes frames, and sends what they show.

There is no lock, because nothing happens at the same time: between two events the simulation stands still.
"""

import contextlib
import logging
import selectors
import socket
import time
import traceback
from functools import partial

from linden.errors import ProtocolError
from linden.handlers import registry, session
from linden.handlers.context import Context, Frames
from linden.server.cue import QUESTION, TICK, Cue, hear_question
from linden.server.entrance import Entrance
from linden.server.pace import Pace
from linden.server.peers import Peer, RpcPeer, StreamPeer
from linden.server.ports import Ports, port_of
from linden.server.subscribers import Subscribers
from linden.server.waiting import Waiting
from linden.simulation import Simulation
from linden.wire.stream import WORLD_OBSERVER_ID, StreamTable
from linden.world.maps import MapLibrary

log = logging.getLogger("linden")

CALLS_PER_TURN = 256
"""Calls of one client before the others have their turn: a scene's worth of controls, some ms."""
UNREAD_ANSWERS_BYTES = 1024 * 1024
"""A client that leaves more than this unread is not listened to until it has caught up."""
UNFINISHED_BYTES_OF_ALL = 256 * 1024 * 1024
"""What half-received calls may take in all connections together: four of the largest, hundreds of any usual size."""

_READ, _WRITE = selectors.EVENT_READ, selectors.EVENT_WRITE
_BUG = "internal error in %s; the server goes on"


class Server:
    """Listens on two ports and serves one simulation until it is told to stop."""

    def __init__(self, simulation: Simulation, maps: MapLibrary, frames: Frames, ports: Ports) -> None:
        self._clock = time.monotonic
        self._pace = Pace(self._clock())
        self.context = Context(
            simulation=simulation,
            maps=maps,
            frames=frames,
            streams=StreamTable(port_of(ports.streaming)),
            variable_step_s=lambda: self._pace.variable_step_s(self._clock()),
        )
        self._selector = selectors.DefaultSelector()
        self._subscribers = Subscribers(self.context.streams, self._watch, self._close)
        self._entrance = Entrance(ports, self._selector, self._clock, self._welcome, self._close)
        self._waiting = Waiting()
        self._clients: dict[RpcPeer, None] = {}  # an ordered set, as the next one is
        self._with_calls: dict[RpcPeer, None] = {}  # those whose calls wait for their turn
        self._last_ticker: RpcPeer | None = None
        self._cues: dict[RpcPeer, Cue] = {}  # of those who run a Traffic Manager
        self._wake_reader, self._wake_writer = socket.socketpair()
        self._stopping = False
        self._wake_reader.settimeout(0.0)
        self._wake_writer.settimeout(0.0)
        self._selector.register(self._wake_reader, _READ, self._woken)

    # -- life ----------------------------------------------------------------------------------------------------

    def run(self) -> None:
        """Serve until :meth:`stop`, then close every connection."""
        try:
            while not self._stopping:
                self._turn()
        finally:
            for key in list(self._selector.get_map().values()):
                self._selector.unregister(key.fileobj)
                if isinstance(key.fileobj, socket.socket):
                    key.fileobj.close()
            self._selector.close()
            self._wake_writer.close()

    def stop(self) -> None:
        """Ask the server to end; the one method that another thread or a signal handler may call."""
        self._stopping = True
        with contextlib.suppress(OSError):  # it has ended, or was asked so often that it will wake anyway
            self._wake_writer.send(b"\0")

    def unsent_bytes(self) -> int:
        """Return how many bytes of answers wait to be sent to all clients together."""
        return sum(peer.outgoing.waiting_bytes for peer in self._clients)

    def _turn(self) -> None:
        """Wait for the next thing to do, and do it."""
        for key, events in self._selector.select(self._wait_s()):
            key.data(events)
        for peer in tuple(self._with_calls):
            self._carry_out(peer)
        self._make_due_frame()
        self._look_around()

    def _wait_s(self) -> float | None:
        """Return how long nothing needs doing unless something arrives; None is for ever."""
        if any(not self._must_wait(peer) for peer in self._with_calls):
            return 0.0
        now_s = self._clock()
        waits = [
            self._subscribers.patience_s(now_s) if self._with_calls else None,
            self._entrance.wait_s(now_s),
            self._waiting.untold_s(now_s),
        ]
        settings = self.context.simulation.settings
        if not settings.synchronous_mode:
            waits.append(self._pace.wait_s(now_s, settings.fixed_delta_seconds))
        return min((wait_s for wait_s in waits if wait_s is not None), default=None)

    def _look_around(self) -> None:
        """Do what is due by the clock and is no frame."""
        now_s = self._clock()
        self._entrance.look(now_s)
        held_up = self._with_calls and any(self._waits_for_subscribers(peer) for peer in self._with_calls)
        self._waiting.for_subscribers(now_s, self._subscribers.congested(now_s) if held_up else ())
        stands_still = self._is_synchronous() and not held_up
        self._waiting.for_a_tick(
            now_s, self.context.simulation.frame, tuple(self._clients) if stands_still else (), self._last_ticker
        )

    def _woken(self, _events: int) -> None:
        self._wake_reader.recv(64)

    # -- connections ---------------------------------------------------------------------------------------------

    def _welcome(self, peer: Peer) -> None:
        if isinstance(peer, RpcPeer):
            self._clients[peer] = None
        self._watch(peer)

    def _watch(self, peer: Peer) -> None:
        """Let the selector watch for what can be done with a peer now."""
        reads = not (isinstance(peer, RpcPeer) and (peer.calls or peer.at_end))
        interest = (_READ if reads else 0) | (_WRITE if peer.outgoing.waiting_bytes else 0)
        if interest == peer.interest:
            return
        if not interest:
            self._selector.unregister(peer.socket)
        elif not peer.interest:
            self._selector.register(peer.socket, interest, partial(self._serve, peer))
        else:
            self._selector.modify(peer.socket, interest, partial(self._serve, peer))
        peer.interest = interest

    def _serve(self, peer: Peer, events: int) -> None:
        """Read from a peer and send to it, as far as it goes."""
        if not peer.is_open:  # closed in this very turn, on behalf of another
            return
        try:
            if events & _WRITE:
                peer.flush()
            data = peer.read() if events & _READ else None
            if data is not None:
                if isinstance(peer, RpcPeer):
                    self._called(peer, data)
                elif isinstance(peer, StreamPeer):
                    self._subscribed(peer, data)
        except ProtocolError as error:
            log.warning("%s is closed: %s", peer, error)
            self._close(peer)
        except OSError as error:
            log.info("%s is gone: %s", peer, error)
            self._close(peer)
        except Exception as error:  # noqa: BLE001 - a bug of ours must not end everybody's session
            self.context.warn_once(f"{_BUG % peer}, without it. {_traceback(error)}")
            self._close(peer)
        if peer.is_open:
            self._watch(peer)

    def _close(self, peer: Peer) -> None:
        if not peer.is_open:
            return
        peer.is_open = False
        if peer.interest:
            self._selector.unregister(peer.socket)
            peer.interest = 0
        peer.socket.close()
        self._entrance.has_left(peer)
        if isinstance(peer, StreamPeer):
            self._subscribers.remove(peer)
        elif isinstance(peer, RpcPeer):
            peer.calls.clear()
            del self._clients[peer]
            self._with_calls.pop(peer, None)
            self._cues.pop(peer, None)
            session.client_left(self.context, peer.number)

    def _subscribed(self, peer: StreamPeer, data: bytes) -> None:
        if not data:
            log.debug("%s has left", peer)
            self._close(peer)
        elif peer.subscription.receive(data) and peer.subscription.stream_id is not None:
            self._entrance.has_spoken(peer)
            self._subscribers.add(peer, peer.subscription.stream_id)
            if peer.subscription.stream_id == WORLD_OBSERVER_ID:  # whoever joins between two ticks sees the world too
                payload = self.context.frames.world_payload(self.context.simulation)
                self._subscribers.send(peer, payload, self._clock(), may_drop=not self._is_synchronous())

    # -- calls and frames ----------------------------------------------------------------------------------------

    def _called(self, peer: RpcPeer, data: bytes) -> None:
        if data:
            peer.calls.extend(peer.connection.receive(data))
            if peer.calls:
                self._entrance.has_spoken(peer)
            elif peer.connection.unfinished_bytes > UNREAD_ANSWERS_BYTES:
                self._refuse_to_hoard()
        else:
            peer.at_end = True
        self._carry_out(peer)

    def _refuse_to_hoard(self) -> None:
        """Break off where all the half-received calls together have become too much.

        Raises:
            ProtocolError: the connection that went too far is to be closed.
        """
        held = sum(peer.connection.unfinished_bytes for peer in self._clients)
        if held > UNFINISHED_BYTES_OF_ALL:
            raise ProtocolError(f"half-received calls of all clients hold {held} bytes, too much to receive more")

    def _carry_out(self, peer: RpcPeer) -> None:
        """Carry out a client's calls in their order: some, and the rest at its next turn.

        A client whose last calls are done and who sends nothing more is closed.
        """
        self._with_calls.pop(peer, None)
        answers: list[bytes] = []
        unsent_bytes = 0
        try:
            while peer.calls and len(answers) < CALLS_PER_TURN and not self._must_wait(peer, unsent_bytes):
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
            self._with_calls[peer] = None
        elif peer.at_end:
            log.debug("%s has left", peer)
            self._close(peer)
            return
        self._watch(peer)

    def _leads_traffic(self, peer: RpcPeer) -> bool:
        owners = self.context.traffic_managers.values()
        return self._is_synchronous() and any(owner == peer.number for _, owner in owners)

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
        self.context.caller = peer.number
        frame = self.context.simulation.frame
        answer = registry.dispatch(self.context, peer.calls.popleft())
        if self.context.simulation.frame != frame:
            self._last_ticker = peer
        self._publish()
        return answer

    def _must_wait(self, peer: RpcPeer, unsent_bytes: int = 0) -> bool:
        """Whether a client's next call cannot be carried out yet."""
        return peer.outgoing.waiting_bytes + unsent_bytes > UNREAD_ANSWERS_BYTES or self._waits_for_subscribers(peer)

    def _waits_for_subscribers(self, peer: RpcPeer) -> bool:
        return (
            registry.advances(peer.calls[0])
            and self._is_synchronous()
            and self._subscribers.patience_s(self._clock()) is not None
        )

    def _is_synchronous(self) -> bool:
        return self.context.simulation.settings.synchronous_mode

    def _make_due_frame(self) -> None:
        """Make a frame by the clock, in asynchronous mode only."""
        settings = self.context.simulation.settings
        now_s = self._clock()
        if settings.synchronous_mode or self._pace.wait_s(now_s, settings.fixed_delta_seconds) > 0.0:
            return
        try:
            self.context.advance()
        except Exception as error:  # noqa: BLE001 - a bug of ours must not end everybody's session
            self.context.warn_once(f"{_BUG % 'a frame'}. {_traceback(error)}")
        self._pace.frame_made(now_s, settings.fixed_delta_seconds)
        self._publish()

    def _publish(self) -> None:
        """Send what the last call or frame left in the outbox."""
        if not self.context.outbox:
            return
        now_s = self._clock()
        may_drop = not self._is_synchronous()
        for stream_id, payload in self.context.outbox:
            self._subscribers.publish(stream_id, payload, now_s, may_drop=may_drop)
        self.context.outbox.clear()


def _traceback(error: Exception) -> str:
    return "".join(traceback.format_exception(error))
