"""Parts of a JSON Schema (draft 2020-12), from which each metric describes its value; units stand in descriptions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

Schema = dict[str, Any]

EVIDENCE: Schema = {"$ref": "#/$defs/evidence"}


def number(
    unit: str = "", *, low: float | None = None, high: float | None = None, null: bool = False, about: str = ""
) -> Schema:
    """A number in ``unit``."""
    limits = {key: limit for key, limit in (("minimum", low), ("maximum", high)) if limit is not None}
    return {"type": _type("number", null=null), **limits, **_about(", ".join(filter(None, (unit, about))))}


def integer(*, low: int | None = None, null: bool = False, about: str = "") -> Schema:
    """A whole number."""
    limits = {} if low is None else {"minimum": low}
    return {"type": _type("integer", null=null), **limits, **_about(about)}


def text(*, null: bool = False, about: str = "") -> Schema:
    """A text."""
    return {"type": _type("string", null=null), **_about(about)}


def flag(*, null: bool = False, about: str = "") -> Schema:
    """True or false."""
    return {"type": _type("boolean", null=null), **_about(about)}


def choice(values: Sequence[str | None], about: str = "") -> Schema:
    """One of ``values``."""
    return {"enum": list(values), **_about(about)}


def listing(items: Schema, about: str = "") -> Schema:
    """A list of ``items``."""
    return {"type": "array", **_about(about), "items": items}


def mapping(values: Schema, *, null: bool = False, about: str = "") -> Schema:
    """An object with any keys."""
    return {"type": _type("object", null=null), **_about(about), "additionalProperties": values}


def record(*, null_: bool = False, about_: str = "", **properties: Schema) -> Schema:
    """An object with exactly these keys."""
    return {
        "type": _type("object", null=null_),
        **_about(about_),
        "required": list(properties),
        "additionalProperties": False,
        "properties": properties,
    }


def _type(name: str, *, null: bool) -> str | list[str]:
    return [name, "null"] if null else name


def _about(text: str) -> Schema:
    return {"description": text} if text else {}
