"""Claims about run folders: never one over another, never half a file, a sentence where the disk says no."""

import errno
import json
import os
from datetime import datetime, timezone
from pathlib import Path

import pytest

from basu.errors import UserError
from basu.output.report.folder import make_draft, point_latest, publish, run_name, write_json

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


def test_a_draft_is_no_run_for_whoever_looks_for_runs(tmp_path: Path) -> None:
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
