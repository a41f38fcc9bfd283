"""Claims about the services of a comparison: a kill loses nothing that was driven, and other conditions are refused."""

import dataclasses
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from basu.errors import UserError
from basu.jobs.job import JobOutcome, PlayerSpec
from basu.metrics.result import judge
from basu.metrics.scoring import Scoring
from basu.options.run import RunOptions
from basu.outcome import Outcome, Status
from basu.output.report.documents import make_draft, write_json
from basu.running.drive import DriveDone
from basu_service import service_batch
from basu_service.running import ServiceConditions, ServiceJob
from basu_service.service_batch import ServiceBatch, Side, drive_all

DRIVEN: list[str] = []
FAILS: dict[str, Status] = {}


class KilledError(BaseException):
    """Ends a command as SIGKILL would, but for the folders that are left."""


@contextmanager
def open_fake() -> Iterator[Any]:
    """A player that leaves a folder with a result, and dies at the service that `FAILS` names."""

    def play(job: ServiceJob) -> JobOutcome:
        key = f"{job.agent} {job.seed}"
        draft = make_draft(job.output, job.name)
        if FAILS.get(key) is Status.INTERRUPTED:
            raise KilledError
        result = judge(Outcome(FAILS.get(key, Status.STOPPED), "played"), None)
        write_json(draft / "result.json", {"status": result.outcome.status.value})
        DRIVEN.append(key)
        return JobOutcome(DriveDone(draft, result))

    yield play


@pytest.fixture
def drive(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Drive the services of two agents with the fake player; the conditions and whether they go on."""
    DRIVEN.clear()
    FAILS.clear()
    monkeypatch.setattr(service_batch, "service_player", lambda *_: PlayerSpec(f"{__name__}:open_fake"))

    def finished(batch: ServiceBatch, _but: object = ()) -> Iterator[tuple[int, Any]]:
        for number in range(4):
            folder = batch.folder / batch.name(number)
            if (folder / "result.json").exists():
                status = Status((folder / "result.json").read_text().split('"')[3])
                yield number, dataclasses.replace(judge(Outcome(status, "played"), None))

    monkeypatch.setattr(ServiceBatch, "finished", finished)

    def run(given: dict[str, Any], *, resume: bool) -> None:
        batch = ServiceBatch(tmp_path / "compare", [Side("a", "one"), Side("b", "two")], [1, 2])
        drive_all(batch, RunOptions(), ServiceConditions(), Scoring(), given, resume=resume, say=lambda _: None)

    return run


def test_after_a_kill_the_same_command_drives_the_rest_only(drive: Any, tmp_path: Path) -> None:
    FAILS["one 2"] = Status.INTERRUPTED
    with pytest.raises(KilledError):
        drive({"minutes": 1.0}, resume=False)
    assert DRIVEN == ["one 1", "two 1"]
    assert list((tmp_path / "compare" / "a-one").glob(".*.part")) != []
    del FAILS["one 2"]
    drive({"minutes": 1.0}, resume=True)
    assert DRIVEN == ["one 1", "two 1", "one 2", "two 2"]
    assert sorted(path.name for path in (tmp_path / "compare").glob("*/*")) == ["seed-0001"] * 2 + ["seed-0002"] * 2


def test_a_service_that_the_simulator_ended_is_set_aside_and_driven_again(
    drive: Any,
    tmp_path: Path,
) -> None:
    FAILS["two 1"] = Status.SIMULATOR_FAILED
    with pytest.raises(UserError, match=r"1 services could not be driven, the first \(two, seed 1\): played"):
        drive({}, resume=False)
    FAILS.clear()
    drive({}, resume=True)
    assert DRIVEN[4:] == ["two 1"]
    assert (tmp_path / "compare" / "b-two" / "seed-0001-SimulatorFailed").is_dir()


@pytest.mark.parametrize(
    ("given", "resume", "says"),
    [
        ({"minutes": 1.0}, False, "holds a comparison already; add --resume"),
        ({"minutes": 2.0}, True, r"was begun differently: minutes was 1\.0 and is 2\.0"),
    ],
)
def test_a_folder_holds_one_comparison(drive: Any, given: dict[str, Any], *, resume: bool, says: str) -> None:
    drive({"minutes": 1.0}, resume=False)
    with pytest.raises(UserError, match=says):
        drive(given, resume=resume)


def test_nothing_is_there_to_go_on_with(drive: Any) -> None:
    with pytest.raises(UserError, match="there is no comparison"):
        drive({}, resume=True)
