"""Judgements, and what criteria were given besides the record, as JSON values and back: to judge a case again."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from basu.outcome import Outcome, Status
from basu.scenarios.criteria.criterion import Judgement, Played, Thing

if TYPE_CHECKING:
    from basu.history import History


def judgement_to_json(judgement: Judgement) -> dict[str, Any]:
    """Its fields; numbers as Python writes them, so that they read back exactly."""
    return judgement._asdict()


def judgement_from_json(document: dict[str, Any]) -> Judgement:
    """Read what :func:`judgement_to_json` wrote."""
    return Judgement(**document)


def played_to_json(played: Played) -> dict[str, Any]:
    """All but the record, which has files of its own."""
    return {
        "outcome": {"status": played.outcome.status.value, "message": played.outcome.message},
        "roles": {str(key): played.roles[key] for key in sorted(played.roles)},
        "things": [thing._asdict() for thing in played.things],
        "phases_s": dict(played.phases_s),
        "timeout_s": played.timeout_s,
    }


def played_from_json(document: dict[str, Any], history: History) -> Played:
    """Read what :func:`played_to_json` wrote."""
    return Played(
        history=history,
        outcome=Outcome(Status(document["outcome"]["status"]), document["outcome"]["message"]),
        roles={int(key): role for key, role in document["roles"].items()},
        things=tuple(Thing(**thing) for thing in document["things"]),
        phases_s=document["phases_s"],
        timeout_s=document["timeout_s"],
    )
