"""The policy by which every scenario is judged: safe, completed, exercised.

*Safe*: the ego touched no actor, kept every criterion of safety of the scenario, and had no near miss. *Completed*: it
met every goal of the scenario in time. *Exercised*: the conflict came about (`basu.scenarios.exercise`).

A near miss is one of these, with any actor in the record:

- a time to collision below 1.0 s. The Surrogate Safety Assessment Model calls 1.5 s a conflict (FHWA-HRT-08-051, 2008).
  A comfortable stop of 1.5 m/s² at 1.5 m behind a queue has 1.4 s. Sayed and Zein 1999 rate a time to collision below
  1.0 s as a high risk of collision, and 1.0 s to 1.5 s as a moderate one;
- a post-encroachment time below 1.0 s: the critical value of DOCTOR (Kraay, van der Horst and Oppe 1986), against the
  5 s with which the Surrogate Safety Assessment Model screens;
- a clearance below 0.45 m: the least lateral offset to an obstruction in towns (1.5 ft; AASHTO, A Policy on Geometric
  Design of Highways and Streets, 2011, section 4.6.2).

Which of these sources could be read, and which are quoted from memory: `docs/decisions/0054-verdicts.md`.

Frames count in which the ego moved faster than 0.5 m/s. The clearance also counts at a creep, from 0.1 m/s on. Then the
other must be a walker, a cyclist, or itself faster than 0.5 m/s. To creep up to a standing vehicle is no danger, to
creep past a child is. The times do not count at a creep: they are then of the other's making. An actor that comes near
an ego at rest has done so alone.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.boxes import other_boxes, own_boxes
from basu.metrics.passengers.near_misses import post_encroachment_s, times_to_collision_s
from basu.outcome import Fault
from basu.records.partners import UNPROTECTED
from basu.scenarios.criteria.contact import NoCollision
from basu.scenarios.criteria.criterion import Aspect, Criterion
from basu.scenarios.criteria.margin import present_in
from basu.scenarios.criteria.surrogate_measures import ego_moves, gap_m
from basu.scenarios.exercise import Finding
from basu.thresholds import AT_REST_MPS, IN_MOTION_MPS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from basu.outcome import Outcome
    from basu.records.history import History
    from basu.scenarios.criteria.criterion import Judgement, Played
    from basu.scenarios.criteria.margin import Present

NEAR_TTC_S = 1.0
NEAR_PET_S = 1.0
NEAR_M = 0.45


class Assessment(NamedTuple):
    """What the policy says of a drive."""

    safe: Finding
    completed: Finding
    exercised: Finding

    def document(self) -> dict[str, dict[str, bool | str | None]]:
        """The answers as plain values."""
        return {name: finding._asdict() for name, finding in self._asdict().items()}


class NearMiss(NamedTuple):
    """The worst moment with one party."""

    excess: float  # the figure as a part of its limit: 0 is a contact, 1 the limit
    sentence: str
    tick: int
    measured: float
    unit: str
    limit: str
    other: str


class NoNearMiss(Criterion):
    """The moving ego keeps the policy's margins to all actors: 1.0 s to a collision, 1.0 s after another, 0.45 m."""

    name = "no near miss"
    aspect = Aspect.SAFE

    def judge(self, played: Played) -> Judgement:
        """The moment that undercuts its limit most decides."""
        present = present_in(played)
        found = [miss for miss in (_ttc(present), _pet(present), _clearance(present)) if miss is not None]
        if not found:
            limit = f"{NEAR_TTC_S:g} s, {NEAR_M:g} m"
            return self.says(played, True, "the moving ego kept its margins to all actors", limit=limit)
        worst = min(found)
        return self.says(
            played,
            False,
            worst.sentence,
            tick=worst.tick,
            measured=worst.measured,
            unit=worst.unit,
            limit=worst.limit,
            other=worst.other,
        )


ALWAYS = (NoCollision, NoNearMiss)


def with_policy(criteria: Sequence[Criterion]) -> tuple[Criterion, ...]:
    """A scenario's criteria, and those of the policy that it does not name itself."""
    return (*criteria, *(kind() for kind in ALWAYS if not any(isinstance(each, kind) for each in criteria)))


def assess(
    criteria: Sequence[Criterion], judgements: Sequence[Judgement], outcome: Outcome, exercised: Finding
) -> Assessment:
    """The three answers; ``judgements`` begin with those of ``criteria`` in their order."""
    pairs = [(each, said) for each, said in zip(criteria, judgements, strict=False) if said.deciding]
    safe = _aspect([pair for pair in pairs if pair[0].aspect is Aspect.SAFE], "no contact, and no actor was near")
    goals = [pair for pair in pairs if pair[0].aspect is Aspect.COMPLETED]
    completed = _aspect(goals, "the drive came to its end")
    if completed.holds is not False and outcome.status.fault is Fault.AGENT:
        completed = Finding(False, outcome.message)
    if safe.holds is False and exercised.holds is False:
        exercised = Finding(True, safe.sentence)  # an unsafe drive has met a conflict, whatever led to it
    return Assessment(safe, completed, exercised)


def _aspect(pairs: Sequence[tuple[Criterion, Judgement]], otherwise: str) -> Finding:
    """Whether all of them hold; the sentence is that of the most serious one that does not."""
    failed = most_serious(pairs)
    if failed is not None:
        return Finding(False, f"{failed.criterion}: {failed.sentence}")
    met = [said.criterion for _, said in pairs if said.passed is not None]
    return Finding(True, ", ".join(met) or otherwise)


def most_serious(pairs: Sequence[tuple[Criterion, Judgement]]) -> Judgement | None:
    """Of the criteria that failed: a collision before all, then the earliest, then the first in order."""
    failed = [
        (not isinstance(criterion, NoCollision), math.inf if said.t_s is None else said.t_s, index)
        for index, (criterion, said) in enumerate(pairs)
        if said.passed is False
    ]
    return pairs[min(failed)[2]][1] if failed else None


def passing_rows(history: History) -> NDArray[np.int64]:
    """Rows of the others in frames in which the ego moves, or creeps near an actor that a creep endangers."""
    others = history.others
    exposed = [key for key, kind in history.facts.actor_types.items() if kind.startswith(UNPROTECTED)]
    theirs_mps = np.hypot(others["velocity_x_mps"], others["velocity_y_mps"])
    endangered = np.isin(others["id"], exposed) | (theirs_mps > IN_MOTION_MPS)
    return np.flatnonzero(history.speed_mps()[others["tick"]] > np.where(endangered, AT_REST_MPS, IN_MOTION_MPS))


def _ttc(present: Present) -> NearMiss | None:
    """The least time to collision, where it is below its limit."""
    history = present.history
    rows = np.flatnonzero(ego_moves(history)[history.others["tick"]])
    own, others = own_boxes(history.facts, history.frames), other_boxes(history.facts, history.others)
    found_s = times_to_collision_s(history, own, others, NEAR_TTC_S)[rows]
    ticks = history.others["tick"][rows].astype(np.int64)
    return _least(present, rows, found_s, ticks, (NEAR_TTC_S, "s", "was {:.2f} s from a collision"))


def _pet(present: Present) -> NearMiss | None:
    """The least post-encroachment time, where it is below its limit and the ego moved when the second one came."""
    history = present.history
    own, others = own_boxes(history.facts, history.frames), other_boxes(history.facts, history.others)
    found_s, later = post_encroachment_s(history, own, others, NEAR_PET_S)
    rows = np.flatnonzero((later >= 0) & (history.speed_mps()[np.maximum(later, 0)] > IN_MOTION_MPS))
    words = "and the ego took the same place {:.2f} s apart"
    return _least(present, rows, found_s[rows], later[rows], (NEAR_PET_S, "s", words))


def _clearance(present: Present) -> NearMiss | None:
    """The least distance between boxes, where it is below its limit."""
    history, rows = present.history, passing_rows(present.history)
    others = history.others[rows]
    own = own_boxes(history.facts, history.frames)[others["tick"]]
    ticks = others["tick"].astype(np.int64)
    return _least(
        present, rows, gap_m(own, other_boxes(history.facts, others)), ticks, (NEAR_M, "m", "was {:.2f} m away")
    )


def _least(
    present: Present,
    rows: NDArray[np.int64],
    values: NDArray[np.float64],
    ticks: NDArray[np.int64],
    measure: tuple[float, str, str],
) -> NearMiss | None:
    """The least figure as a near miss; None where it keeps its limit."""
    limit, unit, words = measure
    if len(rows) == 0 or float(values.min()) >= limit:
        return None
    least = int(np.argmin(values))
    value, tick = float(values[least]), int(ticks[least])
    key, history = int(present.history.others["id"][rows[least]]), present.history
    sentence = (
        f"{present.described(key)} {words.format(value)} at {float(history.frames['t_s'][tick]):.2f} s, "
        f"the ego at {float(history.speed_mps()[tick]):.2f} m/s"
    )
    return NearMiss(value / limit, sentence, tick, value, unit, f"at least {limit:g} {unit}", present.name_of(key))
