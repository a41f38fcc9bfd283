"""A pool of worker processes: each plays one case after the other, and a worker that dies is replaced."""

from __future__ import annotations

import contextlib
import multiprocessing
import subprocess
import sys
from collections import deque
from multiprocessing.connection import wait
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.errors import SimulatorError
from basu.running.scenario_runs.worker import Done, Job, Ready, Refused, main

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from basu.running.scenario_runs.options import ScenarioOptions

ATTEMPTS = 2  # at a job whose worker died
END_LIMIT_S = 10.0  # for a worker to end by itself


class Lost(NamedTuple):
    """A job over which every worker died."""

    number: int
    sentence: str


class _Worker:
    """A process with its pipe and its current job."""

    def __init__(self, options: ScenarioOptions, output: Path) -> None:
        self.connection, theirs = multiprocessing.Pipe()
        # not multiprocessing's "spawn": it would run a user's script again, unless that guards its main part
        self.process = subprocess.Popen(  # noqa: S603 - our own module
            worker_command(theirs.fileno()), stdin=subprocess.DEVNULL, pass_fds=[theirs.fileno()]
        )
        theirs.close()
        self.job: Job | None = None
        self.is_ready = False
        self._send((options, output))

    def give(self, job: Job | None) -> None:
        """Send the next job; None ends the worker."""
        self.job = job
        self._send(job)

    def answer(self) -> Done | Ready | None:
        """Return its next answer; None where its process has ended.

        Raises:
            SimulatorError: it cannot work.
            RuntimeError: its process ended before it was ready.
        """
        try:
            answer: Done | Ready | Refused = self.connection.recv()
        except (EOFError, OSError):
            if not self.is_ready:
                raise RuntimeError("a worker's process ended before it was ready; its error stands above") from None
            return None
        if isinstance(answer, Refused):
            raise SimulatorError(answer.sentence)
        self.is_ready = True
        return answer

    def end(self) -> None:
        """Wait until its process has ended; kill it after ``END_LIMIT_S``."""
        self.connection.close()
        try:
            self.process.wait(END_LIMIT_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()

    def _send(self, message: object) -> None:
        with contextlib.suppress(OSError):  # the process has ended, which its pipe shows
            self.connection.send(message)


def worker_command(descriptor: int) -> list[str]:
    """The command that starts a worker, which inherits its end of the pipe as ``descriptor``."""
    return [sys.executable, "-c", f"from {main.__module__} import main; main()", str(descriptor)]


class WorkerPool:
    """The workers of one command. Call ``play`` once, and ``end`` in every case."""

    def __init__(self, options: ScenarioOptions, output: Path, jobs: Sequence[Job]) -> None:
        self._options, self._output = options, output
        self._waiting = deque(jobs)
        self._attempts = dict.fromkeys((job.number for job in jobs), 0)
        self._workers: dict[Any, _Worker] = {}

    def play(self) -> Iterator[Done | Lost]:
        """Play all jobs; what comes of each, in the order in which they end.

        Raises:
            SimulatorError: a worker cannot work.
            RuntimeError: a worker's process ends before it is ready, which is a bug of ours.
        """
        for _ in range(min(self._options.workers, len(self._waiting))):
            self._add()
        while self._workers:
            for connection in wait(list(self._workers)):
                worker = self._workers[connection]
                answer = worker.answer()
                if isinstance(answer, Ready):
                    continue
                if answer is not None:
                    worker.job = None
                    yield answer
                    if not answer.ends_worker:
                        self._give(worker)
                        continue
                lost = self._remove(worker)
                if lost is not None:
                    yield lost
                if self._waiting:
                    self._add()

    def end(self) -> None:
        """Kill the workers that are left."""
        for worker in list(self._workers.values()):
            worker.process.kill()
            worker.end()

    def _add(self) -> None:
        """Start a worker."""
        worker = _Worker(self._options, self._output)
        self._workers[worker.connection] = worker
        self._give(worker)

    def _give(self, worker: _Worker) -> None:
        """Send the next job, or None where there is none left."""
        job = self._waiting.popleft() if self._waiting else None
        if job is not None:
            self._attempts[job.number] += 1
        worker.give(job)

    def _remove(self, worker: _Worker) -> Lost | None:
        """Remove a worker that has ended; a job that it died over is tried once more, and then lost."""
        del self._workers[worker.connection]
        worker.end()
        job = worker.job
        if job is None:
            return None
        if self._attempts[job.number] < ATTEMPTS:
            self._waiting.appendleft(job)
            return None
        return Lost(
            job.number, f"the process that played it died {ATTEMPTS} times (exit status {worker.process.returncode})"
        )
