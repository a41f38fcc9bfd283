"""Which of the situations that cause real crashes a driver survives, and how much of the national toll that stands for.

Within a group of NHTSA's typology every scenario weighs the same, and within a scenario every case. Each group then
weighs by what its crashes take in a year: cost, crashes, fatal crashes, equivalent lives (`basu.scenarios.nhtsa`).
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.scenarios.nhtsa import PRINTED_TOTAL, TOLLS, Group
from basu.scenarios.verdict import Verdict

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

ASSUMPTIONS = (
    "A group's scenarios here stand for all crashes of that group, and each of them for as much as any other.",
    "Our places stand for the nation's roads and our parameters for its traffic, however often each is met.",
    "The toll is that of people driving light vehicles (FARS and GES, yearly mean of 2011-2015), whatever drove here.",
    "To survive is to meet every deciding criterion; who does not is taken to pay the mean of the group's crashes.",
    "Groups without a case that was judged are left out of both sums, neither survived nor lost.",
    "An agent that broke down has not survived; cases spoiled by simulator, set-up, benchmark or by hand are left out.",
    "The shuttle's own situations are not in the typology and weigh nothing.",
)
MARGINS = ("distance_m", "ttc_s", "pet_s")


class Result(NamedTuple):
    """What one agent made of one case."""

    case: str  # its id
    scenario: str
    group: Group
    verdict: Verdict
    message: str
    margins: Mapping[str, float | None]


class GroupShare(NamedTuple):
    """How much of a group was survived."""

    group: Group
    survived: float  # 0..1: the mean over scenarios of the mean over cases
    scenarios: int  # with at least one case that counts
    cases: int  # that count


class Narrowest(NamedTuple):
    """How narrowly a scenario's survived cases were survived; None where nobody came near."""

    scenario: str
    least: Mapping[str, float | None]  # by the keys of MARGINS
    cases: Mapping[str, str | None]  # in which case each was


class Standing(NamedTuple):
    """What one agent's results stand for. A share is None where no group was measured."""

    groups: tuple[GroupShare, ...]  # in the order of the typology, the shuttle's own last
    cost: float | None  # share of crash cost in situations survived
    crashes: float | None
    fatal_crashes: float | None
    equivalent_lives: float | None
    measured_of_cost: float  # the measured groups' part of the cost of all nine
    unmeasured: tuple[Group, ...]  # of the typology
    left_out: tuple[Result, ...]
    narrowest: tuple[Narrowest, ...]  # by scenario, in the order in which they come


def standing(results: Sequence[Result]) -> Standing:
    """Weigh the results of one agent."""
    counted = [result for result in results if result.verdict.counts]
    groups = tuple(
        _group(group, of_group)
        for group in Group
        if (of_group := [result for result in counted if result.group is group])
    )
    measured = {share.group: share.survived for share in groups if share.group in TOLLS}
    return Standing(
        groups=groups,
        cost=_weighed(measured, {group: TOLLS[group].cost_musd for group in measured}),
        crashes=_weighed(measured, {group: TOLLS[group].crashes for group in measured}),
        fatal_crashes=_weighed(measured, {group: TOLLS[group].fatal_crashes for group in measured}),
        equivalent_lives=_weighed(measured, {group: TOLLS[group].equivalent_lives for group in measured}),
        measured_of_cost=sum(TOLLS[group].cost_musd for group in measured) / sum(t.cost_musd for t in TOLLS.values()),
        unmeasured=tuple(group for group in TOLLS if group not in measured),
        left_out=tuple(result for result in results if not result.verdict.counts),
        narrowest=_narrowest(counted),
    )


def results_from(documents: Iterable[Mapping[str, Any]]) -> list[Result]:
    """Results out of the documents of cases (their ``result.json``)."""
    return [
        Result(
            case=document["id"],
            scenario=document["scenario"],
            group=Group(document["group"]),
            verdict=Verdict(document["verdict"]),
            message=document["message"],
            margins=document["margins"],
        )
        for document in documents
    ]


def standing_to_json(found: Standing) -> dict[str, Any]:
    """Plain values, with the table's figures and the assumptions beside them."""
    return {
        "share_of_cost": found.cost,
        "share_of_crashes": found.crashes,
        "share_of_fatal_crashes": found.fatal_crashes,
        "share_of_equivalent_lives": found.equivalent_lives,
        "measured_of_cost": found.measured_of_cost,
        "groups": [
            {
                "group": share.group.value,
                "survived": share.survived,
                "scenarios": share.scenarios,
                "cases": share.cases,
                "toll": TOLLS[share.group]._asdict() if share.group in TOLLS else None,
            }
            for share in found.groups
        ],
        "unmeasured": [group.value for group in found.unmeasured],
        "left_out": [
            {"case": result.case, "verdict": result.verdict.value, "message": result.message}
            for result in found.left_out
        ],
        "narrowest": [
            {"scenario": one.scenario, "least": dict(one.least), "cases": dict(one.cases)} for one in found.narrowest
        ],
        "printed_total": PRINTED_TOTAL._asdict(),
        "sentence": sentence(found),
        "assumptions": list(ASSUMPTIONS),
    }


def sentence(found: Standing) -> str:
    """The score in a sentence."""
    if found.cost is None:
        return "no group of the typology was measured, so nothing can be said about the crash toll"
    number = len(TOLLS) - len(found.unmeasured)
    groups = "the one group measured, which is" if number == 1 else f"the {number} groups measured, which are"
    text = (
        f"it survives situations that stand for {100.0 * found.cost:.0f} % of the crash cost of {groups} "
        f"{100.0 * found.measured_of_cost:.0f} % of all"
    )
    if found.unmeasured:
        text += f"; not measured: {', '.join(group.value for group in found.unmeasured)}"
    if found.left_out:
        text += f"; {len(found.left_out)} case{'s' if len(found.left_out) > 1 else ''} left out"
    return text


def _group(group: Group, results: Sequence[Result]) -> GroupShare:
    """The share of a group from its cases that count, of which there is at least one."""
    by_scenario: dict[str, list[bool]] = defaultdict(list)
    for result in results:
        by_scenario[result.scenario].append(result.verdict is Verdict.SUCCESS)
    means = [sum(survived) / len(survived) for survived in by_scenario.values()]
    return GroupShare(group, sum(means) / len(means), len(means), len(results))


def _weighed(survived: Mapping[Group, float], weights: Mapping[Group, int]) -> float | None:
    """The mean of the groups' shares by these weights."""
    if not survived:
        return None
    return sum(weights[group] * share for group, share in survived.items()) / sum(weights.values())


def _narrowest(counted: Sequence[Result]) -> tuple[Narrowest, ...]:
    """The least margins of the cases that were survived."""
    by_scenario: dict[str, list[Result]] = defaultdict(list)
    for result in counted:
        if result.verdict is Verdict.SUCCESS:
            by_scenario[result.scenario].append(result)
    return tuple(_narrowest_of(scenario, survived) for scenario, survived in by_scenario.items())


def _narrowest_of(scenario: str, survived: Sequence[Result]) -> Narrowest:
    """Of one scenario."""
    least: dict[str, float | None] = {}
    cases: dict[str, str | None] = {}
    for key in MARGINS:
        known = [(value, result.case) for result in survived if (value := result.margins.get(key)) is not None]
        least[key], cases[key] = min(known, key=lambda found: found[0], default=(None, None))
    return Narrowest(scenario, least, cases)
