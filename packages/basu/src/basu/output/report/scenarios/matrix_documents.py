"""The documents of a scenario run read back and checked: its matrix, and each case's result, record and streets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from basu.errors import UserError
from basu.files import read_json
from basu.metrics.result import Result
from basu.output.report.documents import (
    RESULT_FILE,
    RESULT_SCHEMA,
    mistakes,
    read_document,
    read_result,
    read_schema,
)
from basu.output.report.streets import read_streets
from basu.records.history.files import HISTORY_FILE, read_history

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from basu.output.report.streets import Streets
    from basu.records.history import History


MATRIX_FILE = "matrix.json"
FIRST_VERSION = 1
EARLIER_VERSIONS = frozenset({FIRST_VERSION, 2})  # of a case's document of its own
MATRIX_SCHEMA = "matrix.schema.json"


@dataclass(frozen=True, slots=True, kw_only=True)
class CaseRecord:
    """All that one case with one agent left."""

    case: Mapping[str, Any]  # of its result
    result: Result | None  # None for a case that an earlier version wrote
    history: History | None  # None where nothing was driven
    streets: Streets


def read_matrix(folder: Path) -> dict[str, Any]:
    """Return the matrix of a run's folder.

    Raises:
        UserError: there is none, or it is not what it should be.
    """
    return _read(folder / MATRIX_FILE, MATRIX_SCHEMA)


def read_case(folder: Path) -> CaseRecord:
    """Return what lies in the folder of a case.

    Raises:
        UserError: it is none, or one of its files is not what it should be.
    """
    path = folder / RESULT_FILE
    document = read_json(path, "the document", "name a folder that `basu scenario run` has left")
    if isinstance(document, dict) and document.get("schema_version") in EARLIER_VERSIONS:
        case, result = _earlier_case(path, document), None
    else:
        document = read_result(folder)
        if document.get("case") is None:
            raise UserError(f"{folder} is a run's folder and no case's; `basu report {folder}` shows it")
        case, result = document["case"], Result.from_document(document)
    return CaseRecord(
        case=case,
        result=result,
        history=read_history(folder) if (folder / HISTORY_FILE).exists() else None,
        streets=read_streets(folder),
    )


def _earlier_case(path: Path, document: dict[str, Any]) -> dict[str, Any]:
    """Return the case of a document that was written before cases had a run's result.

    Raises:
        UserError: it is of the first version, or not what it should be.
    """
    if document["schema_version"] == FIRST_VERSION:
        raise UserError(_too_old(path))
    whole = read_schema(RESULT_SCHEMA)
    for mistake in mistakes(document, {**whole["$defs"]["case"], "$defs": whole["$defs"]}):
        raise UserError(f"{path}: {mistake}; the file was changed, or left by another version")
    return document


def _too_old(path: Path) -> str:
    return (
        f"{path} was written before scenarios were judged on safe, completed and exercised; play its cases again "
        "with `basu scenario run`"
    )


def _read(path: Path, schema: str) -> dict[str, Any]:
    """Return a document, checked; the first version has no verdict by the policy and cannot be shown.

    Raises:
        UserError: it is none, or not what it should be.
    """
    document = read_json(path, "the document", "name a folder that `basu scenario run` has left")
    if isinstance(document, dict) and document.get("schema_version") == FIRST_VERSION:
        raise UserError(_too_old(path))
    return read_document(path, schema)
