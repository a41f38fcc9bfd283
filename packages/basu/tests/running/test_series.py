"""Tests of ``basu.running.series``."""

import errno
import json
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from basu.errors import UserError
from basu.metrics.result import Result
from basu.metrics.scoring import Scoring
from basu.options.run import RunOptions
from basu.outcome import Status
from basu.output.report.documents import make_draft, publish
from basu.routing.route_file import RouteDescription
from basu.running.drive import DriveDone
from basu.running.preparation import RequestedRun
from basu.running.series import RESOLVED, Series, conditions, open_series
from basu.settings.option import fields_of
from basu.simulator import connect
from basu_fixtures import BASU
from fakes.results import a_result
from servers import RunningServer

ROUTE = RouteDescription(id="0", town="Linden", points=(), stops=(), source="r.xml")
JOBS = tuple(RequestedRun(number, ROUTE, "r", number, number) for number in range(4))
GIVEN = {"the agent": "basic", "--seed": 0, "the routes": ("0",)}


def opened(folder: Path, *, resume: bool = False, given: dict[str, Any] | None = None) -> Series:
    return open_series(folder, given or GIVEN, JOBS, "basic", resume=resume)


def finished(series: Series, job: RequestedRun, status: Status = Status.COMPLETED, *, safe: bool = False) -> DriveDone:
    """A run that is written and not yet in its place."""
    draft, document = make_draft(series.folder, series.name(job.number)), a_result(status, safe=safe)
    (draft / "result.json").write_text(json.dumps(document))
    return DriveDone(draft, Result.from_document(document), number=job.number)


def run(series: Series, job: RequestedRun, status: Status = Status.COMPLETED, *, safe: bool = False) -> Path:
    folder = series.publish(finished(series, job, status, safe=safe)).folder
    assert folder is not None
    return folder


def listed(folder: Path) -> dict[str, Any]:
    document: dict[str, Any] = json.loads((folder / "series.json").read_text())
    return document


def test_the_list_and_the_totals_are_whole_after_every_run(tmp_path: Path) -> None:
    series = opened(tmp_path / "s")
    assert listed(series.folder)["totals"]["done"] == 0
    for job in JOBS:
        folder = run(series, job)
        document = listed(series.folder)
        assert [each["folder"] for each in document["runs"]][-1] == folder.name
        assert (document["totals"]["done"], document["totals"]["planned"]) == (job.number + 1, 4)
    assert document["totals"]["infractions"]["collision_static"]["number"] == 4
    assert document["totals"]["scores"]["driving"]["mean"] == pytest.approx(a_result()["scores"]["driving"])
    assert document["totals"]["scores"]["driving"]["deviation"] == pytest.approx(0.0)
    assert (series.folder / "series.txt").read_text().startswith("series s: 4 of 4 runs done")


def test_a_series_goes_on_where_it_was_broken_off(tmp_path: Path) -> None:
    run(opened(tmp_path), JOBS[0])
    again = opened(tmp_path, resume=True)
    assert again.done == {0}
    run(again, JOBS[1])
    assert opened(tmp_path, resume=True).done == {0, 1}


def test_a_series_with_an_unused_option_of_an_earlier_version_goes_on(tmp_path: Path) -> None:
    run(opened(tmp_path, given={**GIVEN, "--sumo-sublane": False}), JOBS[0])
    assert opened(tmp_path, resume=True).done == {0}
    opened(tmp_path / "other", given={**GIVEN, "--sumo-sublane": True})
    with pytest.raises(UserError, match="--sumo-sublane was True and is None"):
        opened(tmp_path / "other", resume=True)


def test_half_a_run_is_thrown_away(tmp_path: Path) -> None:
    series = opened(tmp_path)
    finished(series, JOBS[0])  # killed here
    again = opened(tmp_path, resume=True)
    assert again.done == frozenset()
    assert list(tmp_path.glob(".*.part")) == []


def test_a_finished_run_that_is_not_yet_listed_is_taken_in_once(tmp_path: Path) -> None:
    series = opened(tmp_path)
    draft = finished(series, JOBS[2]).folder
    assert draft is not None
    publish(draft, series.name(JOBS[2].number))  # killed here
    for _ in range(2):
        assert opened(tmp_path, resume=True).done == {2}
    assert listed(tmp_path)["totals"]["done"] == 1


def test_a_full_disk_loses_no_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    series = opened(tmp_path)
    run(series, JOBS[0])
    second = finished(series, JOBS[1])

    def full(_descriptor: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        with pytest.raises(UserError, match=r"series\.json .* could not be written: No space left on device"):
            series.publish(second)
    assert listed(tmp_path)["totals"]["done"] == 1  # the old list, whole
    assert opened(tmp_path, resume=True).done == {0, 1}


@pytest.mark.parametrize("status", [Status.INTERRUPTED, Status.SIMULATOR_FAILED, Status.SETUP_FAILED])
def test_what_ended_for_no_fault_of_the_agents_is_set_aside_and_driven_again(tmp_path: Path, status: Status) -> None:
    series = opened(tmp_path)
    for _ in range(2):
        run(series, JOBS[0], status, safe=True)
    again = opened(tmp_path, resume=True)
    assert again.done == frozenset()
    assert [each["status"] for each in listed(tmp_path)["set_aside"]] == [status.value, status.value]
    run(again, JOBS[0])
    assert listed(tmp_path)["totals"]["statuses"] == {"Completed": 1}


@pytest.mark.parametrize("status", [Status.INTERRUPTED, Status.SIMULATOR_FAILED, Status.SETUP_FAILED])
def test_an_unsafe_record_is_a_failure_whatever_fault_follows_it(tmp_path: Path, status: Status) -> None:
    series = opened(tmp_path)
    run(series, JOBS[0], status)
    document = listed(tmp_path)
    assert document["set_aside"] == []
    assert [(each["status"], each["passed"]) for each in document["runs"]] == [(status.value, False)]
    assert document["totals"]["passed"] == {"passed": 0, "failed": 1, "not judged": 0}
    assert opened(tmp_path, resume=True).done == {0}
    run(series, JOBS[1], safe=True)
    assert "1 failed" in series.table()


@pytest.mark.parametrize("status", [Status.AGENT_CRASHED, Status.ROUTE_BLOCKED])
def test_an_agent_that_failed_has_had_its_run(tmp_path: Path, status: Status) -> None:
    run(opened(tmp_path), JOBS[0], status)
    again = opened(tmp_path, resume=True)
    assert again.done == {0}
    assert again.worst({}) == 1


def test_what_is_different_is_named_and_refused(tmp_path: Path) -> None:
    opened(tmp_path)
    with pytest.raises(UserError, match=r"begun differently: --seed was 0 and is 1; the agent was 'basic' and is 'x'"):
        opened(tmp_path, resume=True, given=GIVEN | {"--seed": 1, "the agent": "x"})
    opened(tmp_path, resume=True)


def plan(**agents: Any) -> Any:
    """What `conditions` reads of a plan without routes."""
    config = SimpleNamespace(vehicle="vehicle.easymile.ez10", weather="ClearNoon")
    return SimpleNamespace(
        agents=SimpleNamespace(config=config, **agents),
        loaded=SimpleNamespace(file=None),
        jobs=(),
        sensors=SimpleNamespace(specs=()),
    )


def test_every_declared_option_that_repeats_a_run_is_a_condition() -> None:
    found = conditions(RunOptions(), Scoring(), plan())
    declared = {
        field.flag
        for field in fields_of(RunOptions)
        if field.option.repeats and field.name not in RESOLVED and not field.option.is_rare
    }
    assert declared <= found.keys()
    assert {"--metrics", "--agent-memory", "--seed", "--vehicles"} <= declared
    assert not {"--output", "--watch", "--series"} & found.keys()


def test_a_file_among_the_conditions_counts_by_its_contents(tmp_path: Path) -> None:
    metric = tmp_path / "mine.py"
    metric.write_text("one = 1")
    before = conditions(RunOptions(metric_files=(metric,)), Scoring(), plan())
    metric.write_text("one = 2")
    after = conditions(RunOptions(metric_files=(metric,)), Scoring(), plan())
    assert {name for name in before if before[name] != after[name]} == {"--metrics"}


def test_a_series_is_not_begun_over_another(tmp_path: Path) -> None:
    run(opened(tmp_path), JOBS[0])
    with pytest.raises(UserError, match="holds a series already, 1 of 4 runs done; add --resume"):
        opened(tmp_path)


def test_there_has_to_be_a_series_to_go_on_with(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"there is no series in .* run without --resume"):
        opened(tmp_path / "nothing", resume=True)


def test_two_that_drive_one_series_count_each_run_once(tmp_path: Path) -> None:
    one, other = opened(tmp_path), opened(tmp_path, resume=True)
    run(one, JOBS[0])
    with pytest.raises(UserError, match="another command drives the series"):
        run(other, JOBS[0])
    assert opened(tmp_path, resume=True).done == {0}


def test_a_damaged_list_gets_a_sentence(tmp_path: Path) -> None:
    opened(tmp_path)
    (tmp_path / "series.json").write_text('{"schema_version": 1, "runs": 7}')
    with pytest.raises(UserError, match=r"series\.json: the document lacks 'options'"):
        opened(tmp_path, resume=True)


RUNS = 4
AGENT = """
import os, pathlib, resource, signal

class Short(AutonomousAgent):
    def setup(self):
        attempts = pathlib.Path(os.environ["ATTEMPTS"])
        self.attempt, self.steps = len(list(attempts.iterdir())) + 1, 0
        (attempts / str(self.attempt)).touch()

    def run_step(self, sensor_data):
        self.steps += 1
        if self.steps == 5 and self.attempt == 2:
            os.kill(os.getpid(), signal.SIGKILL)
        if self.steps == 5 and self.attempt == 3:
            signal.raise_signal(signal.SIGTERM)
        if self.steps == 5 and self.attempt == 4:
            resource.setrlimit(resource.RLIMIT_FSIZE, (3000, 3000))  # as good as a full disk
        if self.steps > 10:
            raise ValueError("that was the run")
        return carla.VehicleControl(throttle=0.5)

    def config(self):
        return {}
"""


@pytest.mark.slow
@pytest.mark.timeout(900)
@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL, and no limit on the size of files")
def test_runs_broken_off_three_times_are_all_there_and_counted_once(
    simulator: RunningServer, tmp_path: Path, route_file: Path
) -> None:
    agent, attempts, output = tmp_path / "short.py", tmp_path / "attempts", tmp_path / "runs"
    agent.write_text(AGENT)
    attempts.mkdir()

    def basu(*options: str) -> "subprocess.CompletedProcess[str]":
        connect("127.0.0.1", simulator.port, 20.0).reload_world()  # a killed benchmark leaves its vehicle there
        # in the benchmark's own process, which is to die and to run out of disk
        series = [
            "--in-process",
            "--host",
            "127.0.0.1",
            "--port",
            str(simulator.port),
            "--routes",
            str(route_file),
            "--repetitions",
            str(RUNS),
            "--series",
            "s",
            "--output",
            str(output),
        ]
        environment = {**os.environ, "ATTEMPTS": str(attempts)}
        return subprocess.run(
            [*BASU, "run", str(agent), *series, *options], capture_output=True, text=True, check=False, env=environment
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
