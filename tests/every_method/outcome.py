"""What came of calling one member of the official client, as docs/supported.json keeps it."""

import json
from enum import Enum
from pathlib import Path
from typing import Any, NamedTuple

RECORD = Path(__file__).parents[2] / "docs" / "supported.json"


class Kind(Enum):
    """How a call ended."""

    WORKS = "works"
    """The server took part, and what came back is plausible."""
    CLIENT = "client"
    """The client answered by itself, plausibly."""
    REFUSED = "refused"
    """The server refused by a sentence, which the client raised."""
    LOGGED = "logged"
    """The server refused by a sentence that the client does not read; its log has it."""
    DEFECT = "defect"
    """The client itself cannot do it, against any server; known beforehand and expected by the table."""
    WRONG = "wrong"
    """Something else: an answer that is not plausible, an error that no table expects. Never on the page."""


class Outcome(NamedTuple):
    """One member's kind, the remote functions that were called for it, and the sentence where there is one."""

    kind: Kind
    functions: tuple[str, ...] = ()
    sentence: str = ""


def to_json(outcomes: dict[str, Outcome]) -> str:
    """Return the record: one line a member, so that a change shows as a line."""
    lines = [
        f"  {json.dumps(member)}: {json.dumps([found.kind.value, *found.functions, found.sentence])}"
        for member, found in sorted(outcomes.items())
    ]
    return "{\n" + ",\n".join(lines) + "\n}\n"


def from_json(text: str) -> dict[str, Outcome]:
    """Return what :func:`to_json` has written."""
    return {member: _outcome(*fields) for member, fields in json.loads(text).items()}


def _outcome(kind: str, *rest: Any) -> Outcome:
    return Outcome(Kind(kind), tuple(rest[:-1]), rest[-1])
