"""Messages between the benchmark and an agent's process, over a pair of sockets.

The benchmark sends pickles, which the agent's process may trust. The agent's process answers in JSON: an agent could
write to the socket itself, and a pickle from it would run its code in the benchmark.
"""

from __future__ import annotations

import json
import pickle
import select
import socket
import struct
import time
from typing import Any

from basu.files import printable

LENGTH = struct.Struct("<I")  # before each message: its length in bytes
MOST_BYTES = 8 << 20  # of an answer: more is none that BASU's own code gives
CHUNK_BYTES = 1 << 16
POLL_S = 0.05  # between two looks at the process's life and memory, where the system does not tell by itself


class ChannelClosedError(Exception):
    """The other end is gone, or sends what is no message."""


class AgentsEnd:
    """The agent's end: waits for a request as long as it takes."""

    def __init__(self, descriptor: int) -> None:
        self._socket = socket.socket(fileno=descriptor)

    def receive(self) -> Any:  # noqa: ANN401 - a request
        """Return the benchmark's next request.

        Raises:
            ChannelClosedError: the benchmark is gone.
        """
        (length,) = LENGTH.unpack(self._exactly(LENGTH.size))
        return pickle.loads(self._exactly(length))  # noqa: S301 - from the benchmark, which started this process

    def send(self, answer: list[Any]) -> None:
        """Send an answer; nothing happens where the benchmark is gone, which ``receive`` finds out."""
        data = json.dumps(answer).encode()
        try:
            self._socket.sendall(LENGTH.pack(len(data)) + data)
        except OSError:
            return

    def _exactly(self, count: int) -> bytes:
        parts = b""
        while len(parts) < count:
            try:
                part = self._socket.recv(count - len(parts))
            except OSError as error:
                raise ChannelClosedError from error
            if not part:
                raise ChannelClosedError
            parts += part
        return parts


class BenchmarksEnd:
    """The benchmark's end: never waits beyond a deadline, whatever the other end sends or leaves unsent."""

    def __init__(self, connected: socket.socket, life: int | None) -> None:
        """``life`` is a descriptor that turns readable when the agent's process ends, None where there are none."""
        self._socket, self._life = connected, life
        connected.setblocking(False)
        self._received = bytearray()
        self._poll = select.poll()
        self._poll.register(connected, select.POLLIN)
        if life is not None:
            self._poll.register(life, select.POLLIN)

    def send(self, request: tuple[Any, ...], deadline_s: float) -> bool:
        """Send a request; False where the other end does not take it before ``deadline_s`` of ``time.monotonic``.

        Raises:
            ChannelClosedError: the other end is gone.
        """
        data = pickle.dumps(request)
        rest = memoryview(LENGTH.pack(len(data)) + data)
        while rest:
            try:
                rest = rest[self._socket.send(rest) :]
            except BlockingIOError:  # noqa: PERF203 - once, but for messages larger than the socket takes
                if time.monotonic() > deadline_s:
                    return False
                select.select([], [self._socket], [], POLL_S)
            except OSError as error:
                raise ChannelClosedError from error
        return True

    def receive(self, until_s: float) -> list[Any] | None:
        """The next answer; None where there is none until ``until_s`` of ``time.monotonic``, or the process ended.

        Raises:
            ChannelClosedError: the other end is gone, or sent what is no answer.
        """
        while (answer := self._complete()) is None:
            left_s = until_s - time.monotonic()
            ready = dict(self._poll.poll(max(0.0, left_s) * 1000.0))
            if self._socket.fileno() in ready:
                self._read()
            elif ready or left_s <= 0.0:
                return None
        return answer

    def close(self) -> None:
        """Close the socket to the agent's process."""
        self._socket.close()

    def _read(self) -> None:
        try:
            part = self._socket.recv(CHUNK_BYTES)
        except BlockingIOError:
            return
        except OSError as error:
            raise ChannelClosedError from error
        if not part:
            raise ChannelClosedError
        self._received += part

    def _complete(self) -> list[Any] | None:
        """The first answer of what was received, where it is complete."""
        if len(self._received) < LENGTH.size:
            return None
        (length,) = LENGTH.unpack_from(self._received)
        if length > MOST_BYTES:
            raise ChannelClosedError
        end = LENGTH.size + length
        if len(self._received) < end:
            return None
        try:
            answer = printable(json.loads(bytes(self._received[LENGTH.size : end])))
        except (ValueError, RecursionError) as error:
            raise ChannelClosedError from error
        del self._received[:end]
        if not isinstance(answer, list):
            raise ChannelClosedError
        return answer
