"""Claims about run folders: never one over another, never half a file, a sentence where the disk says no."""

import errno
import json
import os
from datetime import datetime, timezone
from pathlib import Path

import pytest

from basu.errors import UserError
from basu.report.folder import make_folder, point_latest, write_json

NOON = datetime(2026, 11, 21, 12, 0, 0, tzinfo=timezone.utc)


def test_a_folder_is_named_by_time_agent_and_route(tmp_path: Path) -> None:
    assert make_folder(tmp_path, NOON, "basic", "linden_leap").name == "2026-11-21T12-00-00-basic-linden_leap"


def test_two_runs_of_one_second_have_two_folders(tmp_path: Path) -> None:
    names = [make_folder(tmp_path, NOON, "a", "r").name for _ in range(3)]
    assert names == ["2026-11-21T12-00-00-a-r", "2026-11-21T12-00-00-a-r-2", "2026-11-21T12-00-00-a-r-3"]


def test_a_name_with_odd_characters_stays_inside_the_output_folder(tmp_path: Path) -> None:
    folder = make_folder(tmp_path, NOON, "../../evil name", "..")
    assert folder.parent == tmp_path
    assert folder.name == "2026-11-21T12-00-00-evil_name-_"


def test_latest_points_to_the_newest(tmp_path: Path) -> None:
    for _ in range(2):
        folder = make_folder(tmp_path, NOON, "a", "r")
        point_latest(folder)
        assert (tmp_path / "latest").resolve() == folder.resolve()


def test_an_output_that_is_a_file_gets_a_sentence(tmp_path: Path) -> None:
    occupied = tmp_path / "runs"
    occupied.write_text("")
    with pytest.raises(UserError, match=r"--output"):
        make_folder(occupied, NOON, "a", "r")


def test_something_else_called_latest_is_not_overwritten(tmp_path: Path) -> None:
    (tmp_path / "latest").mkdir()
    (tmp_path / "latest" / "thesis.tex").write_text("years of work")
    with pytest.raises(UserError, match="latest could not be pointed"):
        point_latest(make_folder(tmp_path, NOON, "a", "r"))
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
