"""Claims about runs without a series that are killed: the same command with ``--resume`` goes on with them."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from basu.errors import UserError
from basu.metrics.result import Result
from basu.output.report.documents import make_draft
from basu.running.drive import DriveDone, not_begun
from basu.running.folder_lock import locked
from basu.running.single_runs import SingleRuns, open_runs
from basu.simulator import connect
from basu_fixtures import BASU
from fakes.results import a_result
from servers import RunningServer

GIVEN = {"the agent": "basic", "--seed": 0}
NAMES = {0: "one", 1: "two"}


def finished(runs: SingleRuns, number: int) -> DriveDone:
    """A run that is written and not yet in its place."""
    assert runs.drafts is not None
    draft, document = make_draft(runs.drafts, runs.name(number)), a_result()
    (draft / "result.json").write_text(json.dumps(document))
    return DriveDone(draft, Result.from_document(document), number=number)


def test_runs_that_are_done_are_not_driven_again_and_drafts_are_thrown_away(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="killed"), open_runs(tmp_path, GIVEN, NAMES, resume=False) as runs:  # noqa: PT012
        assert isinstance(runs, SingleRuns)
        assert runs.publish(finished(runs, 0)).folder == tmp_path / "one"
        draft = finished(runs, 1).folder
        raise OSError("killed")
    assert draft is not None
    assert draft.exists()
    with open_runs(tmp_path, GIVEN, {0: "later", 1: "later"}, resume=True) as runs:
        assert runs.done == {0}
        assert not draft.exists()
        assert isinstance(runs, SingleRuns)
        assert runs.publish(finished(runs, 1)).folder == tmp_path / "two"
    assert {path.name for path in tmp_path.iterdir()} == {"one", "two"}


def test_nothing_is_left_of_runs_of_which_none_was_driven(tmp_path: Path) -> None:
    with open_runs(tmp_path / "runs", GIVEN, NAMES, resume=False) as runs:
        assert runs.publish(not_begun(Result.from_document(a_result()).outcome)).folder is None
    assert list(tmp_path.iterdir()) == []


def test_other_options_have_nothing_to_go_on_with(tmp_path: Path) -> None:
    with open_runs(tmp_path, GIVEN, NAMES, resume=False) as runs:
        assert isinstance(runs, SingleRuns)
        runs.publish(finished(runs, 0))
    with (
        pytest.raises(UserError, match=r"nothing in .* was begun with these options and is unfinished"),
        open_runs(tmp_path, {**GIVEN, "--seed": 1}, NAMES, resume=True),
    ):
        pass
    with open_runs(tmp_path, GIVEN, NAMES, resume=True) as runs:
        assert runs.done == {0}


def test_a_second_command_that_is_the_same_drives_and_is_not_resumed(tmp_path: Path) -> None:
    with open_runs(tmp_path, GIVEN, NAMES, resume=False):
        with open_runs(tmp_path, GIVEN, NAMES, resume=False) as second:
            assert second.drafts is None
        with pytest.raises(UserError, match="another command drives"), open_runs(tmp_path, GIVEN, NAMES, resume=True):
            pass


def test_a_lock_leaves_no_file(tmp_path: Path) -> None:
    with (
        locked(tmp_path / "a" / "b"),
        pytest.raises(UserError, match="another command drives"),
        locked(tmp_path / "a" / "b"),
    ):
        pass
    assert list(tmp_path.iterdir()) == []


AGENT = """
import os, pathlib, signal

class Short(AutonomousAgent):
    def setup(self):
        attempts = pathlib.Path(os.environ["ATTEMPTS"])
        self.attempt, self.steps = len(list(attempts.iterdir())) + 1, 0
        (attempts / str(self.attempt)).touch()

    def run_step(self, sensor_data):
        self.steps += 1
        if self.steps == 5 and self.attempt == int(os.environ["KILLED"]):
            os.kill(os.getpid(), signal.SIGKILL)
        if self.steps > 10:
            raise ValueError("that was the run")
        return carla.VehicleControl(throttle=0.5)

    def config(self):
        return {}
"""


Basu = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture
def basu(simulator: RunningServer, tmp_path: Path, route_file: Path) -> Basu:
    """``basu run`` in a process of its own at the shared simulator; the agent kills it in its attempt ``killed``."""
    agent, attempts = tmp_path / "short.py", tmp_path / "attempts"
    agent.write_text(AGENT)
    attempts.mkdir()

    def run(*options: str, killed: int = 0) -> "subprocess.CompletedProcess[str]":
        connect("127.0.0.1", simulator.port, 20.0).reload_world()  # a killed benchmark leaves its vehicle there
        words = ["run", str(agent), "--in-process", "--host", "127.0.0.1", "--port", str(simulator.port)]
        words += ["--routes", str(route_file), "--output", str(tmp_path / "runs"), *options]
        environment = {**os.environ, "ATTEMPTS": str(attempts), "KILLED": str(killed)}
        return subprocess.run([*BASU, *words], capture_output=True, text=True, check=False, env=environment)

    return run


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL")
@pytest.mark.parametrize(("repetitions", "attempts"), [(1, 2), (3, 4)])
def test_a_command_that_is_killed_goes_on(basu: Basu, tmp_path: Path, repetitions: int, attempts: int) -> None:
    again = ("--repetitions", str(repetitions))
    assert basu(*again, killed=min(2, repetitions)).returncode == -9
    assert basu(*again, "--seed", "7", "--resume").returncode == 2
    end = basu(*again, "--resume")
    assert end.returncode == 1, end.stderr
    assert f"run {repetitions} of {repetitions}" in end.stdout
    assert len(list((tmp_path / "attempts").iterdir())) == attempts
    folders = sorted(path for path in (tmp_path / "runs").iterdir() if path.name != "latest")
    assert len(folders) == repetitions
    seeds = sorted(json.loads((folder / "result.json").read_text())["meta"]["seed"] for folder in folders)
    assert seeds == list(range(repetitions))
