"""`PageLink`: the way from a source of frames to the process that serves the pages, and orders of pages back.

The pages have a process of their own, so that no page can delay a tick: the source writes to a socket that never
blocks. A frame that finds the socket full is dropped. Orders come back as lines of JSON.
"""

import json
import logging
import math
import os
import socket
import struct
import subprocess
import sys
from typing import Any

from linden.errors import UserError
from linden.server.outgoing import Outgoing

log = logging.getLogger("linden")

PREFIX = struct.Struct("<cI")
"""Kind of a message (``NOTE``, ``FRAME``, ``PANE`` or ``BLOB``) and its length in bytes."""
NOTE, FRAME, PANE, BLOB = b"J", b"F", b"P", b"B"
MOST_WAITING = 64 * 1024 * 1024
"""More bytes than this waiting mean that the process of the pages has stopped; then the link ends."""
_BUFFER = 1024 * 1024
START_S = 60.0
"""How long the process may take to open its port: a second, or many of them on a busy machine."""


class PageLink:
    """The source's end. ``fileno`` becomes readable when a page has sent something.

    Attributes:
        address: what a person opens in a browser.
        dropped: how many frames found the socket full.
    """

    def __init__(self, sock: socket.socket, process: "subprocess.Popen[bytes] | None", address: str) -> None:
        self._socket, self._process, self.address = sock, process, address
        self._out = Outgoing(sock)
        self._received = b""
        self.dropped = 0
        self.is_open = True
        sock.setblocking(False)

    @classmethod
    def start(cls, *options: str, host: str = "127.0.0.1", port: int = 0) -> "PageLink":
        """Start the process of the pages and return the link to it.

        Raises:
            UserError: the process ends at once, such as because its port is taken.
        """
        return StartingLink(*options, host=host, port=port).ready()

    def fileno(self) -> int:
        """Return the number of the socket, for a selector."""
        return self._socket.fileno()

    @property
    def is_behind(self) -> bool:
        """Whether an earlier message still waits, so that a frame would wait behind it."""
        self.flush()
        return bool(self._out.waiting_bytes) or not self.is_open

    def frame(self, packed: bytes) -> None:
        """Send a frame, or drop it if an earlier message still waits."""
        if self.is_behind:
            self.miss()
        else:
            self._send(FRAME, packed)

    def miss(self) -> None:
        """Count a frame that was not sent."""
        self.dropped += 1

    def note(self, facts: dict[str, Any]) -> None:
        """Send facts; they wait if the socket is full."""
        try:
            text = json.dumps(facts, separators=(",", ":"), allow_nan=False)
        except ValueError:
            text = json.dumps(_finite(facts), separators=(",", ":"), allow_nan=False)
        self._send(NOTE, text.encode())

    def pane(self, name: str, packed: bytes) -> None:
        """Send a sensor's measurement (:mod:`linden_window.panes`); it waits if the socket is full."""
        self._send(PANE, name.encode() + b"\n" + packed)

    def blob(self, name: str, content: bytes) -> None:
        """Send a file that pages can fetch as ``record/NAME``; the content is compressed by gzip."""
        self._send(BLOB, name.encode() + b"\n" + content)

    def _send(self, kind: bytes, content: bytes) -> None:
        if not self.is_open:
            return
        try:
            self._out.send(PREFIX.pack(kind, len(content)), content)
        except OSError as error:
            self._lose(str(error))
            return
        if self._out.waiting_bytes > MOST_WAITING:
            self._lose("its process reads nothing")

    def flush(self) -> None:
        """Send what waits, as far as the socket takes it."""
        if self.is_open and self._out.waiting_bytes:
            try:
                self._out.flush()
            except OSError as error:
                self._lose(str(error))

    def orders(self) -> list[dict[str, Any]]:
        """Return what pages have asked for since the last call; [] once the link has ended."""
        self.flush()
        while self.is_open:
            try:
                data = self._socket.recv(65536)
            except (BlockingIOError, InterruptedError):
                break
            except OSError as error:
                self._lose(str(error))
                break
            if not data:
                self._lose("its process has ended")
                break
            self._received += data
        *lines, self._received = self._received.split(b"\n")
        return [json.loads(line) for line in lines]

    def _lose(self, reason: str) -> None:
        if self.is_open:
            self.is_open = False
            log.warning("the window is closed: %s; the world goes on without it", reason)

    def close(self) -> None:
        """End the process of the pages; they say that the source has ended."""
        self.is_open = False
        self._socket.close()
        if self._process is not None:
            try:
                self._process.wait(2.0)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()


class StartingLink:
    """The process of the pages while it starts, so that its parent can start beside it."""

    def __init__(self, *options: str, host: str = "127.0.0.1", port: int = 0) -> None:
        """Start the process, with one end of a socket pair as its link."""
        self._ours, theirs = socket.socketpair()
        for end in (self._ours, theirs):
            end.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _BUFFER)
        command = [
            sys.executable, "-m", "linden_window", "--link", str(theirs.fileno()), "--host", host, "--port", str(port),
            *options,
        ]  # fmt: skip
        environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
        self._process = subprocess.Popen(  # noqa: S603 - our own module
            command, pass_fds=(theirs.fileno(),), stdin=subprocess.DEVNULL, env=environment, start_new_session=True
        )
        theirs.close()

    def ready(self) -> PageLink:
        """Return the link once the process has opened its port.

        Raises:
            UserError: the process ends at once, such as because its port is taken.
        """
        self._ours.settimeout(START_S)
        first = b""
        try:
            while not first.endswith(b"\n"):
                data = self._ours.recv(4096)
                if not data:
                    break
                first += data
        except TimeoutError:
            pass
        said = json.loads(first) if first.endswith(b"\n") else {"error": "the process of the window did not start"}
        if "error" in said:
            self.end()
            raise UserError(said["error"])
        return PageLink(self._ours, self._process, said["address"])

    def end(self) -> None:
        """End the process before it is ready."""
        self._ours.close()
        self._process.terminate()
        self._process.wait()


def _finite(value: Any) -> Any:  # noqa: ANN401 - any value of JSON
    """Return a value with 0 in the place of numbers that JSON does not know, such as nan in a debug shape."""
    if isinstance(value, float):
        return value if math.isfinite(value) else 0.0
    if isinstance(value, dict):
        return {name: _finite(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(each) for each in value]
    return value
