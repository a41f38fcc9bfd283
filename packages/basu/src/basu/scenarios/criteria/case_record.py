"""Records for criteria: a case read from its folder, and a part of a longer run as a record of its own."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from basu.errors import UserError
from basu.files import loads
from basu.outcome import Outcome, Status
from basu.records.history.files import read_history
from basu.routing.planned_route import until
from basu.scenarios.criteria.criterion import Judgement, Played, StandingThing

if TYPE_CHECKING:
    from pathlib import Path

    from basu.records.history import History


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
            things=tuple(StandingThing(**thing) for thing in document["things"]),
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
        document: dict[str, Any] = loads((folder / RESULT_FILE).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise UserError(f"{folder} holds no result that can be read: {error}") from error
    case: dict[str, Any] = document.get("case", document)  # an earlier version wrote the case alone
    return case


def part_of(history: History, first: int, end: int, until_s_m: float | None = None) -> History:
    """The frames from ``first`` to before ``end``, their events, and the route up to ``until_s_m`` (None: all of it).

    Ticks count from the part's first frame; times stay those of the run, and places along the route as well, so that
    an ego beyond ``until_s_m`` has arrived.
    """
    frames = history.frames[first:end].copy()
    frames["tick"] -= first
    others = history.others[(history.others["tick"] >= first) & (history.others["tick"] < end)].copy()
    others["tick"] -= first
    route = history.facts.route
    return replace(
        history,
        facts=replace(history.facts, route=route if until_s_m is None else until(route, until_s_m)),
        frames=frames,
        others=others,
        collisions=tuple(replace(e, tick=e.tick - first) for e in history.collisions if first <= e.tick < end),
        lane_invasions=tuple(replace(e, tick=e.tick - first) for e in history.lane_invasions if first <= e.tick < end),
    )
