"""Stands between the official client and a server and writes down what the client says."""

import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress

import msgpack


class Eavesdropper:
    """A port that leads to another, and the calls that came through it."""

    def __init__(self, target_port: int) -> None:
        self._target_port = target_port
        self._door = socket.create_server(("127.0.0.1", 0))
        self.port: int = self._door.getsockname()[1]
        self.heard: list[bytearray] = []
        """What each connection said, in the order of their coming."""
        self._sockets: list[socket.socket] = []
        self._threads: list[threading.Thread] = []
        self._start(self._let_in)

    def messages(self) -> list[bytes]:
        """All calls that came whole, each as it travelled."""
        found = []
        for said in self.heard:
            unpacker, begin = msgpack.Unpacker(unicode_errors="surrogateescape"), 0
            unpacker.feed(said)
            for _ in unpacker:
                found.append(bytes(said[begin : unpacker.tell()]))
                begin = unpacker.tell()
        return found

    def close(self) -> None:
        for each in (self._door, *self._sockets):
            with_nobody_there(each)
        for thread in self._threads:
            thread.join(10)

    def _start(self, work: object, *arguments: object) -> None:
        thread = threading.Thread(target=work, args=arguments, daemon=True)
        self._threads.append(thread)
        thread.start()

    def _let_in(self) -> None:
        while True:
            try:
                client, _ = self._door.accept()
            except OSError:
                return
            server = socket.create_connection(("127.0.0.1", self._target_port))
            self._sockets += [client, server]
            self.heard.append(bytearray())
            self._start(pass_on, client, server, self.heard[-1])
            self._start(pass_on, server, client, bytearray())


def pass_on(source: socket.socket, target: socket.socket, heard: bytearray) -> None:
    try:
        while data := source.recv(65536):
            heard += data
            target.sendall(data)
    except OSError:
        pass
    with_nobody_there(target)


def with_nobody_there(each: socket.socket) -> None:
    """End both directions, whether or not somebody is still there."""
    with suppress(OSError):
        each.shutdown(socket.SHUT_RDWR)
    each.close()


@contextmanager
def eavesdropping(target_port: int) -> Iterator[Eavesdropper]:
    found = Eavesdropper(target_port)
    try:
        yield found
    finally:
        found.close()
