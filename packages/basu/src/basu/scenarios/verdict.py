"""The verdict about a case: the policy's three answers as one word, kept apart from faults that are not the driving.

SUCCESS is safe, completed and exercised. FAILURE is unsafe, whatever ended the drive, or exercised and not completed.
NOT_EXERCISED is safe where the conflict never came about; it counts for neither side. See `basu.scenarios.policy`.
"""

from __future__ import annotations

import enum
from typing import TYPE_CHECKING, NamedTuple

from basu.metrics.collisions import beginnings
from basu.metrics.fault import responsibility
from basu.outcome import Fault, Outcome, Status
from basu.scenarios.criteria.going import arrival_tick
from basu.scenarios.criteria.surrogate_measures import margins_of, reported_always
from basu.scenarios.exercise import Finding, came_about
from basu.scenarios.policy import Assessment, assess, with_policy

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from basu.scenarios.criteria.criterion import Criterion, Judgement, Played


class Verdict(enum.Enum):
    """What became of a case. Only the first three say something about the agent."""

    SUCCESS = "SUCCESS"
    FAILURE = "FAILURE"
    AGENT_FAULT = "AGENT_FAULT"  # it raised, hung or answered with nonsense: not survived
    NOT_EXERCISED = "NOT_EXERCISED"  # safe, but the conflict never came about
    SIMULATOR_FAULT = "SIMULATOR_FAULT"
    SETUP_FAULT = "SETUP_FAULT"  # the scenario could not be played, or never began although the ego came by
    BENCHMARK_FAULT = "BENCHMARK_FAULT"  # a bug of ours
    INTERRUPTED = "INTERRUPTED"

    @property
    def counts(self) -> bool:
        """Whether the case was passed or failed; the share shown counts all others as not passed."""
        return self in (Verdict.SUCCESS, Verdict.FAILURE, Verdict.AGENT_FAULT)

    @property
    def fault(self) -> Fault:
        """The party at fault; none where the driving was judged."""
        return FAULT_OF.get(self, Fault.NONE)


FAULT_OF = {
    Verdict.AGENT_FAULT: Fault.AGENT,
    Verdict.SIMULATOR_FAULT: Fault.SIMULATOR,
    Verdict.SETUP_FAULT: Fault.SETUP,
    Verdict.BENCHMARK_FAULT: Fault.BENCHMARK,
    Verdict.INTERRUPTED: Fault.USER,
}
BY_HAND = "driven by hand on a part of the way"
BROKEN = (Status.AGENT_CRASHED, Status.AGENT_TIMED_OUT, Status.AGENT_INVALID_CONTROL)
ELSEWHERE = {
    Fault.SIMULATOR: Verdict.SIMULATOR_FAULT,
    Fault.SETUP: Verdict.SETUP_FAULT,
    Fault.BENCHMARK: Verdict.BENCHMARK_FAULT,
    Fault.USER: Verdict.INTERRUPTED,
}


class EgoContact(NamedTuple):
    """A contact of the ego, and whether the ego is at fault for it (`basu.metrics.fault`)."""

    t_s: float
    other: str  # a role, a thing's name or a blueprint id
    speed_mps: float  # of the ego in the frame before
    at_fault: bool
    kind: str
    sentence: str


class Judged(NamedTuple):
    """A case with its verdict."""

    verdict: Verdict
    message: str  # why, in a sentence
    judgements: tuple[Judgement, ...]  # of the scenario's criteria in its order, then those of every case
    margins: dict[str, float | None]  # how narrowly: distance_m, ttc_s, pet_s
    outcome: Outcome  # of the run
    assessment: Assessment | None  # None where nothing was recorded
    collisions: tuple[EgoContact, ...] = ()

    @property
    def fault(self) -> Fault:
        """The party at fault; none where the driving was judged."""
        return self.verdict.fault


def judge(
    criteria: Sequence[Criterion],
    played: Played | None,
    outcome: Outcome,
    *,
    triggered: bool,
    exercised: Callable[[Played], Finding] = came_about,
) -> Judged:
    """Judge a case.

    ``played`` is None where nothing was recorded; ``triggered`` says whether the conflict began; ``exercised`` answers
    whether it came about. What a user's criterion raises is let through.
    """
    if played is None or len(played.history.frames) == 0:
        verdict, message = _fault(outcome) or (
            Verdict.BENCHMARK_FAULT,
            f"nothing was recorded, though the run ended as {outcome.status.value}",
        )
        return Judged(verdict, message, (), margins_of(()), outcome, None)
    deciding = with_policy(criteria)
    judgements = tuple(criterion.judge(played) for criterion in (*deciding, *reported_always(deciding)))
    begun = exercised(played) if triggered else Finding(False, "the ego never came to where the conflict begins")
    assessment = assess(deciding, judgements, outcome, begun)
    verdict, message = (
        _unsafe(assessment, outcome)
        or _fault(outcome)
        or _never_triggered(played, triggered=triggered)
        or _of_driving(assessment, judgements[: len(criteria)])
    )
    if played.history.frames["manual"].any():
        message = f"{message}; {BY_HAND}"
    return Judged(verdict, message, judgements, margins_of(judgements), outcome, assessment, _collisions(played))


def _collisions(played: Played) -> tuple[EgoContact, ...]:
    """Every contact of the drive, with the responsibility for it."""
    history = played.history
    speed_mps, t_s = history.speed_mps(), history.frames["t_s"]
    found = []
    for event in beginnings(history, {}):
        said = responsibility(history, event)
        found.append(
            EgoContact(
                t_s=float(t_s[event.tick]),
                other=played.roles.get(event.other_id, event.other_type),
                speed_mps=float(speed_mps[max(0, event.tick - 1)]),
                at_fault=said.at_fault,
                kind=said.kind.value,
                sentence=said.sentence,
            )
        )
    return tuple(found)


def _unsafe(assessment: Assessment, outcome: Outcome) -> tuple[Verdict, str] | None:
    """The verdict of an unsafe record: no fault that follows takes it back."""
    if assessment.safe.holds is not False:
        return None
    later = _fault(outcome)
    sentence = assessment.safe.sentence
    return Verdict.FAILURE, sentence if later is None else f"{sentence}; afterwards {later[1]}"


def _fault(outcome: Outcome) -> tuple[Verdict, str] | None:
    """The verdict of a run that something other than the driving decided."""
    if outcome.status in BROKEN:
        return Verdict.AGENT_FAULT, outcome.message
    if outcome.status.fault in ELSEWHERE:
        return ELSEWHERE[outcome.status.fault], outcome.message
    return None


def _never_triggered(played: Played, *, triggered: bool) -> tuple[Verdict, str] | None:
    """The verdict of a scenario after an arrival without its trigger."""
    arrived = arrival_tick(played.history)
    if triggered or arrived is None:
        return None
    t_s = played.history.frames["t_s"]
    return Verdict.SETUP_FAULT, (
        f"it never triggered, although the ego arrived after {t_s[arrived] - t_s[0]:.1f} s: its trigger has to "
        "come true on the ego's way"
    )


def _of_driving(assessment: Assessment, judgements: Sequence[Judgement]) -> tuple[Verdict, str]:
    """What the drive deserves; ``judgements`` are those of the scenario's own criteria."""
    _, completed, exercised = assessment
    if not exercised.holds:
        return Verdict.NOT_EXERCISED, exercised.sentence
    if completed.holds is False:
        return Verdict.FAILURE, completed.sentence
    deciding = [judgement for judgement in judgements if judgement.deciding]
    if all(judgement.passed is None for judgement in deciding):
        why = "; ".join(judgement.sentence for judgement in deciding) or "no criterion of it decides"
        return Verdict.SETUP_FAULT, f"there is nothing to judge it by: {why}"
    return Verdict.SUCCESS, f"safe, completed and exercised: {exercised.sentence}"
