"""From msgpack's lists to typed values: one decoder per annotation, built once, with a sentence where it does not fit.

How an annotation travels (reference: LibCarla's msgpack adaptors, 0.9.16): a named tuple is an array of its fields, of
which trailing ones may be left out where they have defaults; ``X | None`` is ``[false]`` or ``[true, x]``; a union of
other types is CARLA's variant ``[index, x]``; ``tuple[X, ...]`` an array; an enum its number. A bool is never a number,
nor a number a bool. A number that no 32-bit float can hold is refused: no field of the protocol means anything by one,
and what the server holds is sent back in 32 bits.
"""

import math
import types
from collections.abc import Callable, Sequence
from enum import IntEnum
from typing import Annotated, Any, NamedTuple, Union, get_args, get_origin, get_type_hints

from linden.errors import Refusal

Decoder = Callable[[Any], Any]


class IntRange(NamedTuple):
    """The numbers an integer may have, both ends included; stands in ``Annotated[int, IntRange(...)]``."""

    low: int
    high: int


U8 = Annotated[int, IntRange(0, 2**8 - 1)]
U16 = Annotated[int, IntRange(0, 2**16 - 1)]
U32 = Annotated[int, IntRange(0, 2**32 - 1)]
U64 = Annotated[int, IntRange(0, 2**64 - 1)]
I32 = Annotated[int, IntRange(-(2**31), 2**31 - 1)]

ANY_32_BITS = IntRange(-(2**31), 2**32 - 1)
"""What a plain ``int`` may hold: the protocol has no wider integers outside object ids, which say :data:`U64`."""

LARGEST_NUMBER = (2.0 - 2.0**-23) * 2.0**127  # of single precision, IEEE 754
"""Beyond it a number would be infinite in the snapshot."""

_SHOWN = 40  # characters of a wrong value that an error quotes


class DecodedBy(NamedTuple):
    """Stands in ``Annotated[T, DecodedBy(function)]`` where a type has a decoder of its own."""

    decode: Decoder


class WireTypeError(Refusal):
    """A value has not the type its place asks for; ``path`` leads to it from the argument."""

    def __init__(self, problem: str, path: str = "") -> None:
        super().__init__(f"{path}: {problem}" if path else problem)
        self.problem = problem
        self.path = path

    def inside(self, step: str) -> "WireTypeError":
        """Return the same error as seen from one level further out."""
        return WireTypeError(self.problem, step + self.path)


def got(value: object) -> str:
    """Name what arrived, for the end of a sentence."""
    if value is None:
        return "nil"
    if isinstance(value, (list, tuple)):
        return f"an array of {len(value)}"
    # of a text of megabytes only the beginning is written out
    shown = repr(value[: _SHOWN + 1] if isinstance(value, (str, bytes)) else value)
    return f"{type(value).__name__} {shown if len(shown) <= _SHOWN else shown[:_SHOWN] + '…'}"


def decode_float(value: object) -> float:
    """Return a number that 32 bits can hold; integers are numbers, bools are not."""
    if type(value) is not float and type(value) is not int:
        raise WireTypeError(f"expected a number, got {got(value)}")
    if abs(value) <= LARGEST_NUMBER:
        return float(value)
    raise WireTypeError(f"expected a finite number of 32 bits, got {value}")


def decode_bool(value: object) -> bool:
    """Return a bool; 0 and 1 are none."""
    if value is True or value is False:
        return value
    raise WireTypeError(f"expected true or false, got {got(value)}")


def decode_str(value: object) -> str:
    """Return a text."""
    if type(value) is str:
        return value
    raise WireTypeError(f"expected a text, got {got(value)}")


def decode_bytes(value: object) -> bytes:
    """Return raw bytes (msgpack's bin)."""
    if type(value) is bytes:
        return value
    raise WireTypeError(f"expected raw bytes, got {got(value)}")


def decoder(annotation: Any) -> Decoder:  # noqa: ANN401 - an annotation may be any object
    """Return the decoder of a type.

    Raises:
        TypeError: nothing is known about how ``annotation`` travels: a mistake of ours, found at start.
    """
    simple: dict[Any, Decoder] = {
        float: decode_float,
        bool: decode_bool,
        str: decode_str,
        bytes: decode_bytes,
        int: _integer(ANY_32_BITS),
    }
    if annotation in simple:
        return simple[annotation]
    if get_origin(annotation) is Annotated:
        return _annotated(*get_args(annotation))
    if get_origin(annotation) in (tuple, list):
        return _array(get_origin(annotation), get_args(annotation))
    if get_origin(annotation) in (Union, types.UnionType):
        return _union(get_args(annotation))
    if isinstance(annotation, type) and issubclass(annotation, IntEnum):
        return _enum(annotation)
    if isinstance(annotation, type) and hasattr(annotation, "_fields"):
        return struct_decoder(annotation)
    raise TypeError(f"no way to read {annotation!r} from the wire is known")


def _annotated(base: Any, *marks: object) -> Decoder:  # noqa: ANN401 - see decoder
    for mark in marks:
        if isinstance(mark, IntRange):
            return _integer(mark)
        if isinstance(mark, DecodedBy):
            return mark.decode
    return decoder(base)


def _integer(limits: IntRange) -> Decoder:
    low, high = limits

    def decode(value: object) -> int:
        if type(value) is not int:
            raise WireTypeError(f"expected an integer, got {got(value)}")
        if not low <= value <= high:
            raise WireTypeError(f"expected an integer from {low} to {high}, got {value}")
        return value

    return decode


def _enum(enum: type[IntEnum]) -> Decoder:
    members = {int(member): member for member in enum}
    choice = ", ".join(f"{member.value} ({member.name})" for member in enum)

    def decode(value: object) -> IntEnum:
        if type(value) is int and value in members:
            return members[value]
        raise WireTypeError(f"expected one of {choice}, got {got(value)}")

    return decode


def _array(kind: type, items: tuple[Any, ...]) -> Decoder:
    """An array of any length for ``list[X]`` and ``tuple[X, ...]``; of fixed length for ``tuple[X, Y]``."""
    if kind is tuple and Ellipsis not in items:
        return _fixed_array(tuple(decoder(item) for item in items))
    decode_item = decoder(items[0])

    def decode(value: object) -> Sequence[Any]:
        if type(value) is not list:
            raise WireTypeError(f"expected an array, got {got(value)}")
        try:
            return kind([decode_item(item) for item in value])  # type: ignore[no-any-return]
        except WireTypeError:
            _locate(value, [(f"[{i}]", decode_item) for i in range(len(value))])
            raise

    return decode


def _fixed_array(decoders: tuple[Decoder, ...]) -> Decoder:
    def decode(value: object) -> tuple[Any, ...]:
        if type(value) is not list or len(value) != len(decoders):
            raise WireTypeError(f"expected an array of {len(decoders)}, got {got(value)}")
        try:
            return tuple([decode_item(item) for decode_item, item in zip(decoders, value, strict=True)])
        except WireTypeError:
            _locate(value, [(f"[{i}]", each) for i, each in enumerate(decoders)])
            raise

    return decode


def _union(members: tuple[Any, ...]) -> Decoder:
    if type(None) in members:
        inner = [member for member in members if member is not type(None)]
        return _optional(decoder(inner[0]) if len(inner) == 1 else _variant(tuple(inner)))
    return _variant(members)


def _optional(decode_item: Decoder) -> Decoder:
    def decode(value: object) -> Any:  # noqa: ANN401 - what decode_item returns
        if type(value) is list and value:
            if value[0] is False and len(value) == 1:
                return None
            if value[0] is True and len(value) == 2:
                return decode_item(value[1])
        raise WireTypeError(f"expected [false] or [true, value], got {got(value)}")

    return decode


def _variant(members: tuple[Any, ...]) -> Decoder:
    decoders = [decoder(member) for member in members]

    def decode(value: object) -> Any:  # noqa: ANN401 - one of the members
        if type(value) is not list or len(value) != 2:
            raise WireTypeError(f"expected [index, value], got {got(value)}")
        index = value[0]
        if type(index) is not int or not 0 <= index < len(decoders):
            raise WireTypeError(f"expected an index from 0 to {len(decoders) - 1}, got {got(index)}")
        return decoders[index](value[1])

    return decode


def struct_decoder(struct: type) -> Decoder:
    """Return the decoder of a named tuple."""
    hints = get_type_hints(struct, include_extras=True)
    names: tuple[str, ...] = struct._fields  # type: ignore[attr-defined]
    required = len(names) - len(struct._field_defaults)  # type: ignore[attr-defined]
    decoders = [decoder(hints[name]) for name in names]
    make: Callable[[Any], Any] = struct._make  # type: ignore[attr-defined]

    def decode(value: object) -> Any:  # noqa: ANN401 - a ``struct``
        if type(value) is not list or not required <= len(value) <= len(names):
            raise WireTypeError(f"expected {struct.__name__}, an array of {len(names)}, got {got(value)}")
        try:
            fields = [decode_field(field) for decode_field, field in zip(decoders, value, strict=False)]
        except WireTypeError:
            _locate(value, [(f".{name}", each) for name, each in zip(names, decoders, strict=True)])
            raise
        return make(fields) if len(fields) == len(names) else struct(*fields)

    plain_types = tuple(hints[name] for name in names)
    return _fast(decode, make, plain_types) if set(plain_types) <= {float, bool, int} else decode


def _fast(decode: Decoder, make: Callable[[Any], Any], plain_types: tuple[type, ...]) -> Decoder:
    """Put a short way before the decoder of a struct of plain numbers: a control comes 250 times a tick.

    Where every field has the very type it is sent with and its integers fit, what is left to check is that no number is
    too large, and none is larger than the root of the sum of their squares, which is NaN where one of them is. Whatever
    else is unusual takes the long way.
    """
    low, high = ANY_32_BITS
    integers = [i for i, each in enumerate(plain_types) if each is int]

    def decode_fast(value: Any) -> Any:  # noqa: ANN401 - as ``decode``
        if type(value) is list and tuple(map(type, value)) == plain_types and math.hypot(*value) <= LARGEST_NUMBER:
            for i in integers:
                if not low <= value[i] <= high:
                    return decode(value)
            return make(value)
        return decode(value)

    return decode_fast


def _locate(values: list[Any], steps: Sequence[tuple[str, Decoder]]) -> None:
    """Raise the first error among ``values`` with the step that leads to it; costs a second pass, on errors only."""
    for value, (step, decode_value) in zip(values, steps, strict=False):
        try:
            decode_value(value)
        except WireTypeError as error:  # noqa: PERF203 - once, on the way to an error
            raise error.inside(step) from None
