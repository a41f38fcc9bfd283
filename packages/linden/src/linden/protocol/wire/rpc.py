"""msgpack-RPC of CARLA 0.9.16: bytes in, calls out; results in, bytes out. No socket, no thread.

A request is ``[0, id, method, [[is_async], *arguments]]``, an answer ``[1, id, error, result]``; neither has a length
before it. The result of a function with a value is ``[[1, value]]`` or ``[[0, [message]]]``. The result of a function
without a value is ``[[false]]`` or ``[[true, [message]]]`` (LibCarla, ``carla/rpc/Response.h``).

An encoder turns typed values into what msgpack packs. It is built once from the annotation of a result. None means
that values of that type need no encoding; only optional values are wrapped.
"""

import types
from collections.abc import Callable
from typing import Annotated, Any, Union, get_args, get_origin, get_type_hints

import msgpack

from linden.errors import ProtocolError
from linden.protocol.wire import packed
from linden.protocol.wire.answers import (
    Call,
    Packed,
    Reply,
    bare,
    call_of,
    packed_result,
    refusal,
    unknown,
    value,
    void,
)

__all__ = [
    "Call",
    "Packed",
    "Reply",
    "RpcConnection",
    "bare",
    "call_of",
    "encoder",
    "packed_result",
    "refusal",
    "unknown",
    "value",
    "void",
]

MAX_MESSAGE_BYTES = 64 * 1024 * 1024
"""Largest request; an OpenDRIVE text of a big town is 10 MB, a 4k texture as floats 40 MB."""
MAX_ARRAYS = 256 * 1024
"""Most arrays in one message, one within another or side by side. An empty one is a byte of the message and 70 bytes of
memory. The server serves no client while it frees them, which takes 0.07 s for that many. Bytes that look like
the first byte of an array are counted, so a text has none and numbers have a few too many. A batch of 10,000 commands
has 60,000."""
MAX_ARRAY_ITEMS = 4 * 1024 * 1024
"""Most items of one array: its list is laid out before the items come, so that 5 bytes must not ask for gigabytes."""

OF_PIXELS = ("apply_color_texture_to_objects", "apply_float_color_texture_to_objects")
"""What has an array for each pixel, 2 Mi in 1920 x 1080; nothing reads them, so no objects are made of them."""

_OF_PIXELS = b"_color_texture_to_objects"
"""What stands in both names."""
_ARRAYS = bytes((*range(0x80, 0xA0), 0xDC, 0xDD, 0xDE, 0xDF))
"""The first bytes of arrays and maps in msgpack."""
_HEAD_BYTES = 64 * 1024  # method and names of objects
_FIRST_BUFFER_BYTES = 4096  # what a buffer starts with; it grows
_KEPT_BUFFER_BYTES = 1_000_000
"""After as many bytes an unpacker is replaced, because its buffer never shrinks: a text of 34 MB leaves 64 MB."""
_UNPACKING_FAILED = (ValueError, msgpack.UnpackException, MemoryError, OverflowError, TypeError)


class RpcConnection:
    """The server's half of one connection: turns what arrives into calls."""

    def __init__(self) -> None:
        self._unpacker = _empty_unpacker()
        self._fed_bytes = self._whole_bytes = 0  # what this unpacker has got, and up to where that is whole calls
        self.bytes = self.arrays = 0
        """How much has come in all."""
        self.unfinished_arrays = 0
        """How many arrays a call has at most that is not yet whole."""
        self._passed_over: Call | None = None  # that of which the rest is not decoded
        self._failure: ProtocolError | None = None

    def receive(self, data: bytes) -> list[Call]:
        """Return the calls that ``data`` completes; a half-received one waits for its rest.

        Calls that are whole before the broken place are returned first; the next call of this method then raises.

        Raises:
            ProtocolError: the bytes are not msgpack, not a call, or more than :data:`MAX_MESSAGE_BYTES` for one call.
        """
        calls: list[Call] = []
        try:
            self._take(data, calls)
        except ProtocolError as error:
            self._failure = error
        if self._failure is not None and not calls:
            raise self._failure
        return calls

    @property
    def unfinished_bytes(self) -> int:
        """How much of a call has come that is not yet whole."""
        return self._fed_bytes - self._whole_bytes

    @property
    def is_broken(self) -> bool:
        """Return whether the peer has sent bytes after which no message can be decoded."""
        return self._failure is not None

    def _take(self, data: bytes, calls: list[Call]) -> None:
        if self._failure is not None:
            return
        self.bytes += len(data)
        if self._fed_bytes == self._whole_bytes and (batch := packed.read(data)) is not None:
            calls.append(Call(batch.call_id, packed.BATCH, [batch.controls, batch.do_tick], batch.is_async))
            data = data[batch.end :]
        begin = self._fed_bytes
        self._fed_bytes += len(data)
        if self._passed_over is None:
            self._passed_over = _of_pixels(data) if begin == self._whole_bytes else None
        if self._passed_over is None:
            arrays = len(data) - len(data.translate(None, _ARRAYS))
            self.arrays += arrays
            self.unfinished_arrays += arrays
        if self.unfinished_arrays > MAX_ARRAYS:
            raise ProtocolError(f"a message has more than {MAX_ARRAYS} arrays")
        self._unpack(data, calls)
        if self.unfinished_bytes > MAX_MESSAGE_BYTES:
            raise ProtocolError(f"a message is longer than {MAX_MESSAGE_BYTES} bytes")
        if self._fed_bytes == self._whole_bytes > _KEPT_BUFFER_BYTES:
            self._unpacker, self._fed_bytes, self._whole_bytes = _empty_unpacker(), 0, 0

    def _unpack(self, data: bytes, calls: list[Call]) -> None:
        """Append the calls that are whole with what has come.

        Raises:
            ProtocolError: what has come is no call.
        """
        try:
            self._unpacker.feed(data)
            while True:
                calls.append(self._next())
                self._whole_bytes = self._unpacker.tell()
                self.unfinished_arrays = 0
        except msgpack.OutOfData:
            pass
        except _UNPACKING_FAILED as error:
            raise ProtocolError(f"what arrived is not msgpack of a call: {error or type(error).__name__}") from error

    def _next(self) -> Call:
        """Return the next call that is whole.

        Raises:
            msgpack.OutOfData: there is none.
        """
        if self._passed_over is None:
            return call_of(self._unpacker.unpack())
        self._unpacker.skip()
        call, self._passed_over = self._passed_over, None
        return call


def _empty_unpacker() -> msgpack.Unpacker:
    return msgpack.Unpacker(
        raw=False,
        unicode_errors="surrogateescape",  # a text that is not UTF-8 comes back as it came
        max_buffer_size=MAX_MESSAGE_BYTES,
        read_size=_FIRST_BUFFER_BYTES,
        max_array_len=MAX_ARRAY_ITEMS,
        max_map_len=0,  # CARLA sends none
    )


def _of_pixels(data: bytes) -> Call | None:
    """Return the call that ``data`` begins with, where it is one of :data:`OF_PIXELS`; its pixels are None."""
    if data.find(_OF_PIXELS, 0, 64) < 0:
        return None
    head = msgpack.Unpacker(unicode_errors="surrogateescape", max_array_len=MAX_ARRAY_ITEMS, max_map_len=0)
    head.feed(data[:_HEAD_BYTES])
    try:
        message: list[Any] = [None] * head.read_array_header()
        message[:3] = [head.unpack() for _ in range(3)]
        count = head.read_array_header()
        message[3:] = [[head.unpack(), head.unpack(), *(None for _ in range(count - 2))]]
        call = call_of(message)
    except (*_UNPACKING_FAILED, ProtocolError):
        return None  # the decoder of whole messages says what is wrong
    return call if call.method in OF_PIXELS else None


Encoder = Callable[[Any], Any]


def encoder(annotation: Any) -> Encoder | None:  # noqa: ANN401 - an annotation may be any object
    """Return how values of a type are made ready for msgpack, None where they are as they lie."""
    origin, args = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return encoder(args[0])
    if origin in (Union, types.UnionType) and type(None) in args:
        inner = [each for each in args if each is not type(None)]
        if len(inner) != 1:
            raise TypeError(f"no way to write {annotation!r} to the wire is known")
        return _optional(encoder(inner[0]))
    if origin in (list, tuple):
        return _array(args)
    if isinstance(annotation, type) and hasattr(annotation, "_fields"):
        hints = get_type_hints(annotation, include_extras=True)
        return _fields([encoder(hints[name]) for name in annotation._fields])
    return None


def _optional(encode: Encoder | None) -> Encoder:
    def wrap(value: Any) -> tuple[Any, ...]:  # noqa: ANN401 - any value travels
        if value is None:
            return (False,)
        return (True, encode(value) if encode else value)

    return wrap


def _array(items: tuple[Any, ...]) -> Encoder | None:
    if len(items) > 1 and Ellipsis not in items:
        return _fields([encoder(item) for item in items])
    encode = encoder(items[0])
    return None if encode is None else lambda values: [encode(value) for value in values]


def _fields(encoders: list[Encoder | None]) -> Encoder | None:
    if not any(encoders):
        return None
    return lambda values: [encode(value) if encode else value for encode, value in zip(encoders, values, strict=True)]
