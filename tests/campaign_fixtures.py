"""Fixtures: a campaign of cases, and a player that computes rows from jobs instead of driving."""

import contextlib
import functools
import os
import textwrap
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest

from basu.agents.process.remote_agent import find_agent
from basu.campaigns import command, planning
from basu.jobs.job import PlayerAnswer, PlayerSpec, Ready, versions

PLAYER = """
import contextlib, io, json, math, os, signal, tarfile, time
from pathlib import Path
from basu.jobs.job import JobOutcome, PlayerSpec
from basu.metrics.result import Result
from basu.metrics.score import Scores
from basu.metrics.success import Success
from basu.outcome import Outcome, Status
from basu.running.drive import DriveDone

def spec(settings):
    return PlayerSpec(f"{__name__}:open_player", ())

@contextlib.contextmanager
def open_player():
    yield play

def tar():
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w") as packed:
        info = tarfile.TarInfo("result.json")
        info.size = 2
        packed.addfile(info, io.BytesIO(b"{}"))
    return buffer.getvalue()

def play(job):
    share = int(job["id"][:8], 16) / 16**8
    if os.environ.get("DEADLY", "none") in job["identity"]:
        os.kill(os.getpid(), signal.SIGKILL)
    time.sleep(2.0 * share * float(os.environ.get("DRIVE_S", "0")))
    success = share > (0.5 if job["agent_name"] == "blind" else 0.1)
    if "DISC" in os.environ:  # failures in a circle of two parameters, larger for the blind agent
        ends = json.loads(os.environ["DISC"])
        shares = [(job["parameters"][name] - low) / (high - low) for name, (low, high) in ends.items()]
        away = math.hypot(shares[0] - 0.4, shares[1] - 0.55)
        success = away > (0.35 if job["agent_name"] == "blind" else 0.25)
        share = 1.0 / (1.0 + away)
    margins = {"distance_m": 1.0 / max(share, 1e-6) - 1.0, "ttc_s": None, "pet_s": None}  # 1/(1 + margin) is the share
    case = {
        "verdict": "SUCCESS" if success else "FAILURE", "fault": "none", "message": "computed",
        "assessment": {"completed": {"holds": True}},
        "collisions": [] if success else [{"speed_mps": 6.0}], "scenario": "PedestrianCrossing", "group": "pedestrian",
        "pre_crash": [], "characteristics": {"partner": "walker"}, "margins": margins, "simulated_s": 20.0,
        "wall_s": 1.0,
    }
    result = Result(
        outcome=Outcome(Status.SCENARIO_ENDED, "computed"), scores=Scores(share, 1.0, share), infractions=(),
        metrics={"passengers": {"comfort": {"score": share / 2.0}}}, scoring={}, meta={}, case=case,
        success=Success(success),
    )
    cost = {
        "wall_s": time.perf_counter(), "cpu_s": 1.0, "memory_mb": 500.0, "records_bytes": 1000, "host": "here",
        "worker": os.getpid(),
    }
    packed = tar() if not success or share > job["bar"] else None
    return JobOutcome(DriveDone(None, result, packed=packed, cost=cost))
"""

CAMPAIGN = """
name = "crossings"
agents = ["basic", "blind"]
seeds = {number = 3}

[[drives]]
cases = ["pedestrian_crossing_1"]
sweep = 10
vary = ["ahead", "speed"]

[keep]
failures = 3
narrowest = 2
sample = 0.0

[work]
block = 8
"""


@pytest.fixture
def modules(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """The name of a module with the player, which this process and others can import."""
    folder, name = tmp_path / "modules", f"fake_drives_{tmp_path.name}"
    folder.mkdir()
    (folder / f"{name}.py").write_text(PLAYER, encoding="utf-8")
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(folder), os.environ.get("PYTHONPATH", "")]))
    return name


@pytest.fixture
def campaign(tmp_path: Path) -> Callable[..., Path]:
    """A function that writes a campaign's file: the usual one, with replaced text."""

    def write(*replaced: tuple[str, str], more: str = "") -> Path:
        text = CAMPAIGN
        for before, after in replaced:
            assert before in text
            text = text.replace(before, after)
        path = tmp_path / "campaign.toml"
        path.write_text(textwrap.dedent(text) + more, encoding="utf-8")
        return path

    return write


class _Worker:
    """A worker that plays in this process when its answer is wanted."""

    def __init__(self, spec: PlayerSpec) -> None:
        self._stack = contextlib.ExitStack()
        self._play = self._stack.enter_context(spec.open())
        self.owed: Callable[[], PlayerAnswer] | None = lambda: Ready(versions())

    def give(self, data: Any) -> None:
        self.owed = lambda: self._play(data)

    def end(self, *, at_once: bool) -> None:
        self._stack.close()


class _Here:
    """A backend without processes: a campaign takes a tenth of the processor time."""

    def __init__(self, spec: PlayerSpec) -> None:
        self._spec = spec

    def start(self) -> _Worker:
        return _Worker(self._spec)

    def answers(self, workers: Sequence[_Worker], timeout_s: float) -> list[tuple[_Worker, PlayerAnswer]]:
        found = []
        for worker in workers:
            if worker.owed is not None:
                owed, worker.owed = worker.owed, None
                found.append((worker, owed()))
        return found

    def close(self) -> None:
        """Nothing is held."""


_found_once = functools.cache(find_agent)


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> None:
    """Campaigns of this test are driven in this process, and each agent is loaded once in the whole run."""
    monkeypatch.setattr(command, "Processes", _Here)
    monkeypatch.setattr(planning, "find_agent", _found_once)
