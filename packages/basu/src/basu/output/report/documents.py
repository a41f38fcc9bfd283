"""Documents of a run folder: their place, the check against a JSON Schema, and a run read back.

While a run lasts its folder is a draft, ``.<name>.part``; it gets its name when all is in it. So a folder with a
result is a whole one, however the benchmark ended.
"""

from __future__ import annotations

import functools
import json
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from basu.errors import UserError
from basu.files import PACKAGE_FOLDER, other_version, read_json, write_bytes
from basu.metrics.result import Result
from basu.output.report.streets import read_streets
from basu.records.history.files import HISTORY_FILE, read_history

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from datetime import datetime
    from pathlib import Path

    import jsonschema
    from jsonschema.protocols import Validator

    from basu.output.report.streets import Streets
    from basu.records.history import History


CONFIG_FILE, RESULT_FILE, TEXT_FILE, PICTURE_FILE = "config.json", "result.json", "result.txt", "path.png"
REPORT_FILE = "report.html"
LATEST = "latest"
DRAFTS = ".*.part"  # the names of drafts, for Path.glob


def run_name(started: datetime, agent: str, route: str) -> str:
    """Return what the folder of a run by itself is called."""
    return f"{started:%Y-%m-%dT%H-%M-%S}-{plain(agent)}-{plain(route)}"


def make_draft(output: Path, name: str) -> Path:
    """Return a new draft for the folder ``name`` in ``output``.

    Raises:
        UserError: it cannot be made.
    """
    number = 1
    while True:
        draft = output / f".{_numbered(name, number)}.part"
        try:
            draft.mkdir(parents=True)
        except FileExistsError:
            if not output.is_dir():
                raise UserError(f"{output} is not a folder; name another place with --output") from None
            number += 1
            continue
        except OSError as error:
            raise UserError(f"{draft} could not be made: {error.strerror}; name another place with --output") from error
        return draft


def publish(draft: Path, name: str, output: Path | None = None) -> Path:
    """Give a draft its name, or one with a number where that is taken; return the folder under its name.

    It is moved to ``output``; without that it stays where the draft is.

    Raises:
        UserError: it cannot be renamed.
    """
    number = 1
    while True:
        folder = (output or draft.parent) / _numbered(name, number)
        try:
            if not folder.exists():
                draft.rename(folder)
                return folder
        except OSError as error:
            if not folder.exists():
                raise UserError(f"{draft} could not be renamed to {folder.name}: {error.strerror}") from error
        number += 1


def point_latest(folder: Path, output: Path) -> None:
    """Let ``latest`` in ``output`` point to ``folder``, which lies somewhere below.

    Raises:
        UserError: the file system has no symbolic links, or the folder cannot be written.
    """
    draft, latest = output / f".{LATEST}.part", output / LATEST
    try:
        draft.unlink(missing_ok=True)
        draft.symlink_to(folder.relative_to(output), target_is_directory=True)
        draft.replace(latest)
    except OSError as error:
        raise UserError(f"{latest} could not be pointed to {folder.name}: {error.strerror}") from error


def write_json(path: Path, document: dict[str, Any]) -> None:
    """Write a document for people and programs alike."""
    write_bytes(path, (json.dumps(document, indent=2, allow_nan=False, ensure_ascii=False) + "\n").encode())


def plain(name: str) -> str:
    """Return a name that every file system takes."""
    return re.sub(r"[^A-Za-z0-9._-]+", "_", name).strip("._") or "_"


def _numbered(name: str, number: int) -> str:
    return name if number == 1 else f"{name}-{number}"


EARLIER_RESULTS = (1, 2)  # of runs with a record that can be judged again
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
    """Return the result of a run, checked.

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
    if isinstance(document, dict) and "verdict" in document and schema_name == RESULT_SCHEMA:
        raise UserError(
            f"{path} is of a case that an earlier version of basu played, without a score; play it again with `basu "
            f"scenario run --config {path.with_name(CONFIG_FILE)}`"
        )
    version, expected = _version(document), schema["properties"]["schema_version"]["const"]
    if version != expected:
        if schema_name == RESULT_SCHEMA and version in EARLIER_RESULTS:
            again = f"`basu score {path.parent} --write` judges its record by the rules of this version and replaces it"
            raise other_version(path, version, expected, again)
        raise other_version(path, version, expected)
    for mistake in mistakes(document, schema):
        raise UserError(f"{path}: {mistake}; the file was changed, or left by another version")
    return dict(document)


@functools.lru_cache
def read_schema(name: str) -> dict[str, Any]:
    """One of the packaged schemas."""
    schema: dict[str, Any] = json.loads((PACKAGE_FOLDER / "data" / name).read_text(encoding="utf-8"))
    return schema


def mistakes(document: object, schema: Mapping[str, Any]) -> Iterator[str]:
    """Yield what is wrong with a document, each place in a sentence; nothing where it is as the schema says."""
    import jsonschema  # noqa: PLC0415 - a tenth of a second, and a drive reads no document

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
    """Return what a value must be, in words."""
    allowed = error.validator_value
    if error.validator == "type":
        return " or ".join(AN.get(name, name) for name in ([allowed] if isinstance(allowed, str) else allowed))
    if error.validator == "enum":
        return f"one of {', '.join(map(str, allowed))}"
    if error.validator in {"minimum", "maximum"}:
        low, high = error.schema.get("minimum"), error.schema.get("maximum")
        return f"at least {low}" if high is None else f"at most {high}" if low is None else f"in {low}..{high}"
    return repr(allowed)


def _version(document: object) -> object:
    return document.get("schema_version") if isinstance(document, dict) else None


def _short(value: object) -> str:
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 60 else f"{text[:57]}..."


@dataclass(frozen=True, slots=True, kw_only=True)
class RunRecord:
    """All that a run left."""

    name: str  # of its folder
    config: dict[str, Any]  # config.json
    result: Result  # result.json
    history: History | None  # None where nothing was driven
    streets: Streets

    @property
    def agent(self) -> str:
        """The agent's name, as its author gave it."""
        return str(self.result.meta["agent"]["name"])


def read_run(folder: Path) -> RunRecord:
    """Read a run's folder.

    Raises:
        UserError: it is none, or one of its files is not what it should be.
    """
    if not folder.is_dir():
        raise UserError(f"{folder} is no folder; name a run's, such as runs/latest")
    document = read_result(folder)
    run = RunRecord(
        name=folder.resolve().name,
        config=_document(folder / CONFIG_FILE),
        result=Result.from_document(document),
        history=read_history(folder) if (folder / HISTORY_FILE).exists() else None,
        streets=read_streets(folder),
    )
    if run.history is not None:
        frames = range(len(run.history.frames))
        strange = next((tick for tick in _ticks(document) if tick not in frames), None)
        if strange is not None:
            raise UserError(
                f"{folder / RESULT_FILE} names frame {strange} and {HISTORY_FILE} ends at {frames[-1]}: "
                "these are files of different runs; drive the run again"
            )
    return run


def _ticks(document: object) -> Iterator[object]:
    """Yield every number of a frame in a result; a whole number that is written as 5.0 as a text."""
    if isinstance(document, dict):
        for name, value in document.items():
            if name == "tick":
                yield value if type(value) is int else repr(value)
            else:
                yield from _ticks(value)
    elif isinstance(document, list):
        for value in document:
            yield from _ticks(value)


def _document(path: Path) -> dict[str, Any]:
    """Return a JSON object in a file."""
    document = read_json(path, "the run's", "name a folder that `basu run` has left, or drive the run again")
    if not isinstance(document, dict):
        raise UserError(f"{path} holds no JSON object; the run has to be driven again")
    return document
