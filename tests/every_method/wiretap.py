"""A proxy before the server's RPC port that notes which remote functions are called, and which are refused."""

import multiprocessing
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing.managers import BaseManager
from typing import Any, NamedTuple

import msgpack

_KEY = b"linden"
"""Tells this wiretap's client from a stranger's; both are on this machine and of one test."""


class RemoteCall(NamedTuple):
    """One remote call as it went over the wire."""

    function: str
    is_async: bool


class Wiretap:
    """Listens on a port of its own, passes all bytes on unchanged, and reads along.

    Streams do not pass here: a token names the streaming port itself. What is read of calls and answers is asked for
    by :meth:`calls` and :meth:`refusal`, after a call of which the answer has come back.
    """

    def __init__(self, server_port: int) -> None:
        self._server_port = server_port
        self._listener = socket.create_server(("127.0.0.1", 0))
        self._lock = threading.Lock()
        self._calls: list[RemoteCall] = []
        self._refusals: dict[int, str] = {}  # position in _calls -> sentence
        threading.Thread(target=self._accept, daemon=True).start()

    def port(self) -> int:
        """Return the port to connect to instead of the server's."""
        port: int = self._listener.getsockname()[1]
        return port

    def position(self) -> int:
        """Return how many calls have been made."""
        return len(self._calls)

    def calls(self, begin: int, end: int) -> list[RemoteCall]:
        """Return the calls between two positions."""
        return self._calls[begin:end]

    def refusals(self, begin: int, end: int) -> list[tuple[RemoteCall, str]]:
        """Return those of the calls that were refused, each with its sentence."""
        return [(self._calls[at], self._refusals[at]) for at in range(begin, end) if at in self._refusals]

    def _accept(self) -> None:
        while True:
            client, _ = self._listener.accept()
            server = socket.create_connection(("127.0.0.1", self._server_port))
            for side in (client, server):
                side.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            open_calls: dict[int, int] = {}  # message id of this connection -> position
            for source, sink, read in ((client, server, self._asked), (server, client, self._answered)):
                threading.Thread(target=_pass_on, args=(source, sink, read, open_calls), daemon=True).start()

    def _asked(self, message: list[Any], open_calls: dict[int, int]) -> None:
        _, number, function, parameters = message
        with self._lock:
            open_calls[number] = len(self._calls)
            self._calls.append(RemoteCall(function, parameters[0][0]))

    def _answered(self, message: list[Any], open_calls: dict[int, int]) -> None:
        _, number, error, result = message
        sentence = _sentence(error, result)
        if sentence is not None:
            self._refusals[open_calls[number]] = sentence


class _Process(BaseManager):
    """The process in which wiretaps live."""


_Process.register("Wiretap", Wiretap)


@contextmanager
def wiretaps() -> Iterator[str]:
    """Start a process for wiretaps; yield what :func:`wiretap` needs to find it.

    The official client holds Python's lock while some of its calls wait for their answer, so that no other thread of
    its process could pass the answer on.
    """
    with _Process(("127.0.0.1", 0), authkey=_KEY, ctx=multiprocessing.get_context("spawn")) as process:
        yield str(process.address[1])


def wiretap(where: str, server_port: int) -> Wiretap:
    """Tap a server's wire; to be called in the process of the client."""
    process = _Process(("127.0.0.1", int(where)), authkey=_KEY)
    process.connect()
    tap: Wiretap = process.Wiretap(server_port)  # type: ignore[attr-defined]
    return tap


def _pass_on(source: socket.socket, sink: socket.socket, read: Any, open_calls: dict[int, int]) -> None:
    """Carry bytes in one direction until either side closes; read first, so that what has arrived has been read."""
    unpacker = msgpack.Unpacker(max_buffer_size=0, strict_map_key=False, raw=False, unicode_errors="surrogateescape")
    try:
        while data := source.recv(1 << 20):
            unpacker.feed(data)
            for message in unpacker:
                read(message, open_calls)
            sink.sendall(data)
        sink.shutdown(socket.SHUT_WR)
    except OSError:  # one side has gone: the other is told
        sink.close()


def _sentence(error: object, result: Any) -> str | None:
    """Return the sentence of a refusal: of a value, of a function without one, or of the first command of a batch."""
    if error is not None:
        return str(error)
    for answer in result if isinstance(result, list) else ():
        match answer:
            case [True, [str() as sentence]] | [0, [str() as sentence]] | [[0, [str() as sentence]]]:
                return sentence
    return None
