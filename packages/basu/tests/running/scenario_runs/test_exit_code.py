"""Claims about the exit code of ``basu scenario run``: that of the worst verdict."""

from typing import Any

import pytest

from basu.running.scenario_runs.command import worst
from basu.scenarios.suites.checks import RequirementAnswer, answer_of


def document(verdict: str, fault: str = "none", *, completed: bool = True) -> dict[str, Any]:
    """What the exit code reads of a case's result."""
    return {"verdict": verdict, "fault": fault, "assessment": {"completed": {"holds": completed, "sentence": "so"}}}


@pytest.mark.parametrize(
    ("found", "code"),
    [
        (document("SUCCESS"), 0),
        (document("FAILURE"), 1),
        (document("AGENT_FAULT", "agent"), 1),
        (document("SETUP_FAULT", "setup"), 2),
        (document("SIMULATOR_FAULT", "simulator"), 3),
        (document("NOT_EXERCISED"), 0),
        (document("NOT_EXERCISED", completed=False), 1),
    ],
)
def test_each_verdict_has_its_code(found: dict[str, Any], code: int) -> None:
    assert worst(iter([document("SUCCESS"), found])) == code


def test_a_driver_that_stands_through_every_case_does_not_pass_a_build() -> None:
    assert worst(iter([document("NOT_EXERCISED", completed=False)] * 3)) == 1


def test_a_requirement_that_is_held_with_a_near_miss_still_ends_a_suite_with_1() -> None:
    """The exit code is that of the worst verdict; the requirements stand on the suite's page."""
    near_miss = {
        **document("FAILURE"),
        "message": "no near miss: 0.4 m",
        "judgements": [{"criterion": "no collision", "passed": True, "sentence": "nothing was touched"}],
    }
    found = answer_of({"kind": "no contact"}, {"case": near_miss})
    assert found.answer is RequirementAnswer.HELD
    assert worst(iter([document("SUCCESS"), near_miss])) == 1
