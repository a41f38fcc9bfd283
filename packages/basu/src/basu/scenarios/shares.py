"""The part of real crashes that the passed cases of a driver stand for, with its confidence interval.

A group of NHTSA's typology has pre-crash scenarios with frequencies (`basu.scenarios.nhtsa`). Each pre-crash scenario
is represented by the BASU scenarios that stand for it, in equal parts; a BASU scenario by its cases, in equal parts.
Each group then weighs by what its crashes take in a year: cost, crashes, fatal crashes, equivalent lives.

Two figures come of this. *Of the exercised*: the passed part of the cases in which the conflict came about. *Shown*:
the passed part of all cases of the suite, over all nine groups; what was not exercised, not represented, not played or
not judged counts as not passed. Absence from a conflict cannot raise the second figure, and no fault can.

Intervals are those of a weighted rate at 95 % (`basu.intervals.weighted`). They cover the number of cases alone.
`packages/basu/tests/scenarios/test_share_coverage.py` holds how often they cover.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, NamedTuple

from basu.intervals import Stratum, weighted
from basu.scenarios.nhtsa import BURDENS, PRE_CRASH, Group, stands_for
from basu.scenarios.verdict import Verdict

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

CONTROL_DRIVERS = {
    "blind": "ignores all others",
    "creeper": "drives at 2 m/s",
    "standing": "never moves",
}
MARGINS = ("distance_m", "ttc_s", "pet_s")


class CountedCase(NamedTuple):
    """What one agent made of one case."""

    case: str  # its id
    scenario: str
    group: Group
    verdict: Verdict
    message: str
    margins: Mapping[str, float | None]
    at_fault: int = 0  # collisions for which the agent is at fault
    collisions: int = 0
    pre_crash: tuple[int, ...] = ()  # declared by a user's scenario


class Estimate(NamedTuple):
    """A share with its interval of 95 %."""

    share: float
    low: float
    high: float


class GroupShare(NamedTuple):
    """How much of a group was passed."""

    group: Group
    passed: Estimate | None  # of the exercised cases; None where none was exercised
    shown: Estimate  # of all cases of the suite, and of all crashes of the group
    scenarios: int  # with at least one case that counts
    cases: int  # that count
    not_exercised: int


class Narrowest(NamedTuple):
    """How narrowly a scenario's passed cases were passed; None where no actor came near."""

    scenario: str
    least: Mapping[str, float | None]  # by the keys of MARGINS
    cases: Mapping[str, str | None]  # in which case each was


class CrashShares(NamedTuple):
    """What one agent's results stand for. A share is None where no group was exercised."""

    groups: tuple[GroupShare, ...]  # in the order of the typology, the shuttle's own last
    cost: Estimate | None  # of the exercised
    crashes: Estimate | None
    fatal_crashes: Estimate | None
    equivalent_lives: Estimate | None
    shown_cost: Estimate  # of all crash cost
    measured_of_cost: float  # the measured groups' part of the cost of all nine
    unmeasured: tuple[Group, ...]  # of the typology
    not_exercised: int
    collisions: int
    at_fault: int
    left_out: tuple[CountedCase, ...]  # for faults of others, and not played
    cases: int  # of the suite
    judged: int  # of them, passed or failed
    narrowest: tuple[Narrowest, ...]  # by scenario, in the order in which they come


def crash_shares(results: Sequence[CountedCase]) -> CrashShares:
    """Weigh the results of one agent."""
    counted = [result for result in results if result.verdict.counts]
    absent = [result for result in results if result.verdict is Verdict.NOT_EXERCISED]
    played = [*counted, *absent]
    exercised = {group: _strata(group, counted) for group in Group}
    shown = {group: _strata(group, results, whole_group=True) for group in Group}
    measured = [group for group in BURDENS if exercised[group]]
    return CrashShares(
        groups=tuple(
            _group_share(group, exercised[group], shown[group], counted, absent)
            for group in Group
            if any(result.group is group for result in played)
        ),
        cost=_weighed(exercised, measured, "cost_musd"),
        crashes=_weighed(exercised, measured, "crashes"),
        fatal_crashes=_weighed(exercised, measured, "fatal_crashes"),
        equivalent_lives=_weighed(exercised, measured, "equivalent_lives"),
        shown_cost=_weighed(shown, list(BURDENS), "cost_musd") or Estimate(0.0, 0.0, 0.0),
        measured_of_cost=sum(BURDENS[g].cost_musd for g in measured) / sum(b.cost_musd for b in BURDENS.values()),
        unmeasured=tuple(group for group in BURDENS if group not in measured),
        not_exercised=len(absent),
        collisions=sum(result.collisions for result in results),
        at_fault=sum(result.at_fault for result in results),
        left_out=tuple(result for result in results if result not in played),
        narrowest=_narrowest(counted),
        cases=len(results),
        judged=len(counted),
    )


def _strata(group: Group, results: Sequence[CountedCase], *, whole_group: bool = False) -> list[Stratum]:
    """The scenarios of a group with their weights.

    Weights sum to 1; with ``whole_group``, to the part of the group's crashes covered by the played scenarios.
    """
    by_scenario: dict[str, list[CountedCase]] = defaultdict(list)
    for result in results:
        if result.group is group:
            by_scenario[result.scenario].append(result)
    weights = scenario_weights(group, [result for of in by_scenario.values() for result in of])
    total = sum(weights.values())
    if whole_group and any(stands_for(name, group, of[0].pre_crash) for name, of in by_scenario.items()):
        total = max(total, float(sum(kind.thousands for kind in PRE_CRASH.values() if kind.group is group)))
    return [
        Stratum(weights[name] / total, sum(one.verdict is Verdict.SUCCESS for one in of), len(of))
        for name, of in by_scenario.items()
    ]


def scenario_weights(group: Group, results: Iterable[CountedCase]) -> dict[str, float]:
    """Return the weight of each scenario of a group: the thousands of yearly crashes that it stands for.

    Scenarios that stand for the same pre-crash scenario share its crashes. One that stands for none weighs as the mean.
    """
    meant = {each.scenario: stands_for(each.scenario, group, each.pre_crash) for each in results}
    sharing: dict[int, int] = defaultdict(int)
    for kinds in meant.values():
        for kind in kinds:
            sharing[kind.number] += 1
    weights = {name: sum(kind.thousands / sharing[kind.number] for kind in kinds) for name, kinds in meant.items()}
    known = [weight for weight in weights.values() if weight > 0.0]
    mean = sum(known) / len(known) if known else 1.0
    return {name: weight or mean for name, weight in weights.items()}


def _combined(strata: Iterable[Stratum]) -> Estimate:
    """Return the weighted sum of the scenarios' shares."""
    return Estimate(*weighted(strata)[:3])


def _group_share(
    group: Group,
    exercised: Sequence[Stratum],
    shown: Sequence[Stratum],
    counted: Sequence[CountedCase],
    absent: Sequence[CountedCase],
) -> GroupShare:
    """The share of one group."""
    return GroupShare(
        group=group,
        passed=_combined(exercised) if exercised else None,
        shown=_combined(shown),
        scenarios=len(exercised),
        cases=sum(result.group is group for result in counted),
        not_exercised=sum(result.group is group for result in absent),
    )


def _weighed(strata: Mapping[Group, Sequence[Stratum]], groups: Sequence[Group], key: str) -> Estimate | None:
    """The strata of several groups, each group weighed by its burden."""
    if not groups:
        return None
    burden: dict[Group, int] = {group: getattr(BURDENS[group], key) for group in groups}
    total = sum(burden.values())
    return _combined(
        stratum._replace(weight=stratum.weight * burden[group] / total) for group in groups for stratum in strata[group]
    )


def _narrowest(counted: Sequence[CountedCase]) -> tuple[Narrowest, ...]:
    """The least margins of the cases that were passed."""
    by_scenario: dict[str, list[CountedCase]] = defaultdict(list)
    for result in counted:
        if result.verdict is Verdict.SUCCESS:
            by_scenario[result.scenario].append(result)
    return tuple(_narrowest_of(scenario, passed) for scenario, passed in by_scenario.items())


def _narrowest_of(scenario: str, passed: Sequence[CountedCase]) -> Narrowest:
    """Of one scenario."""
    least: dict[str, float | None] = {}
    cases: dict[str, str | None] = {}
    for key in MARGINS:
        known = [(value, result.case) for result in passed if (value := result.margins.get(key)) is not None]
        least[key], cases[key] = min(known, key=lambda found: found[0], default=(None, None))
    return Narrowest(scenario, least, cases)
