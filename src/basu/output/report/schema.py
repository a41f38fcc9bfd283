"""Documents held against their JSON Schema: ``data/*.schema.json``, draft 2020-12, of which a part is used here.

The part: ``type``, ``const``, ``enum``, ``minimum``, ``maximum``, ``required``, ``properties``, ``items``,
``additionalProperties``, ``$ref`` into ``$defs``. Tests hold this reading of it against the ``jsonschema`` library's.
"""

from __future__ import annotations

import functools
import json
import math
from typing import TYPE_CHECKING, Any

from basu.errors import UserError
from basu.output.report.folder import RESULT_FILE
from basu.utils.json_file import read_json
from basu.utils.packaged import PACKAGE_FOLDER

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

RESULT_SCHEMA, SERIES_SCHEMA = "result.schema.json", "series.schema.json"
TYPES: dict[str, tuple[type, ...]] = {
    "object": (dict,),
    "array": (list,),
    "string": (str,),
    "number": (int, float),
    "integer": (int,),
    "boolean": (bool,),
    "null": (type(None),),
}
AN = {"object": "an object", "array": "a list", "string": "a text", "number": "a number", "integer": "a whole number"}


def read_result(folder: Path) -> dict[str, Any]:
    """The result of a run, checked.

    Raises:
        UserError: there is none, or it is not what a result should be.
    """
    return read_document(folder / RESULT_FILE, RESULT_SCHEMA)


def read_document(path: Path, schema_name: str) -> dict[str, Any]:
    """A JSON document, checked.

    Raises:
        UserError: it cannot be read, or is not as its schema says: which place, and what it should be.
    """
    document = read_json(path, "the document", "name a folder that `basu run` has left, or drive the run again")
    schema = read_schema(schema_name)
    version, expected = _version(document), schema["properties"]["schema_version"]["const"]
    if version != expected:
        raise UserError(f"{path} has the schema version {version!r}, and this version of basu reads {expected}")
    for mistake in mistakes(document, schema):
        raise UserError(f"{path}: {mistake}; the file was changed, or left by another version")
    return dict(document)


@functools.lru_cache
def read_schema(name: str) -> dict[str, Any]:
    """One of the packaged schemas."""
    schema: dict[str, Any] = json.loads((PACKAGE_FOLDER / "data" / name).read_text(encoding="utf-8"))
    return schema


def mistakes(document: object, schema: Mapping[str, Any]) -> Iterator[str]:
    """What is wrong with a document, each place in a sentence; nothing where it is as the schema says."""
    yield from _mistakes(document, schema, schema, "")


def _version(document: object) -> object:
    return document.get("schema_version") if isinstance(document, dict) else None


def _mistakes(value: object, schema: Mapping[str, Any], root: Mapping[str, Any], where: str) -> Iterator[str]:
    """What is wrong at one place and below it."""
    if "$ref" in schema:
        schema = root["$defs"][schema["$ref"].removeprefix("#/$defs/")]
    place = where or "the document"
    types = schema.get("type", ())
    types = [types] if isinstance(types, str) else list(types)
    if types and not any(_is(value, name) for name in types):
        yield f"{place} is {_short(value)}; it must be {' or '.join(AN.get(name, name) for name in types)}"
    elif "const" in schema and not _equal(value, schema["const"]):
        yield f"{place} is {_short(value)}; it must be {schema['const']!r}"
    elif "enum" in schema and value not in schema["enum"]:
        yield f"{place} is {_short(value)}; it must be one of {', '.join(map(str, schema['enum']))}"
    elif isinstance(value, dict):
        yield from _in_object(value, schema, root, where)
    elif isinstance(value, list):
        for number, entry in enumerate(value):
            yield from _mistakes(entry, schema.get("items", {}), root, f"{where}[{number}]")
    elif isinstance(value, int | float) and not isinstance(value, bool):
        low, high = schema.get("minimum", -math.inf), schema.get("maximum", math.inf)
        if not low <= value <= high:
            yield f"{place} is {value}; it must be {f'at least {low}' if high == math.inf else f'in {low}..{high}'}"


def _in_object(
    value: Mapping[str, Any], schema: Mapping[str, Any], root: Mapping[str, Any], where: str
) -> Iterator[str]:
    """What is wrong with the entries of an object."""
    known, others = schema.get("properties", {}), schema.get("additionalProperties", True)
    for name in schema.get("required", ()):
        if name not in value:
            yield f"{where or 'the document'} lacks '{name}'"
    for name, entry in value.items():
        path = f"{where}.{name}" if where else name
        if name in known:
            yield from _mistakes(entry, known[name], root, path)
        elif others is False:
            yield f"{path} means nothing here"
        elif isinstance(others, dict):
            yield from _mistakes(entry, others, root, path)


def _is(value: object, name: str) -> bool:
    """Whether a value is of one of JSON Schema's types: a truth value is no number, 2.0 is a whole one."""
    if isinstance(value, bool):
        return name == "boolean"
    if name == "integer" and isinstance(value, float):
        return value.is_integer()
    return isinstance(value, TYPES[name])


def _short(value: object) -> str:
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _equal(value: object, wanted: object) -> bool:
    """As JSON means it: true is not 1."""
    return value == wanted and isinstance(value, bool) == isinstance(wanted, bool)
