"""Claims about the engine of jobs: every job is answered once, whatever happens to workers."""

import os
import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from basu.errors import UserError
from basu.jobs import processes
from basu.jobs.job import Done, Job, Lost, PlayerAnswer, PlayerSpec, Ready
from basu.jobs.playing import play_here, play_jobs
from basu.jobs.pool import Pool
from basu.jobs.processes import Processes

pytestmark = pytest.mark.measured_processes


@contextmanager
def pool_of(player: str, workers: int = 2, *arguments: str, **limits: Any) -> Iterator[Pool]:
    pool = Pool(Processes(PlayerSpec(player, arguments)), workers, **limits)
    try:
        yield pool
    finally:
        pool.close()


def jobs_of(*words: str, argument: str = "") -> list[Job]:
    return [Job(number, (word, argument)) for number, word in enumerate(words)]


def test_every_job_is_answered_once_by_workers_that_stay(player: str) -> None:
    with pool_of(player) as pool:
        answers = list(pool.play(jobs_of(*["ok"] * 30)))
    assert sorted(answer.number for answer in answers) == list(range(30))
    assert all(isinstance(answer, Done) and answer.attempts == 1 for answer in answers)
    assert len({answer.value[2] for answer in answers}) <= 2


def test_a_job_that_kills_its_worker_three_times_is_lost_and_costs_no_other(player: str) -> None:
    with pool_of(player) as pool:
        answers = {answer.number: answer for answer in pool.play(jobs_of("ok", "die", "ok", "ok"))}
    assert sorted(answers) == [0, 1, 2, 3]
    lost = answers.pop(1)
    assert isinstance(lost, Lost)
    assert lost.attempts == 3
    assert "died 3 times" in lost.sentence
    assert all(isinstance(answer, Done) for answer in answers.values())


def test_a_job_is_tried_again_after_the_death_of_its_worker(player: str, tmp_path: Path) -> None:
    with pool_of(player) as pool:
        (answer,) = pool.play([Job(0, ("die-once", str(tmp_path / "died")))])
    assert isinstance(answer, Done)
    assert answer.attempts == 2


def test_a_job_that_hangs_is_ended_at_its_limit(player: str) -> None:
    with pool_of(player, 1, attempts=1, job_limit_s=0.2) as pool:
        (answer,) = pool.play(jobs_of("hang"))
    assert isinstance(answer, Lost)
    assert "after 0.2 s over one job" in answer.sentence


def test_an_exception_in_a_player_is_named(player: str, capfd: pytest.CaptureFixture[str]) -> None:
    with pool_of(player, 1, attempts=1) as pool:
        (answer,) = pool.play(jobs_of("raise"))
    assert isinstance(answer, Lost)
    assert "ValueError: a bug of ours" in answer.sentence
    assert "Traceback" in capfd.readouterr().err


def test_a_job_that_wants_another_attempt_gets_it_in_a_fresh_worker(player: str) -> None:
    with pool_of(player, 1) as pool:
        first, second = pool.play(jobs_of("again", "fresh"))
    assert isinstance(first, Done)
    assert isinstance(second, Done)
    assert {first.attempts, second.attempts} == {1, 3}
    assert first.value != second.value


def test_a_worker_that_is_killed_from_outside_loses_nothing(player: str, tmp_path: Path) -> None:
    told = tmp_path / "pid"
    words = [Job(n, ("pid", str(told))) for n in range(40)]
    killed: set[int] = set()
    answers = []
    with pool_of(player) as pool:
        for answer in pool.play(words):
            answers.append(answer)
            pid = int(told.read_text() or 0)
            if len(killed) < 2 and pid and pid not in killed:
                killed.add(pid)
                os.kill(pid, signal.SIGKILL)
    assert len(killed) == 2
    assert sorted(answer.number for answer in answers) == list(range(40))
    assert all(isinstance(answer, Done) for answer in answers)


def test_jobs_are_taken_as_workers_become_free(player: str) -> None:
    taken = []

    def jobs() -> Iterator[Job]:
        for number in range(20):
            taken.append(number)
            yield Job(number, ("ok", ""))

    with pool_of(player) as pool:
        playing = pool.play(jobs())
        next(playing)
        assert len(taken) <= 5
        assert len(list(playing)) == 19


def test_a_worker_that_cannot_work_says_why(player: str) -> None:
    with pool_of(player, 2, "refuse") as pool, pytest.raises(UserError, match="there is no such agent"):
        list(pool.play(jobs_of("ok")))


def test_workers_that_end_before_they_are_ready_end_the_run(player: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(processes, "worker_command", lambda *_: [sys.executable, "-c", "raise SystemExit(3)"])
    with pool_of(player) as pool, pytest.raises(RuntimeError, match="ended before it was ready"):
        list(pool.play(jobs_of(*["ok"] * 50)))


class OtherVersions:
    """A backend with a worker of another version."""

    def start(self) -> "OtherVersions":
        return self

    def answers(self, workers: Sequence[Any], timeout_s: float) -> list[tuple[Any, PlayerAnswer]]:
        return [(self, Ready({"basu": "0.0.1", "carla": "0.9.16", "python": "3.10"}))]

    def end(self, *, at_once: bool) -> None:
        pass

    def close(self) -> None:
        pass


def test_a_worker_of_another_version_is_refused() -> None:
    pool = Pool(OtherVersions(), 1)
    with pytest.raises(UserError, match=r"a worker has basu 0\.0\.1, and this command .*; install the same versions"):
        list(pool.play(jobs_of("ok")))


def test_one_process_plays_jobs_too(player: str) -> None:
    answers = list(play_here(PlayerSpec(player, ()), jobs_of("ok", "again", "fresh", "ok")))
    assert [answer.number for answer in answers] == [0, 1, 2, 3]
    assert [answer.attempts for answer in answers] == [1, 3, 1, 1]


@pytest.mark.parametrize("workers", [1, 2])
def test_jobs_are_played_in_this_process_unless_several_workers_are_wanted(player: str, workers: int) -> None:
    answers = list(play_jobs(PlayerSpec(player), jobs_of(*["ok"] * 6), workers))
    assert sorted(answer.number for answer in answers) == list(range(6))
    assert all(isinstance(answer, Done) for answer in answers)
    is_here = {answer.value[2] == os.getpid() for answer in answers if isinstance(answer, Done)}
    assert is_here == {workers == 1}


def test_a_single_job_needs_no_worker(player: str) -> None:
    (answer,) = play_jobs(PlayerSpec(player), jobs_of("ok"), 4)
    assert isinstance(answer, Done)
    assert answer.value[2] == os.getpid()
