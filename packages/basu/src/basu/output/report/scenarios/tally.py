"""A matrix counted: passed cases and margins by group, scenario and agent; the sign and word of each verdict."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from basu.output.report.tracks import tracks_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence


class Look(NamedTuple):
    """How a verdict is shown."""

    sign: str  # one character, its own for each verdict that counts
    word: str
    style: str  # class in scenarios.css
    is_judged: bool  # whether it says something about the agent; the rest stays out of shares and counts


LOOKS = {
    "SUCCESS": Look("✓", "passed", "passed", is_judged=True),
    "FAILURE": Look("✗", "failed", "failed", is_judged=True),
    "AGENT_FAULT": Look("!", "agent fault", "broken", is_judged=True),
    "NOT_EXERCISED": Look("○", "not exercised", "absent", is_judged=False),
    "SIMULATOR_FAULT": Look("?", "simulator fault", "unjudged", is_judged=False),
    "SETUP_FAULT": Look("?", "set-up fault", "unjudged", is_judged=False),
    "BENCHMARK_FAULT": Look("?", "benchmark fault", "unjudged", is_judged=False),
    "INTERRUPTED": Look("?", "interrupted", "unjudged", is_judged=False),
}


CONTACT_M = 0.005  # less than that between two boxes is written as a contact


class Tally(NamedTuple):
    """Some results of one agent, counted; margins are the least of the passed cases."""

    passed: int
    judged: int  # with failures and the agent's own faults
    agent_faults: int
    absent: int  # not exercised: the conflict never came about
    unjudged: int  # for faults of others: simulator, set-up, benchmark, or an interruption
    at_fault: int  # collisions for which the agent is at fault
    distance_m: float | None  # None where nothing was passed or no actor was near, so the others
    ttc_s: float | None
    pet_s: float | None

    @property
    def narrowest(self) -> str:
        """The least distance in words; nothing where no actor was near."""
        if self.distance_m is None:
            return ""
        return "contact" if self.distance_m < CONTACT_M else f"{self.distance_m:.2f} m"


class Row(NamedTuple):
    """A scenario with its cases."""

    scenario: str
    title: str
    cases: list[dict[str, Any]]


class ScenarioGroup(NamedTuple):
    """A group with its scenarios."""

    group: str
    rows: list[Row]

    @property
    def cases(self) -> list[dict[str, Any]]:
        """All cases of the group."""
        return [case for row in self.rows for case in row.cases]


def name_of(case: Mapping[str, Any]) -> str:
    """Return the name of a matrix's row: the case's id, with the number of the drive where it was repeated."""
    return f"{case['id']} #{case['repetition'] + 1}" if "repetition" in case else str(case["id"])


def blocks(matrix: dict[str, Any]) -> list[ScenarioGroup]:
    """Return the cases of a matrix by group and scenario, in the order in which they come."""
    found: dict[str, dict[str, Row]] = {}
    for case in matrix["cases"]:
        rows = found.setdefault(case["group"], {})
        row = rows.setdefault(case["scenario"], Row(case["scenario"], case["title"], []))
        row.cases.append(case)
    return [ScenarioGroup(group, list(rows.values())) for group, rows in found.items()]


def tally(cases: Iterable[dict[str, Any]], agent: str) -> Tally:
    """Return what one agent made of cases; those it has no result of are left out."""
    results = [case["results"][agent] for case in cases if agent in case["results"]]
    judged = [result for result in results if LOOKS[result["verdict"]].is_judged]
    passed = [result for result in judged if result["verdict"] == "SUCCESS"]
    absent = sum(result["verdict"] == "NOT_EXERCISED" for result in results)
    return Tally(
        passed=len(passed),
        judged=len(judged),
        agent_faults=sum(result["verdict"] == "AGENT_FAULT" for result in judged),
        absent=absent,
        unjudged=len(results) - len(judged) - absent,
        at_fault=sum(collision["at_fault"] for result in results for collision in result["collisions"]),
        distance_m=_least(passed, "distance_m"),
        ttc_s=_least(passed, "ttc_s"),
        pet_s=_least(passed, "pet_s"),
    )


def tracks(matrix: dict[str, Any]) -> dict[str, str]:
    """Return the track of each agent; empty where nothing was driven."""
    cases = matrix["cases"]
    return {
        agent: tracks_of(case["results"][agent].get("access") for case in cases if agent in case["results"])
        for agent in matrix["agents"]
    }


def judged_share(matrix: dict[str, Any]) -> str:
    """Return what share of the suite was judged, passed or failed, for each agent: the rest counts as not passed."""
    cases = matrix["cases"]
    parts = []
    for agent in matrix["agents"]:
        judged = tally(cases, agent).judged
        parts.append(f"{agent} {judged} of {len(cases)} ({100.0 * judged / len(cases) if cases else 0.0:.0f} %)")
    return f"judged: {', '.join(parts)}"


def _least(results: Sequence[dict[str, Any]], margin: str) -> float | None:
    """Return the least of a margin, over results with one."""
    found = [result["margins"].get(margin) for result in results]
    return min((value for value in found if value is not None), default=None)


def counted(number: int, thing: str) -> str:
    """So many of a thing: "1 case", "2 cases"."""
    return f"{number} {thing}" if number == 1 else f"{number} {thing}s"
