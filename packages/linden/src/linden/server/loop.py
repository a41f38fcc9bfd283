"""The server: one thread and one selector. It carries out calls in their order, makes frames, and sends what they show.

There is no lock, because nothing happens at the same time: between two events the simulation stands still.
"""

import contextlib
import gc
import logging
import math
import os
import select
import selectors
import socket
import sys
import time
from collections.abc import Callable
from functools import partial

from linden.errors import ProtocolError
from linden.gate.control import Control
from linden.maps.library import MapLibrary
from linden.protocol.wire.stream import WORLD_OBSERVER_ID, StreamTable
from linden.server.accept import Acceptor
from linden.server.calls import Calls
from linden.server.frame_clock import FrameClock
from linden.server.gates import Gates
from linden.server.peers import Peer, RpcPeer, StreamPeer
from linden.server.ports import Ports, port_of
from linden.server.rpc import session
from linden.server.rpc.context import Context, Follower, Frames
from linden.server.stall_log import StallLog
from linden.server.subscribers import Subscribers
from linden.world import World

log = logging.getLogger("linden")

HELD_BYTES_OF_ALL = 128 * 1024 * 1024
"""What calls that are half received or wait to be carried out may take in all connections together: two of the largest,
hundreds of any usual size."""
HELD_ARRAYS_OF_ALL = 1024 * 1024
"""How many arrays such calls may have in all connections together: four of the most, some 70 MB."""

HOARD_BYTES = 64 * 1024
"""From this size on what a client holds is looked at: smaller ones of a thousand clients are 64 MB."""

SWITCH_S = 0.0002
"""How long a background thread keeps Python's lock when the loop wants it. A tick wants the lock after each call of the
system, and by default would wait 5 ms each time. Without a background thread the value has no effect."""

LOOKS_EACH_S = 0.02
"""How often a busy server runs timers that are not tied to a frame. All of them are a matter of seconds."""

COARSE_S = 0.002
"""Waits shorter than this end on time. The selector counts whole milliseconds; a tick's answer waits one at most."""

ORDER_BYTES = 1 << 16
_MOST_SELECTED = 1024  # numbers of files that select(2) can take
_READ, _WRITE = selectors.EVENT_READ, selectors.EVENT_WRITE
_BUG = "internal error in %s; the server goes on"


class Server:
    """Listens on two ports and serves one world until :meth:`stop` is called."""

    def __init__(self, simulation: World, maps: MapLibrary, frames: Frames, ports: Ports) -> None:
        self._clock = time.monotonic
        self._pace = FrameClock(self._clock())
        self.context = Context(
            world=simulation,
            maps=maps,
            frames=frames,
            streams=StreamTable(port_of(ports.streaming)),
            variable_step_s=lambda: self._pace.variable_step_s(self._clock()),
        )
        self._selector = selectors.DefaultSelector()
        file = self._selector.fileno() if hasattr(self._selector, "fileno") else _MOST_SELECTED
        self._fine_files = (file,) if file < _MOST_SELECTED else ()
        self._subscribers = Subscribers(self.context.streams, self._watch, self._close)
        self._acceptor = Acceptor(ports, self._selector, self._clock, self._accepted, self._close)
        self._stall_log = StallLog()
        self.gates = Gates(self._acceptor, self._subscribers, self._clock, self._close)
        self._clients: dict[RpcPeer, None] = {}  # an ordered set
        self._calls = Calls(self.context, self._subscribers, self._clock, self._watch, self._close, self._wake)
        self._wake_reader, self._wake_writer = socket.socketpair()
        self._stopping = False
        self._next_look_s = 0.0
        self._has_looked = False  # since the last thing was done
        simulation.sensor_scene.when_built = self._wake
        self._wake_reader.settimeout(0.0)
        self._wake_writer.settimeout(0.0)
        self._selector.register(self._wake_reader, _READ, lambda _: self._wake_reader.recv(64))

    # -- life ----------------------------------------------------------------------------------------------------

    def run(self) -> None:
        """Serve until :meth:`stop`, then close every connection.

        Clients that a snapshot has told to read the lamps are answered first; see ``lamp_readers``.
        """
        sys.setswitchinterval(SWITCH_S)
        try:
            while not self._stopping or self._calls.end_wait_s():
                self._turn_in_any_memory()
        finally:
            for key in list(self._selector.get_map().values()):
                self._selector.unregister(key.fileobj)
                if isinstance(key.fileobj, socket.socket):
                    key.fileobj.close()
            for peer in self._clients:  # waiting peers are not in the selector
                peer.socket.close()
            self._selector.close()
            self._wake_writer.close()

    def obey(self, file: int, say: Callable[[str], None]) -> None:
        """Open and close gates by the lines of a file; answers go to ``say``."""
        control = Control(self.gates, say)

        def order(_events: int) -> None:
            data = os.read(file, ORDER_BYTES)
            try:
                control.receive(data)
            except ProtocolError as error:
                log.warning("%s; no more orders are taken", error)
                data = b""
            if not data:
                self._selector.unregister(file)

        self._selector.register(file, _READ, order)

    def follow(self, follower: Follower, file: int, read: Callable[["FrameClock"], bool]) -> None:
        """Let a plugin follow the frames, and call ``read`` with the clock whenever ``file`` can be read.

        ``read`` returns False when nothing more will come; then the plugin follows no more.
        """
        followers = self.context.followers
        followers.append(follower)

        def turn(_events: int) -> None:
            try:
                goes_on = read(self._pace)
            except Exception as error:  # noqa: BLE001 - a bug of a plugin must not end the sessions of clients
                self.context.drop(follower, error)
                goes_on = False
            self._calls.publish()
            if not goes_on:
                self._selector.unregister(file)
                if follower in followers:
                    followers.remove(follower)

        self._selector.register(file, _READ, turn)

    def accept_only(self, process: int) -> None:
        """Accept connections that pass no gate from one process only."""
        self._acceptor.owner = process

    def stop(self) -> None:
        """Ask the server to end; the one method that another thread or a signal handler may call."""
        self._stopping = True
        self._wake()

    def _wake(self) -> None:
        """End the present wait; any thread may call it."""
        with contextlib.suppress(OSError):  # it has ended, or was asked so often that it will wake anyway
            self._wake_writer.send(b"\0")

    def _turn_in_any_memory(self) -> None:
        try:
            self._turn()
        except MemoryError:
            self._make_room()

    def _make_room(self) -> None:
        """Drop what was to be sent, where there is no memory left; what called for it has been unwound by now."""
        self.context.outbox.clear()
        gc.collect()
        self.context.log_bug("the server's memory does not suffice; what was being made is dropped, and it goes on")

    def _turn(self) -> None:
        """Wait for the next thing to do, and do it."""
        wait_s = self._wait_s()
        if wait_s is not None and 0.0 < wait_s < COARSE_S and self._fine_files:
            select.select(self._fine_files, (), (), wait_s)
            wait_s = 0.0
        happened = self._selector.select(wait_s)
        for key, events in happened:
            key.data(events)
        for peer in tuple(self._calls.unfinished):
            self._calls.carry_out(peer)
        self._calls.send_overdue()
        self._make_due_frame()
        now_s = self._clock()
        self._has_looked = not happened or now_s >= self._next_look_s
        if self._has_looked:
            self._look_around(now_s)
            self._next_look_s = now_s + LOOKS_EACH_S

    def _wait_s(self) -> float | None:
        """Return how long nothing needs doing unless something arrives; None is for ever."""
        order, unfinished = self._calls.order, self._calls.unfinished
        if unfinished and any(not order.must_wait(peer) for peer in unfinished):
            return 0.0
        now_s = self._clock()
        waits = [order.held_s(now_s), self._calls.end_wait_s() if self._stopping else None]
        if unfinished:
            waits.append(order.frame_wait_s(now_s))
        if self._has_looked:
            waits += (self._acceptor.wait_s(now_s), self._stall_log.untold_s(now_s))
        else:  # it will look then, and find out how long there is nothing else to do
            waits.append(self._next_look_s - now_s)
        settings = self.context.world.settings
        if not (settings.synchronous_mode or self._stopping):
            pace_s = self._pace.wait_s(now_s, settings.fixed_delta_seconds)
            waits.append(None if pace_s == math.inf else pace_s or order.traffic_wait_s(now_s))
        wait_s = min((wait_s for wait_s in waits if wait_s is not None), default=None)
        return None if wait_s is None else max(0.0, wait_s)

    def _look_around(self, now_s: float) -> None:
        """Run timers that are not tied to a frame."""
        self._acceptor.look(now_s)
        held_up = self._calls.unfinished and any(
            self._calls.order.waits_for_subscribers(peer) for peer in self._calls.unfinished
        )
        self._stall_log.for_subscribers(now_s, self._subscribers.congested(now_s) if held_up else ())
        stands_still = self._calls.order.is_synchronous() and not held_up
        self._stall_log.for_a_tick(
            now_s, self.context.world.frame, tuple(self._clients) if stands_still else (), self._calls.last_ticker
        )

    # -- connections ---------------------------------------------------------------------------------------------

    def _accepted(self, peer: Peer) -> None:
        self.gates.came(peer)
        if isinstance(peer, RpcPeer):
            self._clients[peer] = None
        self._watch(peer)

    def _watch(self, peer: Peer) -> None:
        """Let the selector watch for what can be done with a peer now."""
        busy = isinstance(peer, RpcPeer) and peer.calls and not self._calls.order.hears(peer)
        reads = not (busy or (isinstance(peer, RpcPeer) and peer.at_end))
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
                    return  # its calls being carried out, the selector watches for the right things
                if isinstance(peer, StreamPeer):
                    self._subscribed(peer, data)
        except ProtocolError as error:
            log.warning("%s is closed: %s", peer, error)
            self._close(peer)
        except OSError as error:
            log.info("%s is gone: %s", peer, error)
            self._close(peer)
        except Exception as error:  # noqa: BLE001 - a bug of ours must not end everybody's session
            self.context.log_bug(f"{_BUG % peer}, without it.", error)
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
        self._acceptor.has_left(peer)
        self.gates.left(peer)
        if isinstance(peer, StreamPeer):
            self._subscribers.remove(peer)
        elif isinstance(peer, RpcPeer):
            del self._clients[peer]
            self._calls.forget(peer)
            session.client_left(self.context, peer.number)

    def _subscribed(self, peer: StreamPeer, data: bytes) -> None:
        if not data:
            log.debug("%s has left", peer)
            self._close(peer)
        elif peer.subscription.receive(data) and peer.subscription.stream_id is not None:
            self._acceptor.has_spoken(peer)
            if peer.gate is not None and not peer.gate.may_hear(peer.subscription.stream_id):
                raise ProtocolError(f"stream {peer.subscription.stream_id} is none of the agent's")
            self._subscribers.add(peer, peer.subscription.stream_id)
            self._calls.joined_s = self._clock()
            self._calls.order.expected.came(peer.subscription.stream_id)
            if peer.subscription.stream_id == WORLD_OBSERVER_ID:
                self._calls.send_snapshot(peer)

    # -- calls and frames ----------------------------------------------------------------------------------------

    def _called(self, peer: RpcPeer, data: bytes) -> None:
        if data:
            peer.receive(data)
            if peer.calls:
                self._acceptor.has_spoken(peer)
            if peer.held()[0] > HOARD_BYTES:
                self._refuse_to_hoard()
        elif self._calls.order.has_long_work(peer):
            log.info("%s has left before its answer; the work for it ends", peer)
            self._close(peer)
            return
        else:
            peer.at_end = True
        self._calls.carry_out(peer)

    def _refuse_to_hoard(self) -> None:
        """Break off where all that clients have sent and is not carried out has become too much.

        Raises:
            ProtocolError: the connection that went too far is to be closed.
        """
        held = [peer.held() for peer in self._clients]
        size, arrays = sum(each[0] for each in held), sum(each[1] for each in held)
        if size > HELD_BYTES_OF_ALL or arrays > HELD_ARRAYS_OF_ALL:
            raise ProtocolError(
                f"calls of all clients that are half received or wait to be carried out hold {size} bytes with "
                f"{arrays} arrays, too much to receive more"
            )

    def _make_due_frame(self) -> None:
        """Make a frame by the clock, or because something new is to be shown; in asynchronous mode only."""
        settings = self.context.world.settings
        if settings.synchronous_mode or self._stopping:
            self.context.frame_is_due = False
            return
        now_s = self._clock()
        waits = not self.context.frame_is_due and self._pace.wait_s(now_s, settings.fixed_delta_seconds) > 0.0
        if not waits and self._calls.order.traffic_wait_s(now_s) > 0.0:
            return
        self.context.frame_is_due = False
        if waits or self.context.waits_for_the_scene():
            return
        try:
            if self._calls.load.is_due(now_s):
                self.context.begin_pending_load()
            self.context.advance()
        except Exception as error:  # noqa: BLE001 - a bug of ours must not end everybody's session
            self.context.log_bug(f"{_BUG % 'a frame'}.", error)
        self._pace.frame_made(now_s, settings.fixed_delta_seconds)
        self._calls.publish()
