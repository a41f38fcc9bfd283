"""Claims about answers: absence shows nothing, an unfinished drive shows nothing, and each model is asked by name."""

from typing import Any

import pytest

from basu.scenarios.suites.checks import RequirementAnswer, answer_of

NO_CONTACT = {"kind": "no contact"}


def result(verdict: str = "SUCCESS", *, touched: bool = False, completed: bool = True, **more: Any) -> dict[str, Any]:
    """A result as a case leaves it, with what the checks read."""
    said = {"criterion": "no collision", "passed": not touched, "sentence": "it touched something" if touched else "ok"}
    case = {
        "verdict": verdict,
        "message": "the message",
        "assessment": {"completed": {"holds": completed, "sentence": "arrives"}},
        "judgements": [said],
    }
    return {"case": case, **more}


def encounter(*, avoids: bool) -> dict[str, Any]:
    """The answers to a contact."""
    answers = [{"model": "FSM", "avoids": avoids, "sentence": "FSM says"}]
    return {"encounters": [{"is_contact": True, "answers": answers}]}


@pytest.mark.parametrize("verdict", ["NOT_EXERCISED", "SETUP_FAULT", "SIMULATOR_FAULT", "INTERRUPTED"])
def test_a_case_that_does_not_count_shows_nothing(verdict: str) -> None:
    assert answer_of(NO_CONTACT, result(verdict)).answer is RequirementAnswer.NOT_SHOWN


def test_a_driver_that_stands_for_ever_after_the_conflict_shows_nothing() -> None:
    found = answer_of(NO_CONTACT, result("FAILURE", completed=False))
    assert found.answer is RequirementAnswer.NOT_SHOWN
    assert "not completed" in found.sentence


def test_a_contact_breaks_the_requirement_even_if_the_drive_was_not_completed() -> None:
    assert answer_of(NO_CONTACT, result("FAILURE", touched=True, completed=False)).answer is RequirementAnswer.BROKEN


def test_an_agent_that_broke_down_has_broken_it() -> None:
    assert answer_of(NO_CONTACT, result("AGENT_FAULT")).answer is RequirementAnswer.BROKEN


@pytest.mark.parametrize(
    ("avoids", "answer"), [(True, RequirementAnswer.BROKEN), (False, RequirementAnswer.NOT_DEMANDED)]
)
def test_a_contact_is_held_against_what_the_named_model_avoids(*, avoids: bool, answer: RequirementAnswer) -> None:
    check = {"kind": "careful driver", "model": "FSM"}
    found = answer_of(check, result("FAILURE", touched=True, careful_drivers=encounter(avoids=avoids)))
    assert (found.answer, found.sentence) == (answer, "FSM says")


def test_the_silence_of_a_model_is_no_excuse() -> None:
    check = {"kind": "careful driver", "model": "RSS"}
    found = answer_of(check, result("FAILURE", touched=True, careful_drivers=encounter(avoids=False)))
    assert found.answer is RequirementAnswer.BROKEN


@pytest.mark.parametrize(("felt", "answer"), [(2.4, RequirementAnswer.HELD), (2.5, RequirementAnswer.BROKEN)])
def test_a_figure_is_held_against_its_limit(felt: float, answer: RequirementAnswer) -> None:
    check = {"kind": "at most", "figure": "hardest braking", "limit": 2.4, "unit": "m/s²"}
    found = answer_of(check, result(passengers={"largest": {"braking_mps2": felt}}))
    assert found.answer is answer
