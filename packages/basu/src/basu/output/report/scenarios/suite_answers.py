"""The requirements of a suite answered from a run's folder: requirement, test, evidence and confidence by agent."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.errors import UserError
from basu.files import read_json
from basu.intervals import FEW, clopper_pearson
from basu.output.report.documents import RESULT_FILE
from basu.scenarios.suites.checks import CaseAnswer, RequirementAnswer, answer_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

PREFIX = "suite-"
WIDTH = 110  # of a line of text
NOT_PLAYED = "not played"
MET, BROKEN, OPEN = "met", "not met", "not shown"


def suite_file(name: str) -> str:
    """Return the name of the file with a suite's requirements in the folder of a run."""
    return f"{PREFIX}{name}.json"


def read_suites(folder: Path) -> list[dict[str, Any]]:
    """Return the suites of a run; none where no suite was requested.

    Raises:
        UserError: a file of them cannot be read.
    """
    return [read_json(path, "the suite", "play the suite again") for path in sorted(folder.glob(f"{PREFIX}*.json"))]


class RequirementEvidence(NamedTuple):
    """One case of a requirement with one agent."""

    case: str
    anchor: str  # of the case's folder, empty where it left none
    verdict: str  # BASU's own
    answer: RequirementAnswer
    sentence: str


class Answered(NamedTuple):
    """One requirement with one agent."""

    agent: str
    word: str  # `MET`, `BROKEN` or `OPEN`
    evidence: tuple[RequirementEvidence, ...]
    confidence: tuple[str, ...]  # sentences

    def count(self, answer: RequirementAnswer) -> int:
        """Return the number of cases with an answer."""
        return sum(each.answer is answer for each in self.evidence)

    @property
    def summary(self) -> str:
        """The numbers of cases by answer."""
        total, held = len(self.evidence), self.count(RequirementAnswer.HELD)
        others = [
            f"{self.count(each)} {each.value}"
            for each in RequirementAnswer
            if each is not RequirementAnswer.HELD and self.count(each)
        ]
        return ", ".join([f"held in {held} of {total} cases", *others])


class AnsweredRequirement(NamedTuple):
    """A requirement with the answers of all agents; none where it is not tested."""

    requirement: Mapping[str, Any]
    agents: tuple[Answered, ...]


class AnsweredSuite(NamedTuple):
    """A suite with all answers."""

    document: Mapping[str, Any]
    requirements: tuple[AnsweredRequirement, ...]
    agents: tuple[str, ...]

    def word(self, agent: str) -> str:
        """Return the answer of an agent to all tested requirements: met only if each of them is."""
        words = [one.word for each in self.requirements for one in each.agents if one.agent == agent]
        return BROKEN if BROKEN in words else MET if words and set(words) == {MET} else OPEN

    def met(self, agent: str) -> tuple[int, int]:
        """Return the numbers of requirements that an agent met, and that were tested."""
        words = [one.word for each in self.requirements for one in each.agents if one.agent == agent]
        return words.count(MET), len(words)


def answered(folder: Path, document: Mapping[str, Any], matrix: Mapping[str, Any]) -> AnsweredSuite:
    """Return a suite answered from the results of the cases in the folder of a run."""
    rows: dict[str, list[Mapping[str, Any]]] = {}
    for case in matrix["cases"]:
        rows.setdefault(case["id"], []).append(case)
    agents = tuple(matrix["agents"])
    requirements = tuple(
        AnsweredRequirement(
            each, tuple(_answered(folder, each, agent, rows) for agent in agents) if each["check"] else ()
        )
        for each in document["requirements"]
    )
    return AnsweredSuite(document, requirements, agents)


def _answered(
    folder: Path, requirement: Mapping[str, Any], agent: str, rows: Mapping[str, Sequence[Mapping[str, Any]]]
) -> Answered:
    """Return a requirement's answer for one agent."""
    evidence = tuple(
        _evidence(folder, requirement, case, row["results"].get(agent))
        for case in requirement["cases"]
        for row in rows.get(case, ())
    )
    answers = [each.answer for each in evidence]
    if RequirementAnswer.BROKEN in answers:
        word = BROKEN
    else:
        word = MET if RequirementAnswer.HELD in answers and RequirementAnswer.NOT_SHOWN not in answers else OPEN
    return Answered(agent, word, evidence, _confidence(answers))


def _evidence(
    folder: Path, requirement: Mapping[str, Any], case: str, cell: Mapping[str, Any] | None
) -> RequirementEvidence:
    """Return the evidence of one drive."""
    if cell is None or not cell["folder"]:
        return RequirementEvidence(case, "", NOT_PLAYED, RequirementAnswer.NOT_SHOWN, "it was not played to its end")
    try:
        result = read_json(folder / cell["folder"] / RESULT_FILE, "the document", "play the case again")
        found = answer_of(requirement["check"], result)
    except UserError as error:
        found = CaseAnswer(RequirementAnswer.NOT_SHOWN, str(error))
    return RequirementEvidence(case, cell["folder"], cell["verdict"], *found)


def _confidence(answers: Sequence[RequirementAnswer]) -> tuple[str, ...]:
    """Return sentences on how much the evidence says."""
    held, broken = answers.count(RequirementAnswer.HELD), answers.count(RequirementAnswer.BROKEN)
    judged, total = held + broken, len(answers)
    if judged == 0:
        return ("No case shows anything.",)
    found = clopper_pearson(held, judged)
    sentences = [f"{held} of {judged}: {100 * found.low:.0f} to {100 * found.high:.0f} % with 95 %."]
    if judged < total:
        sentences.append(f"{total - judged} of {total} cases say nothing about it.")
    if judged < FEW:
        sentences.append(f"Fewer than {FEW} cases: the interval is wide.")
    return tuple(sentences)


def suite_text(suite: AnsweredSuite) -> list[str]:
    """Return a suite as lines for a console: each requirement with each agent's answer."""
    lines = [f"{suite.document['name']}: {suite.document['title']}"]
    for requirement, agents in suite.requirements:
        lines.append(f"  {requirement['id']}: {requirement['clause']}")
        if not agents:
            lines += textwrap.wrap(
                f"not tested: {requirement['untested']}", WIDTH, initial_indent="    ", subsequent_indent="      "
            )
        lines += [f"    {one.agent:<14}{one.word:<11}{one.summary}; {one.confidence[0]}" for one in agents]
    for agent in suite.agents:
        met, tested = suite.met(agent)
        lines.append(f"  {agent}: {met} of {tested} tested requirements met; the suite is {suite.word(agent)}")
    return lines
