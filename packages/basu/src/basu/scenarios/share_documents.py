"""Crash shares as documents: out of the results of cases, and into plain values with their assumptions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from basu.scenarios.nhtsa import BURDENS, PRINTED_SUMS, Group
from basu.scenarios.shares import CountedCase
from basu.scenarios.verdict import Verdict

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from basu.scenarios.shares import CrashShares, Estimate

ASSUMPTIONS = (
    "A pre-crash scenario's cases here stand for all crashes of that scenario.",
    "A scenario weighs by its frequency within its group (DOT HS 810 767, table 13, GES 2004).",
    "A group weighs by its burden (table 1.1 of the thesis, from DOT HS 812 745, FARS and GES 2011-2015).",
    "A scenario that stands for none of the 37 weighs as much as the mean of its group's other scenarios.",
    "Our places stand for the nation's roads and our parameters for its traffic, however often each is met.",
    "The burden is that of people driving light vehicles, whatever drove here.",
    "A failed case is charged the group's mean crash cost, whether it was a scratch or a near miss.",
    "NOT_EXERCISED counts for neither side in the first figure, and as not passed in the figure for all crashes.",
    "An agent that broke down has not passed.",
    "Cases spoiled by simulator, set-up, benchmark or by hand, or not played, count as NOT_EXERCISED ones do.",
    "Control loss and road departure have no other actor: a driver without perception passes them as well.",
    "The shuttle's own situations are not in the typology and weigh nothing.",
    "Not covered: backing up, vehicle failure, evasive action, crashes with objects, and speeds above a shuttle's.",
    "Intervals (95 %) cover the number of cases alone: cases were chosen by hand and not drawn from crashes.",
)


def results_from(documents: Iterable[Mapping[str, Any]]) -> list[CountedCase]:
    """Results out of the documents of cases (their ``result.json``)."""
    return [
        CountedCase(
            case=document["id"],
            scenario=document["scenario"],
            group=Group(document["group"]),
            verdict=Verdict(document["verdict"]),
            message=document["message"],
            margins=document["margins"],
            at_fault=sum(collision["at_fault"] for collision in document["collisions"]),
            collisions=len(document["collisions"]),
            pre_crash=tuple(document.get("pre_crash", ())),
        )
        for document in documents
    ]


def not_played(about: Mapping[str, Any]) -> CountedCase:
    """The result of a case of the suite that was not played, by the facts of the case."""
    return CountedCase(
        case=about["id"],
        scenario=about["scenario"],
        group=Group(about["group"]),
        verdict=Verdict.INTERRUPTED,
        message="not played: the run was interrupted before",
        margins={},
        pre_crash=tuple(about["pre_crash"]),
    )


def shares_to_json(found: CrashShares) -> dict[str, Any]:
    """Plain values, with the tables' figures and the assumptions beside them."""
    return {
        "share_of_cost": _plain(found.cost),
        "share_of_crashes": _plain(found.crashes),
        "share_of_fatal_crashes": _plain(found.fatal_crashes),
        "share_of_equivalent_lives": _plain(found.equivalent_lives),
        "shown_of_cost": _plain(found.shown_cost),
        "measured_of_cost": found.measured_of_cost,
        "cases": found.cases,
        "judged": found.judged,
        "groups": [
            {
                "group": share.group.value,
                "passed": _plain(share.passed),
                "shown": _plain(share.shown),
                "scenarios": share.scenarios,
                "cases": share.cases,
                "not_exercised": share.not_exercised,
                "burden": BURDENS[share.group]._asdict() if share.group in BURDENS else None,
            }
            for share in found.groups
        ],
        "unmeasured": [group.value for group in found.unmeasured],
        "not_exercised": found.not_exercised,
        "collisions": found.collisions,
        "at_fault": found.at_fault,
        "left_out": [
            {"case": result.case, "verdict": result.verdict.value, "message": result.message}
            for result in found.left_out
        ],
        "narrowest": [
            {"scenario": one.scenario, "least": dict(one.least), "cases": dict(one.cases)} for one in found.narrowest
        ],
        "printed_total": PRINTED_SUMS.burden._asdict(),
        "sentence": sentence(found),
        "assumptions": list(ASSUMPTIONS),
    }


def sentence(found: CrashShares) -> str:
    """The score in a sentence."""
    judged = f"{found.judged} of {found.cases} cases judged"
    if found.cost is None:
        return f"{judged}: no group of the typology was exercised, so nothing can be said about crashes"
    number = len(BURDENS) - len(found.unmeasured)
    groups = "the one group exercised, which is" if number == 1 else f"the {number} groups exercised, which are"
    text = (
        f"{judged}: it passes situations that stand for {_percent(found.cost)} of the crash cost of {groups} "
        f"{100.0 * found.measured_of_cost:.0f} % of all, and shows {_percent(found.shown_cost)} of all crash cost"
    )
    if found.unmeasured:
        text += f"; not exercised: {', '.join(group.value for group in found.unmeasured)}"
    if found.left_out:
        text += f"; {len(found.left_out)} case{'s' if len(found.left_out) > 1 else ''} left out"
    return text


def _percent(estimate: Estimate) -> str:
    """A share with its interval."""
    return f"{100.0 * estimate.share:.0f} % ({100.0 * estimate.low:.0f} to {100.0 * estimate.high:.0f})"


def _plain(estimate: Estimate | None) -> dict[str, float] | None:
    """An estimate for a document."""
    return None if estimate is None else estimate._asdict()
