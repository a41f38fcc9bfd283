"""The relay: a gate before any server of CARLA's protocol. One thread, one selector; calls and streams pass through it.

Each connection of the agent has one to the server behind it. Calls go on as the bytes that came. Streams go on byte by
byte, except for world snapshots in a track that hides actors, which are filtered message by message.
"""

import contextlib
import logging
import selectors
import socket
import struct
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import msgpack

from linden.errors import ProtocolError
from linden.gate.session import Gate
from linden.protocol.wire.answers import Call, call_of
from linden.protocol.wire.stream import WORLD_OBSERVER_ID, Subscription, size_prefix
from linden.server.gate_keeper import GateKeeper
from linden.server.outgoing import Outgoing
from linden.server.owner import admits
from linden.server.ports import Ports

log = logging.getLogger("linden")

RECEIVED_AT_ONCE = 1 << 20
MOST_WAITING_BYTES = 1 << 20
"""Beyond it nothing more is read for a peer that does not read, so that the server sees a slow reader."""
CONNECT_S = 5.0
MOST_MESSAGE_BYTES = 1 << 30
_SIZE = struct.Struct("<I")
_READ, _WRITE = selectors.EVENT_READ, selectors.EVENT_WRITE
_ANY_ADDRESS = ("0.0.0.0", "::")  # noqa: S104 - in a token it means the host of the RPC connection


class _Messages:
    """Cuts a stream of msgpack into its messages, each with its bytes."""

    def __init__(self) -> None:
        self._unpacker = msgpack.Unpacker(
            raw=False, unicode_errors="surrogateescape", max_buffer_size=MOST_MESSAGE_BYTES, strict_map_key=False
        )
        self._bytes = bytearray()
        self._begin = 0  # of the first message that is not whole, in all that has come

    def receive(self, data: bytes) -> Iterator[tuple[bytes, Any]]:
        """Yield the messages that ``data`` completes.

        Raises:
            ProtocolError: it is no msgpack.
        """
        self._bytes += data
        try:
            self._unpacker.feed(data)
            while True:
                message = self._unpacker.unpack()
                size = self._unpacker.tell() - self._begin
                self._begin += size
                raw = bytes(self._bytes[:size])
                del self._bytes[:size]
                yield raw, message
        except msgpack.OutOfData:
            return
        except (ValueError, msgpack.UnpackException, TypeError, OverflowError) as error:
            raise ProtocolError(f"what arrived is not msgpack: {error or type(error).__name__}") from error


class _End:
    """One socket of a link, with what waits to be sent over it."""

    def __init__(self, sock: socket.socket) -> None:
        sock.settimeout(0.0)
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.socket = sock
        self.outgoing = Outgoing(sock)
        self.interest = 0


class _Link:
    """An agent's connection and the server's behind it. Subclasses say what passes."""

    def __init__(self, gate: Gate, agent: socket.socket) -> None:
        self.gate = gate
        self.agent = _End(agent)
        self.server: _End | None = None

    def from_agent(self, data: bytes) -> None:
        """Take what the agent's client has sent."""
        raise NotImplementedError

    def from_server(self, data: bytes) -> None:
        """Take what the server has sent."""
        raise NotImplementedError

    def seen(self) -> None:
        """Send what has waited for the benchmark's word on what the agent sees."""


class _Calls(_Link):
    """The calls of a client."""

    def __init__(self, gate: Gate, agent: socket.socket, server: socket.socket) -> None:
        super().__init__(gate, agent)
        self.server = _End(server)
        self._calls, self._answers = _Messages(), _Messages()
        self._rewritten: dict[int, Call] = {}

    def from_agent(self, data: bytes) -> None:
        assert self.server is not None, "it is connected at once"
        for raw, message in self._calls.receive(data):
            call = call_of(message)
            refused = self.gate.refuse(call)
            if refused is not None:
                self.agent.outgoing.send(refused)
                continue
            if self.gate.rewrites(call.method):
                self._rewritten[call.id] = call
            self.server.outgoing.send(raw)

    def from_server(self, data: bytes) -> None:
        for raw, message in self._answers.receive(data):
            call = self._rewritten.pop(message[1], None) if self._rewritten else None
            self.agent.outgoing.send(raw if call is None else self.gate.rewritten(call, raw))


class _Stream(_Link):
    """A subscription of a client: its stream id goes to the server, and the messages come back."""

    def __init__(self, gate: Gate, agent: socket.socket, subscribe: Callable[[int], socket.socket]) -> None:
        super().__init__(gate, agent)
        self._subscription, self._subscribe = Subscription(), subscribe
        self._filtered = False
        self._received = bytearray()
        self._held: bytes | None = None

    def from_agent(self, data: bytes) -> None:
        if not self._subscription.receive(data) or self._subscription.stream_id is None:
            return
        stream_id = self._subscription.stream_id
        if not self.gate.may_hear(stream_id):
            raise ProtocolError(f"stream {stream_id} is none of the agent's")
        self._filtered = self.gate.filters and stream_id == WORLD_OBSERVER_ID
        self.server = _End(self._subscribe(stream_id))
        self.server.outgoing.send(_SIZE.pack(stream_id))

    def from_server(self, data: bytes) -> None:
        if not self._filtered:
            self.agent.outgoing.send(data)
            return
        self._received += data
        while len(self._received) >= _SIZE.size:
            end = _SIZE.size + _SIZE.unpack_from(self._received)[0]
            if len(self._received) < end:
                return
            self._held = bytes(self._received[_SIZE.size : end])
            del self._received[:end]
            self.seen()

    def seen(self) -> None:
        payload = None if self._held is None else self.gate.shown(self._held)
        if payload is not None:
            self._held = None
            self.agent.outgoing.send(size_prefix(len(payload)), payload)


class Relay(GateKeeper):
    """Serves gates before the server at an address."""

    def __init__(self, host: str, port: int) -> None:
        """Name the server; it is connected to when an agent's client comes."""
        super().__init__()
        self._host, self._port = host, port
        self._selector = selectors.DefaultSelector()
        self._links: dict[_Link, None] = {}  # an ordered set
        self._stopping = False

    # -- life

    def watch(self, file: int, ready: Callable[[], None]) -> None:
        """Call ``ready`` when a file can be read."""
        self._selector.register(file, _READ, lambda _: ready())

    def run(self) -> None:
        """Serve until :meth:`stop`."""
        while not self._stopping:
            for key, events in self._selector.select():
                key.data(events)
        self.close_all()

    def stop(self) -> None:
        """End :meth:`run` after the present event."""
        self._stopping = True

    # -- gates

    def _listen(self, ports: Ports, gate: Gate) -> None:
        self._selector.register(ports.rpc, _READ, lambda _: self._accept(ports.rpc, gate, self._calls_of))
        self._selector.register(ports.streaming, _READ, lambda _: self._accept(ports.streaming, gate, self._stream_of))

    def _send_held(self, gate: Gate) -> None:
        for link in tuple(self._links):
            if link.gate is gate:
                self._guarded(link, link.seen)

    def _hang_up(self, gate: Gate, ports: Ports) -> None:
        for link in tuple(self._links):
            if link.gate is gate:
                self._close(link)
        self._selector.unregister(ports.rpc)
        self._selector.unregister(ports.streaming)
        ports.close()

    # -- connections

    def _accept(self, listener: socket.socket, gate: Gate, make: Callable[[Gate, socket.socket], _Link]) -> None:
        try:
            sock, _ = listener.accept()
        except OSError:  # it has gone again
            return
        if not admits(gate.agent, sock):
            sock.close()
            return
        try:
            link = make(gate, sock)
        except OSError as error:
            log.warning("the gate does not reach the server at %s:%d: %s", self._host, self._port, error)
            sock.close()
            return
        self._links[link] = None
        self._watch(link)

    def _calls_of(self, gate: Gate, agent: socket.socket) -> _Link:
        return _Calls(gate, agent, socket.create_connection((self._host, self._port), CONNECT_S))

    def _stream_of(self, gate: Gate, agent: socket.socket) -> _Link:
        return _Stream(gate, agent, partial(self._subscribe, gate))

    def _subscribe(self, gate: Gate, stream_id: int) -> socket.socket:
        """Connect to where the server has a stream.

        Raises:
            ProtocolError: the agent has not asked for its token.
            OSError: the server does not answer.
        """
        endpoint = gate.endpoints.get(stream_id)
        if endpoint is None:
            raise ProtocolError(f"stream {stream_id} was subscribed to without a token")
        host = self._host if endpoint.host in (None, *_ANY_ADDRESS) else endpoint.host
        return socket.create_connection((host, endpoint.port), CONNECT_S)

    def _watch(self, link: _Link) -> None:
        """Let the selector watch for what can be done with both ends of a link now."""
        if link not in self._links:
            return
        ends = [(link.agent, link.server, link.from_agent)]
        if link.server is not None:
            ends.append((link.server, link.agent, link.from_server))
        for end, other, take in ends:
            reads = other is None or other.outgoing.waiting_bytes < MOST_WAITING_BYTES
            interest = (_READ if reads else 0) | (_WRITE if end.outgoing.waiting_bytes else 0)
            if interest == end.interest:
                continue
            serve = partial(self._serve, link, end, take)
            if not interest:
                self._selector.unregister(end.socket)
            elif not end.interest:
                self._selector.register(end.socket, interest, serve)
            else:
                self._selector.modify(end.socket, interest, serve)
            end.interest = interest

    def _serve(self, link: _Link, end: _End, take: Callable[[bytes], None], events: int) -> None:
        if link in self._links:  # else it was closed in this very turn
            self._guarded(link, partial(self._pass_on, link, end, take, events))

    def _pass_on(self, link: _Link, end: _End, take: Callable[[bytes], None], events: int) -> None:
        """Send what waits for one end, and take what has come from it.

        Raises:
            OSError, ProtocolError: the link is to be closed.
        """
        if events & _WRITE:
            end.outgoing.flush()
        if not events & _READ:
            return
        with contextlib.suppress(BlockingIOError, InterruptedError):
            data = end.socket.recv(RECEIVED_AT_ONCE)
            if data:
                take(data)
            else:
                self._close(link)

    def _guarded(self, link: _Link, act: Callable[[], None]) -> None:
        """Carry something out for a link, and close the link where that fails."""
        try:
            act()
        except ProtocolError as error:
            log.warning("the gate closes a connection: %s", error)
            self._close(link)
        except OSError as error:
            log.info("a connection through the gate is gone: %s", error)
            self._close(link)
        self._watch(link)

    def _close(self, link: _Link) -> None:
        if self._links.pop(link, 0) == 0:
            return
        for end in (link.agent, link.server):
            if end is not None:
                if end.interest:
                    self._selector.unregister(end.socket)
                end.socket.close()
