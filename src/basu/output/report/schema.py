"""Documents held against their JSON Schema: ``data/*.schema.json``, draft 2020-12, by the ``jsonschema`` library."""

from __future__ import annotations

import functools
import json
from typing import TYPE_CHECKING, Any

import jsonschema

from basu.errors import UserError
from basu.output.report.folder import RESULT_FILE
from basu.utils.json_file import read_json
from basu.utils.packaged import PACKAGE_FOLDER

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from jsonschema.protocols import Validator

RESULT_SCHEMA, SERIES_SCHEMA = "result.schema.json", "series.schema.json"
AN = {
    "object": "an object",
    "array": "a list",
    "string": "a text",
    "number": "a number",
    "integer": "a whole number",
    "boolean": "true or false",
}


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
    validator: Validator = jsonschema.Draft202012Validator(schema)
    for error in sorted(validator.iter_errors(document), key=lambda error: [str(part) for part in error.absolute_path]):
        yield _sentence(error)


def _sentence(error: jsonschema.ValidationError) -> str:
    """One mistake: the place, what stands there, and what it must be."""
    where = error.json_path.removeprefix("$").removeprefix(".")
    if error.validator == "required":
        missing = next(name for name in error.validator_value if name not in error.instance)
        return f"{where or 'the document'} lacks '{missing}'"
    if error.validator == "additionalProperties":
        unknown = next(str(name) for name in error.instance if name not in error.schema.get("properties", {}))
        return f"{f'{where}.' if where else ''}{unknown} means nothing here"
    return f"{where or 'the document'} is {_short(error.instance)}; it must be {_asked(error)}"


def _asked(error: jsonschema.ValidationError) -> str:
    """What a value must be, in words."""
    asked = error.validator_value
    if error.validator == "type":
        return " or ".join(AN.get(name, name) for name in ([asked] if isinstance(asked, str) else asked))
    if error.validator == "enum":
        return f"one of {', '.join(map(str, asked))}"
    if error.validator in {"minimum", "maximum"}:
        low, high = error.schema.get("minimum"), error.schema.get("maximum")
        return f"at least {low}" if high is None else f"at most {high}" if low is None else f"in {low}..{high}"
    return repr(asked)


def _version(document: object) -> object:
    return document.get("schema_version") if isinstance(document, dict) else None


def _short(value: object) -> str:
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 60 else f"{text[:57]}..."
