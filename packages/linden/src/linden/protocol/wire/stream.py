"""Sensor streams: the token that names one, the four bytes that subscribe to it, the size before every message.

Source: LibCarla 0.9.16, ``carla/streaming/detail/Token.h`` and ``tcp/ServerSession.cpp``.
"""

import struct
from ipaddress import ip_address
from typing import NamedTuple

from linden.errors import ProtocolError

WORLD_OBSERVER_ID = 1
"""Stream id of the world snapshot; CARLA uses the same."""

_TOKEN = struct.Struct("<IHBB16x")  # stream id, port, protocol, address type, address
_TCP = 1
_SAME_HOST = 0  # no address: the client goes to the host of its RPC connection, which also works through a tunnel
_SIZE = struct.Struct("<I")
_HANDSHAKE = struct.Struct("<I")
MAX_PAYLOAD_BYTES = 2**32 - 1
assert _TOKEN.size == 24  # Token.h asserts the same


class Token(NamedTuple):
    """A stream token as the RPC functions return it: one raw field of 24 bytes."""

    data: bytes


def token_bytes(stream_id: int, port: int) -> bytes:
    """Return the 24 bytes that tell a client where to subscribe."""
    return _TOKEN.pack(stream_id, port, _TCP, _SAME_HOST)


class Endpoint(NamedTuple):
    """Where a token says that a stream is to be had."""

    stream_id: int
    port: int
    host: str | None
    """None: the host of the RPC connection."""


_ADDRESS_BYTES = {1: 4, 2: 16}  # IPv4, IPv6


def read_token(data: bytes) -> Endpoint:
    """Return what a token names.

    Raises:
        ProtocolError: these are no 24 bytes of a TCP token.
    """
    if len(data) != _TOKEN.size:
        raise ProtocolError(f"expected a stream token of {_TOKEN.size} bytes, got {len(data)}")
    stream_id, port, protocol, kind = _TOKEN.unpack(data)
    if protocol != _TCP or kind not in (_SAME_HOST, *_ADDRESS_BYTES):
        raise ProtocolError(f"expected a TCP token, got protocol {protocol} with address type {kind}")
    if kind == _SAME_HOST:
        return Endpoint(stream_id, port, None)
    return Endpoint(stream_id, port, str(ip_address(data[8 : 8 + _ADDRESS_BYTES[kind]])))


def size_prefix(payload_bytes: int) -> bytes:
    """Return the four bytes before a message of that size; the client reconnects on a size of zero."""
    if not 0 < payload_bytes <= MAX_PAYLOAD_BYTES:
        raise ValueError(f"a stream message has 1 to {MAX_PAYLOAD_BYTES} bytes, not {payload_bytes}")
    return _SIZE.pack(payload_bytes)


class Subscription:
    """The server's half of one stream connection: waits for the stream id, and nothing after it."""

    def __init__(self) -> None:
        self._received = b""
        self.stream_id: int | None = None

    def receive(self, data: bytes) -> bool:
        """Take what arrived; True when it completes the stream id.

        Raises:
            ProtocolError: more than a stream id came.
        """
        self._received += data[: _HANDSHAKE.size + 1]
        if len(self._received) > _HANDSHAKE.size:
            raise ProtocolError("expected the 4 bytes of a stream id and nothing after them, got more")
        if len(self._received) < _HANDSHAKE.size or self.stream_id is not None:
            return False
        (self.stream_id,) = _HANDSHAKE.unpack(self._received)
        return True


class StreamTable:
    """The sensor streams: the port that tokens name, and the number of subscribers of each stream."""

    def __init__(self, port: int) -> None:
        self.port = port
        self._subscribers: dict[int, int] = {}

    def token(self, stream_id: int) -> Token:
        """Return the token of a stream."""
        return Token(token_bytes(stream_id, self.port))

    def listened(self) -> set[int]:
        """Return the streams with subscribers; the other streams need not be computed."""
        return set(self._subscribers)

    def subscribe(self, stream_id: int) -> None:
        """Count one subscriber more."""
        self._subscribers[stream_id] = self._subscribers.get(stream_id, 0) + 1

    def unsubscribe(self, stream_id: int) -> None:
        """Count one subscriber less."""
        self._subscribers[stream_id] -= 1
        if not self._subscribers[stream_id]:
            del self._subscribers[stream_id]
