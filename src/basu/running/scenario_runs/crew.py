"""Several workers beside each other: each gets the next job when it is done with one, whoever dies is replaced."""

from __future__ import annotations

import multiprocessing
from collections import deque
from multiprocessing.connection import wait
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.errors import SimulatorError
from basu.running.scenario_runs.worker import Done, Job, Ready, Refused, work

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from basu.running.scenario_runs.options import ScenarioOptions

ATTEMPTS = 2  # at a job whose worker died
GOING_S = 10.0  # for a worker to end by itself


class Lost(NamedTuple):
    """A job that no worker lived through."""

    number: int
    sentence: str


class _Worker:
    """A process with its pipe and what it does."""

    def __init__(self, options: ScenarioOptions, output: Path) -> None:
        context = multiprocessing.get_context("spawn")  # a forked copy of the client's threads would not run
        self.connection, theirs = context.Pipe()
        self.process = context.Process(target=work, args=(theirs, options, output), daemon=True)
        self.process.start()
        theirs.close()
        self.job: Job | None = None
        self.is_ready = False

    def give(self, job: Job | None) -> None:
        """The next job, or None: no more."""
        self.job = job
        try:
            self.connection.send(job)
        except OSError:
            return  # it is gone, which is seen at its pipe

    def says(self) -> Done | Ready | None:
        """What it says; None where it is gone.

        Raises:
            SimulatorError: it cannot work.
            RuntimeError: it was gone before it had come into being.
        """
        try:
            answer: Done | Ready | Refused = self.connection.recv()
        except (EOFError, OSError):
            if not self.is_ready:
                raise RuntimeError("a worker's process did not come into being; what it said stands above") from None
            return None
        if isinstance(answer, Refused):
            raise SimulatorError(answer.sentence)
        self.is_ready = True
        return answer

    def end(self) -> None:
        """Wait until it has ended, and end it where it does not."""
        self.connection.close()
        self.process.join(GOING_S)
        if self.process.is_alive():
            self.process.kill()
            self.process.join()


class Crew:
    """The workers of one command. ``play`` once, ``end`` in every case."""

    def __init__(self, options: ScenarioOptions, output: Path, jobs: Sequence[Job]) -> None:
        self._options, self._output = options, output
        self._waiting = deque(jobs)
        self._attempts = dict.fromkeys((job.number for job in jobs), 0)
        self._workers: dict[Any, _Worker] = {}

    def play(self) -> Iterator[Done | Lost]:
        """Play all jobs; what comes of each, in the order in which they end.

        Raises:
            SimulatorError: a worker cannot work.
            RuntimeError: a worker's process does not come into being, which is a bug of ours.
        """
        for _ in range(min(self._options.workers, len(self._waiting))):
            self._employ()
        while self._workers:
            for connection in wait(list(self._workers)):
                worker = self._workers[connection]
                answer = worker.says()
                if isinstance(answer, Ready):
                    continue
                if answer is not None:
                    worker.job = None
                    yield answer
                    if not answer.leaves:
                        self._give(worker)
                        continue
                lost = self._dismiss(worker)
                if lost is not None:
                    yield lost
                if self._waiting:
                    self._employ()

    def end(self) -> None:
        """End whoever still works."""
        for worker in list(self._workers.values()):
            worker.process.kill()
            worker.end()

    def _employ(self) -> None:
        """One worker more."""
        worker = _Worker(self._options, self._output)
        self._workers[worker.connection] = worker
        self._give(worker)

    def _give(self, worker: _Worker) -> None:
        """The next job, or the word that there is none."""
        job = self._waiting.popleft() if self._waiting else None
        if job is not None:
            self._attempts[job.number] += 1
        worker.give(job)

    def _dismiss(self, worker: _Worker) -> Lost | None:
        """See a worker off; the job that it died over is tried once more, and then lost."""
        del self._workers[worker.connection]
        worker.end()
        job = worker.job
        if job is None:
            return None
        if self._attempts[job.number] < ATTEMPTS:
            self._waiting.appendleft(job)
            return None
        return Lost(
            job.number, f"the process that played it died {ATTEMPTS} times (exit status {worker.process.exitcode})"
        )
