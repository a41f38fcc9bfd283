"""The answer of a played case to a requirement: held, broken, not demanded, or not shown, with a sentence."""

from __future__ import annotations

import enum
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.scenarios.criteria.contact import NoCollision
from basu.scenarios.verdict import Verdict

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping


OFF_ROAD_M = 1.0  # of the way: less is the edge of a wheel


class RequirementAnswer(enum.Enum):
    """What one case says about a requirement."""

    HELD = "held"
    BROKEN = "broken"
    NOT_DEMANDED = "not demanded"  # the standard does not ask for it in what happened
    NOT_SHOWN = "not shown"  # the conflict did not come about, or the drive was not completed


class CaseAnswer(NamedTuple):
    """An answer with its reason."""

    answer: RequirementAnswer
    sentence: str


def answer_of(check: Mapping[str, Any], result: Mapping[str, Any]) -> CaseAnswer:
    """Return what a case's ``result.json`` says about a requirement.

    A case shows nothing if its conflict did not come about. A check that holds in a drive that was not completed shows
    nothing either: a vehicle that stands for ever touches no actor. A check that holds off the road is broken: on the
    pavement a vehicle touches no actor of its lane.
    """
    case = result["case"]
    verdict = Verdict(case["verdict"])
    if verdict is Verdict.AGENT_FAULT:
        return CaseAnswer(RequirementAnswer.BROKEN, case["message"])
    if not verdict.counts:
        return CaseAnswer(RequirementAnswer.NOT_SHOWN, case["message"])
    found = CHECKS[check["kind"]](check, result)
    completed = case["assessment"]["completed"]
    if found.answer is RequirementAnswer.HELD and completed["holds"] is False:
        return CaseAnswer(RequirementAnswer.NOT_SHOWN, f"not completed: {completed['sentence']}")
    left_m = _off_road_m(result)
    if found.answer is RequirementAnswer.HELD and left_m >= OFF_ROAD_M:
        return CaseAnswer(RequirementAnswer.BROKEN, f"it drove {left_m:.1f} m off the road; {found.sentence}")
    return found


def _off_road_m(result: Mapping[str, Any]) -> float:
    """Return how far the ego drove beside the road or on the pavement, m; 0 where the record does not say."""
    where = (result.get("outside_lanes") or {}).get("metres_by_where") or {}
    return float(where.get("off_road", 0.0)) + float(where.get("sidewalk", 0.0))


def _no_contact(_check: Mapping[str, Any], result: Mapping[str, Any]) -> CaseAnswer:
    """Held where the ego touched nothing."""
    return _criterion({"criterion": NoCollision.name}, result)


def _criterion(check: Mapping[str, Any], result: Mapping[str, Any]) -> CaseAnswer:
    """Held where a criterion of the case is."""
    said = [each for each in result["case"]["judgements"] if each["criterion"] == check["criterion"]]
    if not said or said[0]["passed"] is None:
        return CaseAnswer(RequirementAnswer.NOT_SHOWN, f"the case does not judge {check['criterion']}")
    return CaseAnswer(RequirementAnswer.HELD if said[0]["passed"] else RequirementAnswer.BROKEN, said[0]["sentence"])


def _verdict(_check: Mapping[str, Any], result: Mapping[str, Any]) -> CaseAnswer:
    """Held where the case is passed."""
    case = result["case"]
    return CaseAnswer(
        RequirementAnswer.HELD if case["verdict"] == Verdict.SUCCESS.value else RequirementAnswer.BROKEN,
        case["message"],
    )


def _at_most(check: Mapping[str, Any], result: Mapping[str, Any]) -> CaseAnswer:
    """Held where a figure of the drive is not above a limit."""
    value = FIGURES[check["figure"]](result)
    if value is None:
        return CaseAnswer(RequirementAnswer.NOT_SHOWN, f"the record has no {check['figure']}")
    answer = RequirementAnswer.HELD if value <= check["limit"] else RequirementAnswer.BROKEN
    return CaseAnswer(answer, f"{check['figure']} {value:.2f} {check['unit']}, at most {check['limit']:g}")


def _careful_driver(check: Mapping[str, Any], result: Mapping[str, Any]) -> CaseAnswer:
    """Broken where the ego touched a vehicle and the named model would have avoided that."""
    untouched = _no_contact({}, result)
    if untouched.answer is not RequirementAnswer.BROKEN:
        return untouched
    for row in result["careful_drivers"]["encounters"]:
        said = next((each for each in row["answers"] if each["model"] == check["model"]), None)
        if row["is_contact"] and said is not None:
            return CaseAnswer(
                RequirementAnswer.BROKEN if said["avoids"] else RequirementAnswer.NOT_DEMANDED, said["sentence"]
            )
    return CaseAnswer(RequirementAnswer.BROKEN, f"{untouched.sentence}; {check['model']} says nothing about it")


CHECKS: dict[str, Callable[[Mapping[str, Any], Mapping[str, Any]], CaseAnswer]] = {
    "no contact": _no_contact,
    "criterion": _criterion,
    "verdict": _verdict,
    "at most": _at_most,
    "careful driver": _careful_driver,
}
"""The ways to answer a requirement, by the ``kind`` of its check."""


def _braking(result: Mapping[str, Any]) -> float | None:
    """Return the hardest braking, in m/s², that a standing passenger felt."""
    found: float | None = ((result["passengers"] or {}).get("largest") or {}).get("braking_mps2")
    return found


def _top_speed(result: Mapping[str, Any]) -> float | None:
    """Return the highest speed of the drive in m/s."""
    found: float | None = (result["reported"] or {}).get("top_speed_mps")
    return found


FIGURES: dict[str, Callable[[Mapping[str, Any]], float | None]] = {
    "hardest braking": _braking,
    "highest speed": _top_speed,
}
"""Figures of a drive that a limit can be held against."""
