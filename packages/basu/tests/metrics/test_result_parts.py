"""Claims about the typed parts of a result: their schema, and that they are what the record's types write."""

from typing import Annotated, Any, Literal, get_type_hints

import pytest
from typing_extensions import NotRequired, TypedDict

from basu.metrics.json_schema import Value, closed, schema_of
from basu.metrics.result_parts import CollisionPart, EvidencePart, JudgementPart, ScoresPart, ThingPart, VerdictName
from basu.metrics.score import Scores
from basu.scenarios.criteria.criterion import Judgement, StandingThing
from basu.scenarios.verdict import EgoContact, Verdict
from fakes.results import a_result


@closed
class Inner(TypedDict):
    """One that has no other keys."""

    name: str


class Outer(TypedDict):
    """One that may have others."""

    share: Annotated[float, Value("of all", low=0, high=1)]
    inner: Inner | None
    later: NotRequired[list[int]]


def test_a_typed_dict_has_the_schema_that_its_annotations_say() -> None:
    inner = {"required": ["name"], "additionalProperties": False, "properties": {"name": {"type": "string"}}}
    assert schema_of(Outer) == {
        "type": "object",
        "required": ["share", "inner"],
        "properties": {
            "share": {"type": "number", "minimum": 0, "maximum": 1, "description": "of all"},
            "inner": {"type": ["object", "null"], **inner},
            "later": {"type": "array", "items": {"type": "integer"}},
        },
    }


@pytest.mark.parametrize(
    ("kind", "schema"),
    [
        (float | str, {"type": ["number", "string"]}),
        (Literal["a", "b"] | None, {"enum": ["a", "b", None]}),
        (dict[str, Any], {"type": "object"}),
        (dict[str, bool], {"type": "object", "additionalProperties": {"type": "boolean"}}),
    ],
)
def test_plain_annotations_have_theirs(kind: Any, schema: dict[str, Any]) -> None:
    assert schema_of(kind) == schema


@pytest.mark.parametrize(
    ("part", "written"),
    [(JudgementPart, Judgement), (ThingPart, StandingThing), (CollisionPart, EgoContact), (ScoresPart, Scores)],
)
def test_a_part_has_the_fields_that_are_written(part: type, written: Any) -> None:
    assert tuple(get_type_hints(part)) == written._fields


def test_evidence_and_verdicts_are_all_that_there_are() -> None:
    evidence = a_result()["infractions"][0]
    assert set(evidence) <= set(get_type_hints(EvidencePart))
    assert set(schema_of(VerdictName)["enum"]) == {verdict.value for verdict in Verdict}
