"""`Outgoing`: the queue before a non-blocking socket, for a peer that reads slowly or never."""

import socket
from collections import deque

JOINED_BYTES = 64 * 1024
"""Up to this size a message is copied behind its prefix, which is quicker than a second call of the system."""


class Outgoing:
    """What waits to be sent over one socket, in order, none of it copied."""

    def __init__(self, sock: socket.socket) -> None:
        self._socket = sock
        self._queue: deque[memoryview] = deque()
        self.waiting_bytes = 0

    def send(self, *parts: bytes) -> None:
        """Send now what the system takes, and queue the rest.

        Raises:
            OSError: the peer is gone.
        """
        if sum(map(len, parts)) <= JOINED_BYTES:
            parts = (b"".join(parts),)
        was_idle = not self._queue
        for part in parts:
            self._queue.append(memoryview(part))
            self.waiting_bytes += len(part)
        if was_idle:  # else the system takes nothing yet, and the selector will say when it does
            self.flush()

    def flush(self) -> None:
        """Send what the system takes of what waits.

        Raises:
            OSError: the peer is gone.
        """
        while self._queue:
            first = self._queue[0]
            try:
                sent = self._socket.send(first)
            except (BlockingIOError, InterruptedError):
                return
            self.waiting_bytes -= sent
            if sent < len(first):
                self._queue[0] = first[sent:]
                return
            self._queue.popleft()
