"""Claims about a campaign that cannot be driven: one sentence, before anything is driven, and nothing half-written."""

import importlib
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from basu.campaigns import command
from basu.campaigns.drive_table import read_drives
from basu.cli import main
from basu.jobs import pool
from basu.running.folder_lock import locked
from tracing import untraced

Write = Callable[..., Path]
Say = Callable[..., str]


@pytest.fixture
def say(
    modules: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    here: None,
) -> Say:
    """A function that runs the command line and returns the one sentence that it says."""
    monkeypatch.setattr(command, "drive_player", importlib.import_module(modules).spec)

    def run(file: Path, *options: str) -> str:
        code = main(["campaign", "run", str(file), "--output", str(tmp_path / "campaigns"), *options])
        said = capsys.readouterr()
        assert code not in {0, 130}
        assert said.out == ""
        lines = [line for line in said.err.splitlines() if line]
        assert len(lines) == 1, said.err
        return lines[0]

    return run


def drove_nothing(tmp_path: Path) -> bool:
    """Whether no row, record or document is there, and no folder."""
    return not (tmp_path / "campaigns").exists()


@pytest.mark.parametrize(
    ("before", "after", "sentence"),
    [
        pytest.param('"blind"', '"blnd"', "blnd", id="unknown agent"),
        pytest.param('["basic", "blind"]', "[]", "agents is empty, so there is nothing to drive", id="empty product"),
        pytest.param("sweep = 10", "sweep = 10\nset = {early = 99}", "must be a number from", id="out of range"),
    ],
)
def test_a_wrong_file_is_one_sentence(
    campaign: Write, say: Say, tmp_path: Path, before: str, after: str, sentence: str
) -> None:
    assert sentence in say(campaign((before, after)))
    assert drove_nothing(tmp_path)


def test_a_cluster_that_is_not_there_is_one_sentence(campaign: Write, say: Say, tmp_path: Path) -> None:
    pytest.importorskip("ray")
    said = say(campaign(), "--ray", "127.0.0.1:1")
    assert "no Ray cluster answers at 127.0.0.1:1" in said
    assert "ray start --head" in said
    assert drove_nothing(tmp_path)


def test_two_runs_on_one_folder_are_one_sentence(campaign: Write, say: Say, tmp_path: Path) -> None:
    with locked(tmp_path / "campaigns" / "crossings"):
        assert "another command drives in" in say(campaign())
    assert drove_nothing(tmp_path)


def test_a_node_with_other_versions_is_one_sentence(
    campaign: Write, say: Say, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pool, "versions", lambda: {"basu": "9.9"})
    said = say(campaign())
    assert "a worker has basu" in said
    assert "install the same versions on every node" in said
    assert not list((tmp_path / "campaigns" / "crossings").glob("drives/*/*"))


def test_a_full_disk_is_one_sentence_before_a_drive(campaign: Write, tmp_path: Path, modules: str) -> None:
    """The limit on the size of files stands for the disk: no file can be written."""
    words = (
        "import signal, sys; signal.signal(signal.SIGXFSZ, signal.SIG_IGN);"
        "from basu.campaigns import command; from importlib import import_module;"
        "from basu.cli import main;"
        "command.drive_player = import_module(sys.argv.pop(1)).spec;"
        "sys.exit(main(sys.argv[1:]))"
    )
    arguments = ["campaign", "run", str(campaign()), "--output", str(tmp_path / "campaigns")]
    with untraced():  # coverage writes a file as well
        done = subprocess.run(
            [sys.executable, "-c", words, modules, *arguments],
            capture_output=True,
            text=True,
            check=False,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (16, 16)),
        )
    assert done.returncode not in {0, 130}
    lines = [line for line in done.stderr.splitlines() if line]
    assert len(lines) == 1, done.stderr
    assert "could not be written: File too large; make room" in lines[0]
    assert drove_nothing(tmp_path)


def test_a_disk_that_fills_up_loses_no_drive(
    campaign: Write, say: Say, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from basu.campaigns import drive_table  # noqa: PLC0415 - patched here alone

    write, rows = drive_table.Journal._write, list[int]()

    def fill_up(journal: drive_table.Journal, line: bytes) -> None:
        rows.append(1)
        if len(rows) == 20:
            raise OSError(28, "No space left on device")
        write(journal, line)

    monkeypatch.setattr(drive_table.Journal, "_write", fill_up)
    file = campaign()
    assert "No space left on device; make room and go on with --resume" in say(file)
    folder = tmp_path / "campaigns" / "crossings"
    assert read_drives(folder).num_rows == 19
    assert main(["campaign", "run", str(file), "--output", str(tmp_path / "campaigns"), "--resume"]) == 0
    assert read_drives(folder)["number"].to_pylist() == list(range(60))
