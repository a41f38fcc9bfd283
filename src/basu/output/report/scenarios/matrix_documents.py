"""The documents of a scenario run read back and checked: its matrix, and each case's result, record and streets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from basu.errors import UserError
from basu.files import read_json
from basu.output.report.documents import RESULT_FILE, read_document
from basu.output.report.streets import read_streets
from basu.records.history.files import HISTORY_FILE, read_history

if TYPE_CHECKING:
    from pathlib import Path

    from basu.output.report.streets import Line
    from basu.records.history import History


MATRIX_FILE = "matrix.json"
FIRST_VERSION = 1
CASE_SCHEMA, MATRIX_SCHEMA = "scenario.schema.json", "matrix.schema.json"


@dataclass(frozen=True, slots=True, kw_only=True)
class CaseRecord:
    """All that one case with one agent left."""

    result: dict[str, Any]
    history: History | None  # None where nothing was driven
    streets: list[Line]


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
    return CaseRecord(
        result=_read(folder / RESULT_FILE, CASE_SCHEMA),
        history=read_history(folder) if (folder / HISTORY_FILE).exists() else None,
        streets=read_streets(folder),
    )


def _read(path: Path, schema: str) -> dict[str, Any]:
    """Return a document, checked; the first version has no verdict by the policy and cannot be shown.

    Raises:
        UserError: it is none, or not what it should be.
    """
    document = read_json(path, "the document", "name a folder that `basu scenario run` has left")
    if isinstance(document, dict) and document.get("schema_version") == FIRST_VERSION:
        raise UserError(
            f"{path} was written before scenarios were judged on safe, completed and exercised; play its cases again "
            "with `basu scenario run`"
        )
    return read_document(path, schema)
