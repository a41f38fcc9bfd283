"""Clients that are less polite than the official one: they speak bytes."""

import socket
import struct
from typing import Any

import msgpack
from typing_extensions import Self

TIMEOUT_S = 20.0


def request(number: int, method: str, *args: Any, is_async: bool = False) -> bytes:
    """The bytes of a call."""
    packed: bytes = msgpack.packb([0, number, method, [[is_async], *args]])
    return packed


class RawClient:
    """One RPC connection, of which the test decides every byte."""

    def __init__(self, port: int, timeout_s: float = TIMEOUT_S) -> None:
        self.socket = socket.create_connection(("127.0.0.1", port), timeout_s)
        self._unpacker = msgpack.Unpacker(max_buffer_size=2**30)
        self._id = 0

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.socket.close()

    def request(self, method: str, *args: Any, is_async: bool = False) -> bytes:
        self._id += 1
        return request(self._id, method, *args, is_async=is_async)

    def send(self, method: str, *args: Any) -> int:
        """Send a call and do not wait; return its id."""
        self.socket.sendall(self.request(method, *args))
        return self._id

    def answer(self) -> list[Any]:
        """The next answer, whole."""
        while True:
            for message in self._unpacker:
                assert isinstance(message, list)
                return message
            data = self.socket.recv(65536)
            if not data:
                raise EOFError("the server has closed the connection")
            self._unpacker.feed(data)

    def call(self, method: str, *args: Any) -> Any:
        """The value a function returns; RuntimeError with the sentence of a refusal."""
        sent = self.send(method, *args)
        kind, number, error, result = self.answer()
        assert (kind, number) == (1, sent)
        if error is not None:
            raise RuntimeError(error)
        ((failed_or_kind, *rest),) = result
        if failed_or_kind is True or (failed_or_kind == 0 and failed_or_kind is not False):
            raise RuntimeError(rest[0][0])
        return rest[0] if rest else None

    def reset(self) -> None:
        """Vanish as a killed process does."""
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self.socket.close()

    def is_closed(self) -> bool:
        """Whether the server closes this connection (waits for it)."""
        try:
            return not self.socket.recv(65536)
        except ConnectionError:
            return True


class RawSubscriber:
    """One stream connection."""

    def __init__(self, port: int, stream_id: int) -> None:
        self.socket = socket.create_connection(("127.0.0.1", port), TIMEOUT_S)
        self.socket.sendall(struct.pack("<I", stream_id))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.socket.close()

    def message(self) -> bytes:
        (size,) = struct.unpack("<I", self._exactly(4))
        return self._exactly(size)

    def frame(self) -> int:
        """Frame number of the next message."""
        frame: int = struct.unpack_from("<Q", self.message(), 8)[0]
        return frame

    def _exactly(self, size: int) -> bytes:
        data = b""
        while len(data) < size:
            part = self.socket.recv(size - len(data))
            if not part:
                raise EOFError("the server has closed the stream")
            data += part
        return data
