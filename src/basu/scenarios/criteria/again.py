"""A case from its folder: what its criteria saw and what they said, so that any criterion can be asked of it again."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from basu.errors import UserError
from basu.outcome import Outcome, Status
from basu.records.history.files import read_history
from basu.scenarios.criteria.criterion import Judgement, Played, Thing

if TYPE_CHECKING:
    from pathlib import Path

RESULT_FILE = "result.json"


def played_in(folder: Path) -> Played:
    """What criteria saw of the case in this folder; ``Pet().judge(played_in(folder))`` asks one of it.

    Raises:
        UserError: there is no case that was driven.
    """
    document = _document(folder)
    try:
        return Played(
            history=read_history(folder),
            outcome=Outcome(Status(document["status"]), document["ended"]),
            roles={actor["id"]: actor["role"] for actor in document["actors"]},
            things=tuple(Thing(**thing) for thing in document["things"]),
            phases_s=document["phases_s"],
            timeout_s=document["timeout_s"],
        )
    except (KeyError, TypeError, ValueError) as error:
        raise UserError(f"{folder} holds no case of a scenario that this version can read: {error}") from error


def judgements_in(folder: Path) -> tuple[Judgement, ...]:
    """What was said of the case in this folder.

    Raises:
        UserError: there is no case.
    """
    document = _document(folder)
    try:
        return tuple(Judgement(**judgement) for judgement in document["judgements"])
    except (KeyError, TypeError) as error:
        raise UserError(f"{folder} holds no case of a scenario that this version can read: {error}") from error


def _document(folder: Path) -> dict[str, Any]:
    """The result of a case."""
    try:
        document: dict[str, Any] = json.loads((folder / RESULT_FILE).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise UserError(f"{folder} holds no result that can be read: {error}") from error
    return document
