"""Cases that were never driven, for claims about criteria and verdicts."""

from collections.abc import Mapping
from dataclasses import replace

from basu.outcome import Outcome, Status
from basu.records.history import Collision, History
from basu.scenarios.criteria import Judgement, Played, StandingThing

ARRIVED = Outcome(Status.COMPLETED, "arrived")


def played(
    history: History,
    *,
    outcome: Outcome = ARRIVED,
    roles: Mapping[int, str] | None = None,
    things: tuple[StandingThing, ...] = (),
    phases_s: Mapping[str, float] | None = None,
    timeout_s: float = 60.0,
    collisions: tuple[Collision, ...] = (),
) -> Played:
    """A case with this record; actor 9 is "child" where nothing else is said."""
    if collisions:
        history = replace(history, collisions=collisions)
    return Played(
        history=history,
        outcome=outcome,
        roles={9: "child"} if roles is None else roles,
        things=things,
        phases_s={"trigger": 0.0, "conflict": 1.0, "resolution": 2.0} if phases_s is None else phases_s,
        timeout_s=timeout_s,
    )


def judgement(
    criterion: str = "no collision", *, passed: bool | None = True, deciding: bool = True, **more: object
) -> Judgement:
    """What a criterion might have said."""
    fields = {"measured": None, "unit": "", "limit": "", "sentence": f"{criterion}: {passed}", **more}
    return Judgement(criterion=criterion, passed=passed, deciding=deciding, **fields)  # type: ignore[arg-type]
