"""Who works beside each other, and what becomes of those who die."""

from pathlib import Path

import pytest

from basu.running.scenario_runs import crew
from basu.running.scenario_runs.crew import Crew
from basu.running.scenario_runs.options import ScenarioOptions
from basu.running.scenario_runs.worker import Job


def stillborn(*_arguments: object) -> None:
    raise SystemExit(3)


def test_workers_that_do_not_come_into_being_end_the_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(crew, "work", stillborn)
    workers = Crew(ScenarioOptions(), tmp_path, [Job(number, "basic", "some_case") for number in range(50)])
    with pytest.raises(RuntimeError, match="did not come into being"):
        list(workers.play())
    workers.end()
