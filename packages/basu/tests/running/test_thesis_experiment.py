"""Claims about driving the experiment: in a live simulator as far as it is short, and what ends it."""

import json
import signal
import subprocess
import sys
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from basu.cli import main
from basu.metrics.success import Success
from basu.options.run import RunOptions
from basu.outcome import Outcome, Status
from basu.output.report.documents import RunRecord
from basu.running import thesis_experiment
from basu.running.thesis_experiment import ExperimentCase
from fakes.run_records import crashing, record, written
from servers import RunningServer


@pytest.fixture(name="leaving")
def leaving_(monkeypatch: pytest.MonkeyPatch) -> Callable[[Callable[[str], RunRecord]], None]:
    """Replace the drives by ones that take no time, need no simulator and leave the given results."""

    def leaving(made: Callable[[str], RunRecord]) -> None:
        def drive(case: ExperimentCase, options: RunOptions, *_: object) -> Path:
            return written(options.output / case.row, made(case.agent))

        monkeypatch.setattr(thesis_experiment, "_drive", drive)
        monkeypatch.setattr(thesis_experiment, "simulator_for", lambda _: nullcontext(SimpleNamespace()))

    return leaving


def test_all_four_are_driven_and_stand_beside_the_thesis(
    tmp_path: Path, leaving: Callable[[Callable[[str], RunRecord]], None], capsys: pytest.CaptureFixture[str]
) -> None:
    leaving(lambda agent: record(crashing(), agent=agent))
    assert main(["experiment", "thesis", "--output", str(tmp_path)]) == 0
    told = capsys.readouterr().out
    assert "0.13 does not follow from one collision and one speeding" in told
    assert "wall time" in told
    (folder,) = tmp_path.glob("experiment-thesis-*")
    assert {path.name for path in folder.iterdir()} == {
        "basic", "behavioral", "forward", "human", "compare.html", "compare.png", "experiment.json",
    }  # fmt: skip
    assert "Beside table 5.1" in (folder / "compare.html").read_text()


@pytest.mark.parametrize(("status", "code"), [("SetupFailed", 2), ("SimulatorFailed", 3), ("Interrupted", 130)])
def test_a_drive_that_is_none_ends_it_with_its_own_exit_code(
    tmp_path: Path, leaving: Callable[[Callable[[str], RunRecord]], None], status: str, code: int
) -> None:
    def failed(agent: str) -> RunRecord:
        run = record(None, agent=agent)
        return replace(run, result=replace(run.result, outcome=Outcome(Status(status), "so it ended")))

    leaving(failed)
    assert main(["experiment", "thesis", "--output", str(tmp_path)]) == code


def test_it_goes_on_with_the_drives_that_are_missing(
    tmp_path: Path, leaving: Callable[[Callable[[str], RunRecord]], None], capsys: pytest.CaptureFixture[str]
) -> None:
    driven: list[str] = []

    def third_is_interrupted(agent: str) -> RunRecord:
        driven.append(agent)
        run = record(crashing(), agent=agent)
        ended = Outcome(Status.INTERRUPTED, "by the user")
        result = replace(run.result, outcome=ended, success=Success(None))
        return replace(run, result=result) if len(driven) == 3 else run

    leaving(third_is_interrupted)
    assert main(["experiment", "thesis", "--output", str(tmp_path)]) == 130
    (folder,) = tmp_path.glob("experiment-thesis-*")
    assert main(["experiment", "thesis", "--resume", str(folder), "--seed", "1"]) == 2
    assert "was begun differently: --seed was 0 and is 1" in capsys.readouterr().err
    assert main(["experiment", "thesis", "--resume", str(folder)]) == 0
    assert driven == ["basic", "deviating", "forward", "forward", "human"]
    assert {path.name for path in folder.iterdir() if path.is_dir()} == {
        "basic", "behavioral", "forward", "forward-Interrupted", "human",
    }  # fmt: skip
    assert main(["experiment", "thesis", "--resume", str(tmp_path)]) == 2
    assert "is no folder of an experiment that can go on" in capsys.readouterr().err


KILLED_AT_THIRD = """
import json, os, signal, sys
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace

sys.path[:] = json.loads(sys.argv[1])
from basu.cli import main
from basu.running import thesis_experiment
from fakes.run_records import crashing, record, written

told, *words = sys.argv[2:]

def drive(case, options, *_):
    with open(told, "a") as file:
        file.write(case.agent + "\\n")
    if Path(told).read_text().count("\\n") == 3:
        (Path(options.output) / case.row).mkdir()  # as far as the third drive came
        os.kill(os.getpid(), signal.SIGKILL)
    return written(Path(options.output) / case.row, record(crashing(), agent=case.agent))

thesis_experiment._drive = drive
thesis_experiment.simulator_for = lambda _: nullcontext(SimpleNamespace())
sys.exit(main(["experiment", "thesis", *words]))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL")
def test_it_goes_on_after_sigkill(tmp_path: Path) -> None:
    told, output = tmp_path / "driven", tmp_path / "runs"

    def experiment(*words: str) -> int:
        arguments = [json.dumps(sys.path), str(told), *words]
        return subprocess.run([sys.executable, "-c", KILLED_AT_THIRD, *arguments], check=False).returncode

    assert experiment("--output", str(output)) == -signal.SIGKILL
    (folder,) = output.glob("experiment-thesis-*")
    assert experiment("--resume", str(folder)) == 0
    assert told.read_text().split() == ["basic", "deviating", "forward", "forward", "human"]
    assert {"basic", "behavioral", "forward", "human", "experiment.json"} <= {path.name for path in folder.iterdir()}


def test_it_drives_in_a_simulator_that_runs_already(
    simulator: RunningServer,
    route_file: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(thesis_experiment, "CASES", thesis_experiment.CASES[:1])
    monkeypatch.setattr(thesis_experiment, "ROUTE", str(route_file))
    address = ["--host", "127.0.0.1", "--port", str(simulator.port)]
    assert main(["experiment", "thesis", *address, "--output", str(tmp_path)]) == 0
    assert "basic  here" in capsys.readouterr().out
