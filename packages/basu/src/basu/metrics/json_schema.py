"""JSON Schemas (draft 2020-12): parts from which each metric describes its value, and schemas of annotated types.

Units stand in descriptions.
"""

from __future__ import annotations

import enum
import types
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    Literal,
    NamedTuple,
    TypeVar,
    Union,
    get_args,
    get_origin,
)

from typing_extensions import NotRequired, get_type_hints, is_typeddict

from basu.units import parted

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping, Sequence

Schema = dict[str, Any]

EVIDENCE: Schema = {"$ref": "#/$defs/evidence"}


def number(
    unit: str = "", *, low: float | None = None, high: float | None = None, null: bool = False, about: str = ""
) -> Schema:
    """Return the schema of a number in ``unit``."""
    limits = {key: limit for key, limit in (("minimum", low), ("maximum", high)) if limit is not None}
    return {"type": _type("number", null=null), **limits, **_about(", ".join(filter(None, (unit, about))))}


def integer(*, low: int | None = None, null: bool = False, about: str = "") -> Schema:
    """Return the schema of a whole number."""
    limits = {} if low is None else {"minimum": low}
    return {"type": _type("integer", null=null), **limits, **_about(about)}


def text(*, null: bool = False, about: str = "") -> Schema:
    """Return the schema of a text."""
    return {"type": _type("string", null=null), **_about(about)}


def flag(*, null: bool = False, about: str = "") -> Schema:
    """Return the schema of a truth value."""
    return {"type": _type("boolean", null=null), **_about(about)}


def choice(values: Sequence[str | None], about: str = "") -> Schema:
    """Return the schema of a text that is one of ``values``."""
    return {"enum": list(values), **_about(about)}


def listing(items: Schema, about: str = "") -> Schema:
    """Return the schema of a list of ``items``."""
    return {"type": "array", **_about(about), "items": items}


def mapping(values: Schema, *, null: bool = False, about: str = "") -> Schema:
    """Return the schema of an object with any keys."""
    return {"type": _type("object", null=null), **_about(about), "additionalProperties": values}


def record(*, null_: bool = False, about_: str = "", **properties: Schema) -> Schema:
    """Return the schema of an object with exactly these keys."""
    return {
        "type": _type("object", null=null_),
        **_about(about_),
        "required": list(properties),
        "additionalProperties": False,
        "properties": properties,
    }


def record_of(
    kind: type, more: Mapping[str, Schema] | None = None, *, signed: Collection[str] = (), about: str = ""
) -> Schema:
    """Return the schema of a named tuple, with the units at the ends of its names; ``more`` replaces and adds keys.

    Numbers are 0 or more but for those in ``signed``, and a name that ends with ``_share`` has 1 as its highest value.
    """
    hints = get_type_hints(kind).items()
    found: dict[str, Any] = {name: _member(name, each, is_signed=name in signed) for name, each in hints}
    return record(about_=about, **{**found, **(more or {})})


def _member(name: str, kind: Any, *, is_signed: bool) -> Schema:  # noqa: ANN401 - an annotation
    """Return the schema of one value of a named tuple."""
    if get_origin(kind) is tuple:
        return listing(_member("", get_args(kind)[0], is_signed=False))
    kinds = set(get_args(kind)) or {kind}
    low, null = None if is_signed else 0, types.NoneType in kinds
    if float in kinds:
        return number(parted(name)[1], low=low, high=1 if name.endswith("_share") else None, null=null)
    if bool in kinds or str in kinds:
        return flag(null=null) if bool in kinds else text(null=null)
    return integer(low=low, null=null) if int in kinds else schema_of(kind)


def _type(name: str, *, null: bool) -> str | list[str]:
    return [name, "null"] if null else name


def _about(text: str) -> Schema:
    return {"description": text} if text else {}


class Value(NamedTuple):
    """What an annotation says about a value: its meaning and, of a number, its bounds."""

    about: str = ""
    low: float | None = None
    high: float | None = None


T = TypeVar("T", bound=type)
_closed: set[type] = set()


def closed(kind: T) -> T:
    """Let a typed dict have no other keys; for use as a decorator."""
    _closed.add(kind)
    return kind


PLAIN: dict[Any, Schema] = {
    float: {"type": "number"},
    int: {"type": "integer"},
    str: {"type": "string"},
    bool: {"type": "boolean"},
    Any: {},
    types.NoneType: {"type": "null"},
}


def schema_of(kind: Any) -> Schema:  # noqa: ANN401 - an annotation
    """Return the schema of an annotation: of a typed dict, list, mapping, enum, literal, union or plain type."""
    origin = get_origin(kind)
    if origin is not None:
        return _FORMS[origin](*get_args(kind))
    if is_typeddict(kind):
        return _object(kind)
    if isinstance(kind, type) and issubclass(kind, enum.Enum):
        return choice([each.value for each in kind])
    return dict(PLAIN[kind])


def _mapping(_: Any, values: Any) -> Schema:  # noqa: ANN401 - annotations
    """Return the schema of an object with any keys."""
    inner = schema_of(values)
    return {"type": "object", **({"additionalProperties": inner} if inner else {})}


def _annotated(kind: Any, *said: str | Value) -> Schema:  # noqa: ANN401 - an annotation
    """Return the schema of an annotated type with its meaning and bounds; what is said last comes first."""
    found = schema_of(kind)
    for each in said:
        value = Value(each) if isinstance(each, str) else each
        bounds = {"minimum": value.low, "maximum": value.high}
        found |= {key: bound for key, bound in bounds.items() if bound is not None} | _about(value.about)
    return found


def _union(*kinds: Any) -> Schema:  # noqa: ANN401 - annotations
    """Return the schema of a union: of plain types, or of a type and null."""
    parts = [schema_of(each) for each in kinds]
    names = [name for part in parts if "type" in part for name in [part["type"]]]
    merged: Schema = {key: value for part in parts for key, value in part.items() if key != "type"}
    if "enum" in merged:
        return {"enum": [*merged["enum"], None]}
    return {"type": names, **merged}


def _object(kind: Any) -> Schema:  # noqa: ANN401 - a typed dict
    """Return the schema of a typed dict."""
    hints = get_type_hints(kind, include_extras=True)
    late: Any = NotRequired
    needed = [name for name, each in hints.items() if get_origin(each) is not late]
    inner = {name: each if name in needed else get_args(each)[0] for name, each in hints.items()}
    extra = {"additionalProperties": False} if kind in _closed else {}
    properties = {name: schema_of(each) for name, each in inner.items()}
    return {"type": "object", "required": needed, **extra, "properties": properties}


_FORMS: dict[Any, Callable[..., Schema]] = {
    Annotated: _annotated,
    Union: _union,
    types.UnionType: _union,
    Literal: lambda *values: choice(values),
    list: lambda items: listing(schema_of(items)),
    dict: _mapping,
}
