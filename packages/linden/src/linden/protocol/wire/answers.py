"""One call and the bytes of its answer: what a server and the gate share; no numpy, no compiled code.

A request is ``[0, id, method, [[is_async], *arguments]]``, an answer ``[1, id, error, result]``. The result of a
function with a value is ``[[1, value]]`` or ``[[0, [message]]]``. The result of a function without a value is
``[[false]]`` or ``[[true, [message]]]`` (LibCarla, ``carla/rpc/Response.h``).
"""

from enum import Enum
from typing import Any, NamedTuple

import msgpack

from linden.errors import ProtocolError
from linden.protocol.wire.decode import got

REQUEST, RESPONSE = 0, 1
_HEAD, _NO_ERROR = b"\x94\x01", b"\xc0"  # an array of four, RESPONSE; nil
_ONE_VALUE = b"\x91\x92\x01"  # ((1, value),) up to the value
_FIRST_BUFFER_BYTES = 4096  # what a buffer starts with; it grows
_pack = msgpack.Packer(unicode_errors="surrogateescape", buf_size=_FIRST_BUFFER_BYTES).pack


class Call(NamedTuple):
    """One remote call. Where ``is_async``, the client does not read the answer, yet keeps an entry until one comes."""

    id: int
    method: str
    args: list[Any]
    """As msgpack has them; the commands of a batch of plain controls are ``Controls`` (see ``packed``)."""
    is_async: bool


class Packed(bytes):
    """A result as msgpack's bytes, for results that come again and again."""


def packed_result(result: object) -> Packed:
    """Return a result as :func:`value` and :func:`bare` take it without packing it again."""
    return Packed(_pack(result))


class Reply(Enum):
    """How a function wraps its result."""

    VALUE = "value"
    VOID = "void"
    BARE = "bare"  # apply_batch: no wrapping, each member carries its own


def call_of(message: object) -> Call:
    """Return the call that a message is.

    Raises:
        ProtocolError: it is none.
    """
    if not isinstance(message, list) or len(message) != 4 or type(message[0]) is not int or message[0] != REQUEST:
        raise ProtocolError(f"expected a request [0, id, method, parameters], got {got(message)}")
    _, call_id, method, params = message
    if type(call_id) is not int or type(method) is not str or type(params) is not list:
        raise ProtocolError(f"expected a request [0, id, method, parameters], got id {got(call_id)}, {got(method)}")
    if not params or type(params[0]) is not list or len(params[0]) != 1 or type(params[0][0]) is not bool:
        raise ProtocolError(f"{got(method)}: expected [is_async] before the arguments, got {got(params[0:1])}")
    return Call(call_id, method, params[1:], params[0][0])


def value(call: Call, result: object) -> bytes:
    """Encode the result of a function that has one."""
    if type(result) is Packed:
        return b"".join((_HEAD, _pack(call.id), _NO_ERROR, _ONE_VALUE, result))
    answer: bytes = _pack((RESPONSE, call.id, None, ((1, result),)))
    return answer


def void(call: Call) -> bytes:
    """Encode that a function without a result has done its work."""
    answer: bytes = _pack((RESPONSE, call.id, None, ((False,),)))
    return answer


def bare(call: Call, result: object) -> bytes:
    """Encode a result that carries its own wrapping: the answers to a batch."""
    if type(result) is Packed:
        return b"".join((_HEAD, _pack(call.id), _NO_ERROR, result))
    answer: bytes = _pack((RESPONSE, call.id, None, result))
    return answer


def refusal(call: Call, message: str, reply: Reply) -> bytes:
    """Encode an error; the client raises RuntimeError with ``message`` word for word.

    A batch has no place for an error of its own, so the rpc library's is used, which names the function only.
    """
    if reply is Reply.BARE:
        return unknown(call, message)
    failed: bool | int = True if reply is Reply.VOID else 0
    answer: bytes = _pack((RESPONSE, call.id, None, ((failed, (message,)),)))
    return answer


def unknown(call: Call, message: str) -> bytes:
    """Encode that there is no such function; the client raises ``rpc::rpc_error during call in function <name>``."""
    answer: bytes = _pack((RESPONSE, call.id, message, None))
    return answer
