"""Claims about the documents of scenario runs: as their schemas say, read as the library reads them."""

import copy
import json
import random
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from basu.errors import UserError
from basu.metrics.result import judge
from basu.outcome import Outcome, Status
from basu.output.report.documents import RESULT_FILE, RESULT_SCHEMA, mistakes, read_result, read_schema, write_json
from basu.output.report.scenarios.matrix_documents import (
    MATRIX_FILE,
    MATRIX_SCHEMA,
    read_case,
    read_matrix,
)
from basu.output.report.streets import write_streets
from basu.records.history.files import write_history
from fakes.results import META, a_result
from fakes.scenario_documents import NAMED, case_result, crossing, failed, grid, matrix, sweep


def whole(case: dict[str, Any]) -> dict[str, Any]:
    """The result of the drive of a case."""
    outcome = Outcome(Status(case["status"]), case["message"])
    return judge(outcome, crossing(), meta=META, case=case).document()


DOCUMENTS = [
    (whole(case_result()), RESULT_SCHEMA),
    (whole(failed(tree=None, actors=[], things=[])), RESULT_SCHEMA),
    (matrix(["basic"], instances=1), MATRIX_SCHEMA),
    (sweep(10), MATRIX_SCHEMA),
    (grid(2), MATRIX_SCHEMA),
]


@pytest.mark.parametrize(("document", "name"), DOCUMENTS)
def test_documents_are_as_their_schemas_say(document: dict[str, Any], name: str) -> None:
    jsonschema.Draft202012Validator.check_schema(read_schema(name))
    jsonschema.Draft202012Validator(read_schema(name)).validate(json.loads(json.dumps(document)))
    assert list(mistakes(document, read_schema(name))) == []


@pytest.mark.parametrize(("document", "name"), [DOCUMENTS[0], DOCUMENTS[2]])
def test_each_mistake_gets_a_sentence(document: dict[str, Any], name: str) -> None:
    schema = read_schema(name)
    dice, library, refused = random.Random(4), jsonschema.Draft202012Validator(schema), 0
    for _ in range(100):
        changed = copy.deepcopy(document)
        place: Any = changed
        while True:  # down to some place
            key = dice.choice(list(place) if isinstance(place, dict) else range(len(place)))
            inside = place[key]
            if not isinstance(inside, dict | list) or not inside or dice.random() < 0.3:
                break
            place = inside
        place[key] = dice.choice([None, True, -1, 7, 0.5, "text", [], {}, {"odd": 1}])
        found = list(mistakes(changed, schema))
        assert bool(found) != library.is_valid(changed), (found, key)
        refused += bool(found)
    assert 25 < refused < 100


def test_a_case_comes_back_from_its_folder(tmp_path: Path) -> None:
    write_json(tmp_path / RESULT_FILE, whole(case_result()))
    write_history(tmp_path, crossing())
    write_streets(tmp_path, NAMED)
    record = read_case(tmp_path)
    assert record.case == case_result()
    assert record.result is not None
    assert record.result.success.passed is True
    assert record.result.scores is not None
    assert record.history is not None
    assert len(record.history.frames) == 240
    assert record.streets == NAMED


def test_a_case_of_an_earlier_version_is_still_read(tmp_path: Path) -> None:
    write_json(tmp_path / RESULT_FILE, {**case_result(), "schema_version": 2})
    record = read_case(tmp_path)
    assert (record.case["verdict"], record.result) == ("SUCCESS", None)
    write_json(tmp_path / RESULT_FILE, {**case_result(verdict="PERHAPS"), "schema_version": 2})
    with pytest.raises(UserError, match='verdict is "PERHAPS"; it must be one of SUCCESS'):
        read_case(tmp_path)


def test_a_report_of_a_case_of_an_earlier_version_says_how_to_play_it_again(tmp_path: Path) -> None:
    write_json(tmp_path / RESULT_FILE, {**case_result(), "schema_version": 2})
    with pytest.raises(UserError, match=r"play it again with `basu scenario run --config .*config\.json`"):
        read_result(tmp_path)


def test_the_folder_of_a_run_is_refused_as_a_case(tmp_path: Path) -> None:
    write_json(tmp_path / RESULT_FILE, a_result())
    with pytest.raises(UserError, match="is a run's folder and no case's; `basu report"):
        read_case(tmp_path)


def test_a_case_in_which_nothing_was_driven_has_no_record(tmp_path: Path) -> None:
    write_json(tmp_path / RESULT_FILE, whole(case_result(verdict="SETUP_FAULT", tree=None)))
    assert read_case(tmp_path).history is None


def test_a_matrix_that_an_actor_changed_is_refused_with_the_place(tmp_path: Path) -> None:
    document = matrix()
    document["cases"][3]["results"]["basic"]["verdict"] = "PERHAPS"
    write_json(tmp_path / MATRIX_FILE, document)
    with pytest.raises(UserError, match=r'cases\[3\]\.results\.basic\.verdict is "PERHAPS"; it must be one of SUCCESS'):
        read_matrix(tmp_path)


def test_a_matrix_of_another_version_is_refused(tmp_path: Path) -> None:
    write_json(tmp_path / MATRIX_FILE, {**matrix(), "schema_version": 7})
    with pytest.raises(UserError, match="schema version 7, and this version of basu reads 2"):
        read_matrix(tmp_path)


def test_documents_made_before_the_policy_are_refused_with_what_to_do(tmp_path: Path) -> None:
    write_json(tmp_path / MATRIX_FILE, {**matrix(), "schema_version": 1})
    with pytest.raises(
        UserError, match="before scenarios were judged on safe, completed and exercised; play its cases"
    ):
        read_matrix(tmp_path)
    write_json(tmp_path / RESULT_FILE, {**case_result(), "schema_version": 1})
    with pytest.raises(UserError, match="play its cases again"):
        read_case(tmp_path)
