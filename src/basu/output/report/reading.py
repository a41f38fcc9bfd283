"""A run's folder read back: what a report, a comparison and an experiment are made from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from basu.errors import UserError
from basu.metrics.result import Result
from basu.output.report.folder import CONFIG_FILE
from basu.output.report.schema import read_result
from basu.output.report.streets import read_streets
from basu.records.history.files import HISTORY_FILE, read_history
from basu.utils.json_file import read_json

if TYPE_CHECKING:
    from pathlib import Path

    from basu.output.report.streets import Line
    from basu.records.history import History


@dataclass(frozen=True, slots=True, kw_only=True)
class RunRecord:
    """All that a run left."""

    name: str  # of its folder
    config: dict[str, Any]  # config.json
    result: Result  # result.json
    history: History | None  # None where nothing was driven
    streets: list[Line]

    @property
    def agent(self) -> str:
        """Who drove, as its author called it."""
        return str(self.result.meta["agent"]["name"])


def read_run(folder: Path) -> RunRecord:
    """Read a run's folder.

    Raises:
        UserError: it is none, or one of its files is not what it should be.
    """
    if not folder.is_dir():
        raise UserError(f"{folder} is no folder; name a run's, such as runs/latest")
    return RunRecord(
        name=folder.resolve().name,
        config=_document(folder / CONFIG_FILE),
        result=Result.from_document(read_result(folder)),
        history=read_history(folder) if (folder / HISTORY_FILE).exists() else None,
        streets=read_streets(folder),
    )


def _document(path: Path) -> dict[str, Any]:
    """A JSON object in a file."""
    document = read_json(path, "the run's", "name a folder that `basu run` has left, or drive the run again")
    if not isinstance(document, dict):
        raise UserError(f"{path} holds no JSON object; the run has to be driven again")
    return document
