"""The verdict about a case: what its criteria say, kept apart from what was nobody's driving."""

from __future__ import annotations

import enum
import math
from typing import TYPE_CHECKING, NamedTuple

from basu.outcome import Fault, Outcome, Status
from basu.scenarios.criteria.contact import NoCollision
from basu.scenarios.criteria.going import arrival_tick
from basu.scenarios.criteria.told import margins_of, told_always

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.scenarios.criteria.criterion import Criterion, Judgement, Played


class Verdict(enum.Enum):
    """What became of a case. Only the first three say something about the agent."""

    SUCCESS = "SUCCESS"
    FAILURE = "FAILURE"
    AGENT_FAULT = "AGENT_FAULT"  # it raised, hung or answered with nonsense: not survived
    SIMULATOR_FAULT = "SIMULATOR_FAULT"
    SETUP_FAULT = "SETUP_FAULT"  # the scenario could not be played, or never began although the ego came by
    BENCHMARK_FAULT = "BENCHMARK_FAULT"  # a bug of ours
    INTERRUPTED = "INTERRUPTED"

    @property
    def counts(self) -> bool:
        """Whether the case tells something about the agent; the others are left out of shares."""
        return self in (Verdict.SUCCESS, Verdict.FAILURE, Verdict.AGENT_FAULT)

    @property
    def fault(self) -> Fault:
        """Who answers for it; nobody where the driving was judged."""
        return FAULT_OF.get(self, Fault.NOBODY)


FAULT_OF = {
    Verdict.AGENT_FAULT: Fault.AGENT,
    Verdict.SIMULATOR_FAULT: Fault.SIMULATOR,
    Verdict.SETUP_FAULT: Fault.SETUP,
    Verdict.BENCHMARK_FAULT: Fault.BENCHMARK,
    Verdict.INTERRUPTED: Fault.USER,
}
BROKEN = (Status.AGENT_CRASHED, Status.AGENT_TIMED_OUT, Status.AGENT_INVALID_CONTROL)
ELSEWHERE = {
    Fault.SIMULATOR: Verdict.SIMULATOR_FAULT,
    Fault.SETUP: Verdict.SETUP_FAULT,
    Fault.BENCHMARK: Verdict.BENCHMARK_FAULT,
    Fault.USER: Verdict.INTERRUPTED,
}


class Judged(NamedTuple):
    """A case with its verdict."""

    verdict: Verdict
    message: str  # why, in a sentence
    judgements: tuple[Judgement, ...]  # of the scenario's criteria in its order, then what is told of every case
    margins: dict[str, float | None]  # how narrowly: distance_m, ttc_s, pet_s
    outcome: Outcome  # of the run

    @property
    def fault(self) -> Fault:
        """Who answers for it; nobody where the driving was judged."""
        return self.verdict.fault


def judge(criteria: Sequence[Criterion], played: Played | None, outcome: Outcome, *, triggered: bool) -> Judged:
    """Judge a case; ``played`` is None where nothing was recorded, ``triggered`` says whether the conflict began.

    What a criterion of the user's raises is let through.
    """
    judgements: tuple[Judgement, ...] = ()
    if played is not None and len(played.history.frames):
        judgements = tuple(criterion.judge(played) for criterion in (*criteria, *told_always(criteria)))
    verdict, message = _verdict(criteria, judgements, played, outcome, triggered=triggered)
    return Judged(verdict, message, judgements, margins_of(judgements), outcome)


def _verdict(
    criteria: Sequence[Criterion],
    judgements: tuple[Judgement, ...],
    played: Played | None,
    outcome: Outcome,
    *,
    triggered: bool,
) -> tuple[Verdict, str]:
    """The first of these that holds: a fault, a scenario that never began, a failure, nothing to judge by, success."""
    if outcome.status in BROKEN:
        return Verdict.AGENT_FAULT, outcome.message
    if outcome.status.fault in ELSEWHERE:
        return ELSEWHERE[outcome.status.fault], outcome.message
    if not judgements or played is None:
        return Verdict.BENCHMARK_FAULT, f"nothing was recorded, though the run ended as {outcome.status.value}"
    arrived = arrival_tick(played.history)
    if not triggered and arrived is not None:
        t_s = played.history.frames["t_s"]
        return Verdict.SETUP_FAULT, (
            f"it never triggered, although the ego arrived after {t_s[arrived] - t_s[0]:.1f} s: its trigger has to "
            "come true on the ego's way"
        )
    return _of_driving(criteria, judgements, outcome, triggered=triggered)


def _of_driving(
    criteria: Sequence[Criterion], judgements: tuple[Judgement, ...], outcome: Outcome, *, triggered: bool
) -> tuple[Verdict, str]:
    """What the drive deserves, where nothing but the driving decided."""
    failed = _most_serious(criteria, judgements)
    if failed is not None:
        return Verdict.FAILURE, f"{failed.criterion}: {failed.sentence}"
    if not triggered:
        return Verdict.FAILURE, f"the ego never came to where it would have been triggered: {outcome.message}"
    if outcome.status.fault is Fault.AGENT:
        return Verdict.FAILURE, outcome.message
    return _passed(judgements)


def _passed(judgements: tuple[Judgement, ...]) -> tuple[Verdict, str]:
    """Nothing failed: success, if anything that decides was judged at all."""
    deciding = [judgement for judgement in judgements if judgement.deciding]
    by = [judgement for judgement in deciding if judgement.passed is not None]
    if not by:
        why = "; ".join(judgement.sentence for judgement in deciding) or "no criterion of it decides"
        return Verdict.SETUP_FAULT, f"there is nothing to judge it by: {why}"
    return Verdict.SUCCESS, f"all {len(by)} criteria were met: {', '.join(judgement.criterion for judgement in by)}"


def _most_serious(criteria: Sequence[Criterion], judgements: tuple[Judgement, ...]) -> Judgement | None:
    """Of the deciding criteria that failed: a collision before all, then the earliest, then the first in order."""
    failed = [
        (not isinstance(criterion, NoCollision), math.inf if found.t_s is None else found.t_s, index)
        for index, (criterion, found) in enumerate(zip(criteria, judgements, strict=False))
        if found.deciding and found.passed is False
    ]
    return judgements[min(failed)[2]] if failed else None
