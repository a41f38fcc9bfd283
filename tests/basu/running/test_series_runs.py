"""Claims about a series of whole runs: killed, ended and out of room, it comes to what it would have come to."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

RUNS = 6
AGENT = """
import os, pathlib, resource, signal

class Short(AutonomousAgent):
    def setup(self):
        attempts = pathlib.Path(os.environ["ATTEMPTS"])
        self.attempt, self.steps = len(list(attempts.iterdir())) + 1, 0
        (attempts / str(self.attempt)).touch()

    def run_step(self, sensor_data):
        self.steps += 1
        if self.steps == 10 and self.attempt == 2:
            os.kill(os.getpid(), signal.SIGKILL)
        if self.steps == 10 and self.attempt == 4:
            signal.raise_signal(signal.SIGTERM)
        if self.steps == 10 and self.attempt == 6:
            resource.setrlimit(resource.RLIMIT_FSIZE, (3000, 3000))  # as good as a full disk
        if self.steps > 20:
            raise ValueError("that was the run")
        return carla.VehicleControl(throttle=0.5)

    def config(self):
        return {}
"""


@pytest.mark.slow
@pytest.mark.timeout(900)
@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL, and no limit on the size of files")
def test_runs_broken_off_three_times_are_all_there_and_counted_once(tmp_path: Path, route_file: Path) -> None:
    agent, attempts, output = tmp_path / "short.py", tmp_path / "attempts", tmp_path / "runs"
    agent.write_text(AGENT)
    attempts.mkdir()

    def basu(*options: str) -> "subprocess.CompletedProcess[str]":
        # in the benchmark's own process, which is to die and to run out of disk
        series = [
            "--in-process",
            "--routes",
            str(route_file),
            "--repetitions",
            str(RUNS),
            "--series",
            "s",
            "--output",
            str(output),
        ]
        program = f"import sys; from basu.cli import main; sys.exit(main({['run', str(agent), *series, *options]!r}))"
        environment = {**os.environ, "ATTEMPTS": str(attempts)}
        return subprocess.run(
            [sys.executable, "-c", program], capture_output=True, text=True, check=False, env=environment
        )

    ends = [basu(), *(basu("--resume") for _ in range(3))]
    assert [end.returncode for end in ends] == [-9, 130, 2, 1], ends[-1].stderr
    assert "could not be written: File too large" in ends[2].stderr
    folder = output / "s"
    document = json.loads((folder / "series.json").read_text())
    assert [each["number"] for each in document["runs"]] == list(range(RUNS))
    assert document["totals"]["statuses"] == {"AgentCrashed": RUNS}
    assert [each["status"] for each in document["set_aside"]] == ["Interrupted"]
    assert len(list(attempts.iterdir())) == RUNS + 3
    whole = [folder / each["folder"] for each in document["runs"]]
    names = {each.name for each in whole} | {each["folder"] for each in document["set_aside"]}
    assert {path.name for path in folder.iterdir()} == names | {"series.json", "series.txt"}
    assert len({(each / "history.parquet").read_bytes() for each in whole}) == 1  # each as if it had been the first
    assert f"series s: {RUNS} of {RUNS} runs done" in ends[-1].stdout
