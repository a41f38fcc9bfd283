"""The one rule of success: from a run's outcome and its record to passed or not, with the reasons in words.

Each of these alone decides against a drive, as nuPlan multiplies its scores:

- a collision at fault
- a red light run, a stop sign missed, or speeding
- the wrong way, a lane of oncoming traffic without an obstacle to pass, or a stretch off the road
- a failed scenario of its route, or one that the agent waited out until its time was used up
- a route not driven to its end

What went wrong on the road stays a failure, whatever ends the run afterwards. A run that something other than the
agent ended without that is neither passed nor failed.

Routes, campaigns, gymnasium, console, report and comparison ask `success`. The verdict of a case already holds safe,
completed and exercised (`basu.scenarios.verdict`); `success_of_verdict` reads it in the same words. A scenario that
was not exercised counts for neither side.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from basu.metrics.collisions import responsibilities
from basu.metrics.infraction import Infraction
from basu.metrics.lanes import against_route, in_oncoming_lane, off_road
from basu.outcome import Fault, Status

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from basu.metrics.infraction import Evidence
    from basu.outcome import Outcome
    from basu.records.history import History

JUDGED_FAULTS = frozenset({Fault.NONE, Fault.AGENT})  # of the rest, none says anything of the agent
SUCCEEDED, FAILED = "SUCCESS", frozenset({"FAILURE", "AGENT_FAULT"})  # verdicts of scenarios
NOT_EXERCISED = "NOT_EXERCISED"
NOT_COMPLETED = "not completed"
"""How the reason begins that says how a drive ended, and not what went wrong on the road."""
_WORDS = {True: "passed", False: "failed", None: "not judged"}
_RULES = (Infraction.RED_LIGHT, Infraction.STOP_SIGN, Infraction.SPEEDING)


class Success(NamedTuple):
    """Whether a drive passed; None where it says nothing of the agent. The reasons are sentences, in order of time."""

    passed: bool | None
    reasons: tuple[str, ...] = ()

    @property
    def word(self) -> str:
        """The answer in a word or two."""
        return _WORDS[self.passed]

    @property
    def sentence(self) -> str:
        """The answer with all of its reasons."""
        return f"{self.word}: {'; '.join(self.reasons)}" if self.reasons else self.word


NOT_JUDGED = Success(None)


def success(
    outcome: Outcome,
    history: History | None,
    infractions: Sequence[Evidence],
    scenarios: Sequence[Mapping[str, Any]] = (),
    case: Mapping[str, Any] | None = None,
) -> Success:
    """Decide whether a drive passed: along a route by its record, in a case by the verdict of ``case``.

    ``infractions`` are those of the record, ``scenarios`` the rows of the route's own ones as ``result.json`` has them.
    """
    if case is not None:
        return success_of_verdict(case["verdict"], case["message"])
    driven = history is not None and len(history.frames) > 0
    wrong = _wrong(history, infractions) if driven and history is not None else []
    wrong += [
        f"scenario {row['id']} ({row['scenario']}): {row['message']}" for row in scenarios if row["verdict"] in FAILED
    ]
    wrong += [
        f"scenario {row['id']} ({row['scenario']}): not over after its {row['timeout_s']:g} s"
        for row in scenarios
        if row.get("timed_out") and row["verdict"] == NOT_EXERCISED
    ]
    ended = (
        [] if outcome.status is Status.COMPLETED else [f"{NOT_COMPLETED} ({outcome.status.value}): {outcome.message}"]
    )
    if wrong or not ended:
        return Success(not wrong, (*wrong, *ended))
    judged = outcome.status.fault in JUDGED_FAULTS and outcome.status is not Status.STOPPED
    return Success(False if judged else None, tuple(ended))


def success_of_verdict(verdict: str, message: str) -> Success:
    """Read a verdict of a case in the words of the one rule."""
    if verdict == SUCCEEDED:
        return Success(passed=True)
    return Success(False if verdict in FAILED else None, (message,))


def not_exercised(scenarios: Sequence[Mapping[str, Any]]) -> int:
    """How many of these results are of a conflict that never came about."""
    return sum(row["verdict"] == NOT_EXERCISED for row in scenarios)


def _wrong(history: History, infractions: Sequence[Evidence]) -> list[str]:
    """What went wrong on the road, in order of time."""
    found = [
        (each.t_s, f"{blame.sentence}: {each.detail} at {each.t_s:.1f} s")
        for each, blame in responsibilities(history)
        if blame.at_fault
    ]
    found += [(each.t_s, _rule(each)) for each in infractions if each.kind in _RULES]
    found += [(each.t_s, f"left the road at {each.t_s:.1f} s: {each.detail}") for each in off_road(history)]
    found += [
        (each.t_s, f"drove in the lane of oncoming traffic at {each.t_s:.1f} s: {each.detail}")
        for each in in_oncoming_lane(history)
    ]
    found += [(each.t_s, f"drove the wrong way at {each.t_s:.1f} s: {each.detail}") for each in against_route(history)]
    return [sentence for _, sentence in sorted(found)]


def _rule(found: Evidence) -> str:
    """A broken rule of the road in words."""
    began = {
        Infraction.RED_LIGHT: f"ran a red light, {found.other}",
        Infraction.STOP_SIGN: f"ran {found.other}",
        Infraction.SPEEDING: "was too fast",
    }
    return f"{began[Infraction(found.kind)]} at {found.t_s:.1f} s: {found.detail}"
