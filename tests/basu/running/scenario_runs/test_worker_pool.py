"""Claims about the pool of workers: a worker that cannot start ends the run."""

import sys
from pathlib import Path

import pytest

from basu.running.scenario_runs import worker_pool
from basu.running.scenario_runs.options import ScenarioOptions
from basu.running.scenario_runs.worker_pool import Job, WorkerPool


def test_workers_that_end_before_they_are_ready_end_the_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(worker_pool, "worker_command", lambda _fd: [sys.executable, "-c", "raise SystemExit(3)"])
    workers = WorkerPool(ScenarioOptions(), tmp_path, [Job(number, "basic", "some_case") for number in range(50)])
    with pytest.raises(RuntimeError, match="ended before it was ready"):
        list(workers.play())
    workers.end()
