"""From typed values to what msgpack packs. Nearly everything packs as it lies; only an optional is wrapped.

An encoder is built once from the annotation of a result. None means that values of that type need no encoding.
"""

import types
from collections.abc import Callable
from typing import Annotated, Any, Union, get_args, get_origin, get_type_hints

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
