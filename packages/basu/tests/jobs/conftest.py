"""Fixtures: a module with a player that does what its jobs say."""

import os
from pathlib import Path

import pytest

PLAYER = """
import contextlib, os, signal, time
from pathlib import Path
from basu.errors import UserError
from basu.jobs.job import After, JobOutcome

@contextlib.contextmanager
def open_player(opening="ready"):
    if opening == "refuse":
        raise UserError("there is no such agent")
    yield play

def play(data):
    word, argument = data
    if word == "die":
        os.kill(os.getpid(), signal.SIGKILL)
    if word == "die-once" and not Path(argument).exists():
        Path(argument).touch()
        os.kill(os.getpid(), signal.SIGKILL)
    if word == "raise":
        raise ValueError("a bug of ours")
    if word == "hang":
        time.sleep(600.0)
    if word == "fresh":
        return JobOutcome(os.getpid(), After.FRESH)
    if word == "again":
        return JobOutcome(os.getpid(), After.AGAIN)
    if word == "pid":
        Path(argument).write_text(str(os.getpid()))
    return JobOutcome((word, argument, os.getpid()))
"""


@pytest.fixture
def player(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """The target of the player, which this process and workers can import."""
    folder = tmp_path / "modules"
    folder.mkdir()
    name = f"fake_player_{tmp_path.name}"
    (folder / f"{name}.py").write_text(PLAYER, encoding="utf-8")
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(folder), os.environ.get("PYTHONPATH", "")]))
    return f"{name}:open_player"
