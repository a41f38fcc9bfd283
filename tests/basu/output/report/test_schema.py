"""Claims about result.json and series.json: as their schemas say, with a sentence for each mistake."""

import copy
import json
import random
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from basu.errors import UserError
from basu.metrics.result import judge
from basu.metrics.result_schema import SCHEMA_FILE, schema_text
from basu.outcome import Outcome, Status
from basu.output.report.schema import RESULT_SCHEMA, SERIES_SCHEMA, mistakes, read_result, read_schema
from basu.output.report.series import row, totals
from fakes.results import META, a_result


def a_series() -> dict[str, Any]:
    rows = [row(a_result(), number=number, repetition=number, folder=f"run-{number}") for number in range(2)]
    document = {
        "schema_version": 1,
        "options": {"--seed": 0},
        "planned": 3,
        "runs": rows,
        "set_aside": [],
        "totals": totals(rows, 3),
    }
    plain: dict[str, Any] = json.loads(json.dumps(document))
    return plain


@pytest.mark.parametrize(("document", "name"), [(a_result(), RESULT_SCHEMA), (a_series(), SERIES_SCHEMA)])
def test_what_is_written_is_as_the_schema_says(document: dict[str, Any], name: str) -> None:
    jsonschema.Draft202012Validator.check_schema(read_schema(name))
    jsonschema.Draft202012Validator(read_schema(name)).validate(document)
    assert list(mistakes(document, read_schema(name))) == []


def test_a_run_in_which_nothing_was_driven_has_a_result_too() -> None:
    document = judge(Outcome(Status.SETUP_FAILED, "no such sensor"), None, meta=META).document()
    jsonschema.Draft202012Validator(read_schema(RESULT_SCHEMA)).validate(document)


def test_a_series_without_any_run_is_as_the_schema_says() -> None:
    document = a_series() | {"runs": [], "totals": totals([], 3)}
    jsonschema.Draft202012Validator(read_schema(SERIES_SCHEMA)).validate(document)


def places(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    inside = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [path, *(place for key, entry in inside for place in places(entry, (*path, key)))]


def damaged(document: dict[str, Any], dice: random.Random) -> dict[str, Any]:
    """The document with one value changed for another, or taken away."""
    whole = copy.deepcopy(document)
    *way, last = dice.choice(places(whole)[1:])
    holder: Any = whole
    for key in way:
        holder = holder[key]
    if dice.random() < 0.2 and isinstance(holder, dict):
        del holder[last]
    else:
        holder[last] = dice.choice([None, True, -1, 7, 0.5, 1e9, "text", [], {}, {"odd": 1}, ["odd"]])
    return whole


def test_the_schema_is_the_one_that_the_registry_gives() -> None:
    assert SCHEMA_FILE.read_text(encoding="utf-8") == schema_text(), "run `python scripts/result_schema.py`"


def test_each_way_in_which_a_run_can_end_is_in_the_schema() -> None:
    for status in Status:
        document = judge(Outcome(status, "so"), None, meta=META).document()
        assert list(mistakes(document, read_schema(RESULT_SCHEMA))) == []


@pytest.mark.parametrize(("document", "name"), [(a_result(), RESULT_SCHEMA), (a_series(), SERIES_SCHEMA)])
def test_each_mistake_gets_a_sentence(document: dict[str, Any], name: str) -> None:
    dice, library, refused = random.Random(4), jsonschema.Draft202012Validator(read_schema(name)), 0
    for _ in range(200):
        changed = damaged(document, dice)
        found = list(mistakes(changed, read_schema(name)))
        assert bool(found) != library.is_valid(changed), (found, changed)
        refused += bool(found)
    assert 60 < refused < 200


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"schema_version": 1}, "has the schema version 1, and this version of basu reads 3"),
        (
            {"scores": {"driving": 1.5, "infraction": 1.0, "path_following": 1.0}},
            "scores.driving is 1.5; it must be in 0..1",
        ),
        ({"status": "Won"}, 'status is "Won"; it must be one of Completed'),
        ({"extra": 1}, "extra means nothing here"),
        ({"infractions": [{"kind": "speeding"}]}, r"infractions\[0\] lacks 'tick'"),
        ({"message": None}, "message is null; it must be a text"),
    ],
)
def test_a_changed_result_gets_a_sentence_that_names_the_place(
    tmp_path: Path, change: dict[str, Any], sentence: str
) -> None:
    (tmp_path / "result.json").write_text(json.dumps(a_result() | change))
    with pytest.raises(UserError, match=sentence):
        read_result(tmp_path)


@pytest.mark.parametrize(
    ("text", "sentence"), [(None, "cannot be read"), ("{", "is no JSON"), ("[]", "has the schema version None")]
)
def test_what_is_no_result_gets_a_sentence(tmp_path: Path, text: str | None, sentence: str) -> None:
    if text is not None:
        (tmp_path / "result.json").write_text(text)
    with pytest.raises(UserError, match=sentence):
        read_result(tmp_path)
