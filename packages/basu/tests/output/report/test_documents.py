"""Tests of ``basu.output.report.documents``."""

import copy
import errno
import json
import os
import random
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from basu.errors import UserError
from basu.files import PACKAGE_FOLDER
from basu.metrics.result import Result, judge
from basu.outcome import Outcome, Status
from basu.output.report.document_parts import SCHEMAS, schema_text
from basu.output.report.documents import (
    RESULT_SCHEMA,
    SERIES_SCHEMA,
    make_draft,
    mistakes,
    point_latest,
    publish,
    read_result,
    read_schema,
    run_name,
    write_json,
)
from basu.output.report.series_document import row, totals
from fakes.results import META, a_result

NOON = datetime(2026, 11, 21, 12, 0, 0, tzinfo=timezone.utc)


def made(output: Path, name: str = "a") -> Path:
    return publish(make_draft(output, name), name)


def test_a_folder_is_named_by_time_agent_and_route() -> None:
    assert run_name(NOON, "basic", "linden_leap") == "2026-11-21T12-00-00-basic-linden_leap"


def test_two_runs_of_one_second_have_two_folders(tmp_path: Path) -> None:
    assert [made(tmp_path).name for _ in range(3)] == ["a", "a-2", "a-3"]


def test_two_runs_at_the_same_time_have_a_draft_each(tmp_path: Path) -> None:
    drafts = [make_draft(tmp_path, "a") for _ in range(2)]
    for number, draft in enumerate(drafts):
        (draft / "result.json").write_text(str(number))
    folders = [publish(draft, "a") for draft in drafts]
    assert [(folder.name, (folder / "result.json").read_text()) for folder in folders] == [("a", "0"), ("a-2", "1")]


def test_a_name_with_odd_characters_stays_inside_the_output_folder(tmp_path: Path) -> None:
    folder = made(tmp_path, run_name(NOON, "../../evil name", ".."))
    assert folder.parent == tmp_path
    assert folder.name == "2026-11-21T12-00-00-evil_name-_"


def test_a_draft_is_no_run_for_an_actor_that_looks_for_runs(tmp_path: Path) -> None:
    draft = make_draft(tmp_path, "a")
    assert draft.name.startswith(".")
    assert list(tmp_path.glob("*/result.json")) == []


def test_latest_points_to_the_newest(tmp_path: Path) -> None:
    for _ in range(2):
        folder = made(tmp_path)
        point_latest(folder, tmp_path)
        assert (tmp_path / "latest").resolve() == folder.resolve()


def test_an_output_that_is_a_file_gets_a_sentence(tmp_path: Path) -> None:
    occupied = tmp_path / "runs"
    occupied.write_text("")
    with pytest.raises(UserError, match=r"--output"):
        make_draft(occupied, "a")


def test_something_else_called_latest_is_not_overwritten(tmp_path: Path) -> None:
    (tmp_path / "latest").mkdir()
    (tmp_path / "latest" / "thesis.tex").write_text("years of work")
    with pytest.raises(UserError, match="latest could not be pointed"):
        point_latest(made(tmp_path), tmp_path)
    assert (tmp_path / "latest" / "thesis.tex").exists()


def test_a_full_disk_leaves_the_old_file_and_gets_a_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "result.json"
    write_json(path, {"status": "old"})

    def full(_descriptor: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(UserError, match="No space left on device; make room or name another place with --output"):
        write_json(path, {"status": "new"})
    assert json.loads(path.read_text()) == {"status": "old"}
    assert [entry.name for entry in tmp_path.iterdir()] == ["result.json"]


def test_a_document_without_a_number_is_a_bug_not_a_file(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="not JSON compliant"):
        write_json(tmp_path / "result.json", {"score": float("nan")})


def a_series() -> dict[str, Any]:
    rows = [
        row(Result.from_document(a_result()), number=number, repetition=number, folder=f"run-{number}")
        for number in range(2)
    ]
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


@pytest.mark.parametrize("name", SCHEMAS)
def test_a_schema_is_the_one_that_types_and_registry_give(name: str) -> None:
    written = (PACKAGE_FOLDER / "data" / name).read_text(encoding="utf-8")
    assert written == schema_text(name), "run `python scripts/result_schema.py`"


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
