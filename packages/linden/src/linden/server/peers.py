"""Connections: connections that call, connections that subscribe.

A client calls on one kind of connection and receives streams on the other. Each owns its socket. A queue before the
non-blocking socket holds the bytes for a peer that reads slowly or never.
"""

import socket
from collections import deque
from collections.abc import Container

from linden.gate.session import Gate
from linden.protocol.wire.rpc import Call, RpcConnection
from linden.protocol.wire.stream import Subscription, size_prefix
from linden.server.outgoing import Outgoing

RECEIVED_AT_ONCE = 256 * 1024
"""Bytes read from a connection before the others have their turn."""


class Peer:
    """A connection: its socket, what waits to be sent, and a name for the log."""

    def __init__(self, sock: socket.socket, number: int) -> None:
        sock.settimeout(0.0)
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)  # finds out about machines that vanished
        self.socket = sock
        self.number = number
        self.outgoing = Outgoing(sock)
        self.interest = 0
        """Which events the selector watches for; 0 where it does not know the socket."""
        self.is_open = True
        self.gate: Gate | None = None
        """What an agent's connection may do; None for connections that may do everything."""
        host, port, *_ = sock.getpeername()
        self.address = f"[{host}]:{port}" if ":" in host else f"{host}:{port}"

    def read(self) -> bytes | None:
        """Return what has come, ``b""`` at the end of the connection, None where there is nothing.

        Raises:
            OSError: the peer is gone.
        """
        try:
            return self.socket.recv(RECEIVED_AT_ONCE)
        except (BlockingIOError, InterruptedError):
            return None

    def flush(self) -> None:
        """Send what the system takes of what waits.

        Raises:
            OSError: the peer is gone.
        """
        self.outgoing.flush()


class RpcPeer(Peer):
    """A client that calls."""

    def __init__(self, sock: socket.socket, number: int) -> None:
        super().__init__(sock, number)
        self.connection = RpcConnection()
        self.calls: deque[Call] = deque()
        """Received and not yet carried out, in their order."""
        self._waiting_since = 0, 0
        """Bytes and arrays of whole calls that had arrived when the first waiting call arrived."""
        self.at_end = False
        """Whether the client sends nothing more."""

    def receive(self, data: bytes) -> None:
        """Take in what has come.

        Raises:
            ProtocolError: it is no call.
        """
        if not self.calls:
            came = self.connection
            self._waiting_since = came.bytes - came.unfinished_bytes, came.arrays - came.unfinished_arrays
        self.calls.extend(self.connection.receive(data))

    def bring_forward(self, methods: Container[str]) -> str | None:
        """Put the first call of one of ``methods`` before all others; return its method, None where there is none."""
        for index, call in enumerate(self.calls):
            if call.method in methods:
                del self.calls[index]
                self.calls.appendleft(call)
                return call.method
        return None

    def held(self) -> tuple[int, int]:
        """Return how many bytes and arrays have come and are not carried out: whole calls that wait, and half ones."""
        came = self.connection
        if not self.calls:
            return came.unfinished_bytes, came.unfinished_arrays
        return came.bytes - self._waiting_since[0], came.arrays - self._waiting_since[1]

    def __str__(self) -> str:
        return f"client {self.number} at {self.address}"


class StreamPeer(Peer):
    """A client that listens to one stream."""

    def __init__(self, sock: socket.socket, number: int) -> None:
        super().__init__(sock, number)
        self.subscription = Subscription()
        self.dropped = 0
        """Messages it did not get, because a newer one took their place before it had read those before."""
        self.congested_since_s: float | None = None
        """When it fell behind by more than is queued for it, in synchronous mode."""
        self.held: bytes | None = None
        """A snapshot that waits until its gate knows what the agent sees in it."""
        self._newest: bytes | None = None  # kept until all before it is sent; asynchronous mode

    def __str__(self) -> str:
        stream = self.subscription.stream_id
        return f"subscriber {self.number} at {self.address}" + ("" if stream is None else f" of stream {stream}")

    def publish(self, payload: bytes) -> None:
        """Send a message, or queue what the system does not take; none is lost.

        Raises:
            OSError: the peer is gone.
        """
        self._send_newest()
        self.outgoing.send(size_prefix(len(payload)), payload)

    def offer(self, payload: bytes) -> None:
        """Send a message, or keep it until those before it are read; a newer one then takes its place.

        Raises:
            OSError: the peer is gone.
        """
        if not self.outgoing.waiting_bytes:
            self.publish(payload)
            return
        if self._newest is not None:
            self.dropped += 1
        self._newest = payload

    def flush(self) -> None:
        """Send what the system takes of what waits, and the newest message behind it.

        Raises:
            OSError: the peer is gone.
        """
        self.outgoing.flush()
        if not self.outgoing.waiting_bytes:
            self._send_newest()

    def _send_newest(self) -> None:
        if self._newest is not None:
            kept, self._newest = self._newest, None
            self.outgoing.send(size_prefix(len(kept)), kept)
