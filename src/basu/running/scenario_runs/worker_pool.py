"""A pool of worker processes, each with a simulator of its own: plays cases, and replaces a worker that dies."""

from __future__ import annotations

import contextlib
import multiprocessing
import signal
import subprocess
import sys
from collections import deque
from multiprocessing.connection import Connection, wait
from typing import TYPE_CHECKING, Any, NamedTuple

from basu import client_threads
from basu.agents.process.remote_agent import find_agent
from basu.episode import Towns
from basu.errors import BasuError, SimulatorError
from basu.outcome import Status
from basu.output.report.documents import plain
from basu.running.scenario_runs.one_case import CaseSession, play_case
from basu.scenarios.cases import open_library
from basu.simulator import simulator_for

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from basu.agents.loader import LoadedAgent
    from basu.agents.process.remote_agent import FoundAgent
    from basu.running.scenario_runs.options import ScenarioOptions


ENDING = frozenset({Status.SIMULATOR_FAILED, Status.BENCHMARK_FAILED})
"""After these a worker ends: its simulator is gone, or the benchmark has a bug."""
ENDING_IN_PROCESS = ENDING | {Status.AGENT_TIMED_OUT}  # the agent's code may still run in it


class Job(NamedTuple):
    """A case for an agent."""

    number: int  # from 0, in the order of the matrix
    agent: str  # as it was typed
    case: str  # its id


class Done(NamedTuple):
    """A job that is over: its folder holds the rest."""

    number: int
    document: dict[str, Any]
    folder: str  # below the run's
    ends_worker: bool  # whether the worker ends now


class Ready(NamedTuple):
    """A worker is ready; one that ends before has not died over a job."""


class Refused(NamedTuple):
    """A worker that cannot work, and why."""

    sentence: str


def play(
    options: ScenarioOptions,
    output: Path,
    jobs: Iterable[Job],
    given: Mapping[str, LoadedAgent] | None = None,
) -> Iterator[Done]:
    """Play jobs in a simulator until there are none left, or a fresh process is needed; yield what came of each.

    ``given`` are agents' classes that are loaded, by name.

    Raises:
        UserError: an agent or a case cannot be had.
        SimulatorError: there is no simulator to play in.
        KeyboardInterrupt: the user interrupted a case; what came of it has been yielded.
    """
    library = open_library(options.all_files)
    agents: Mapping[str, FoundAgent] = given or {
        agent: find_agent(agent, in_process=options.in_process, memory_gb=options.agent_memory_gb)
        for agent in options.agents
    }
    with simulator_for(options.run_options(options.agents[0])) as simulator:
        session = CaseSession(options, simulator, Towns(simulator))
        for job in jobs:
            (playable,) = library.of_id(job.case)
            loaded = agents[job.agent]
            played = play_case(session, loaded, playable, output / plain(loaded.name))
            ends = played.outcome.status in (ENDING_IN_PROCESS if options.in_process or given else ENDING)
            yield Done(job.number, played.document, str(played.folder.relative_to(output)), ends)
            if played.outcome.status is Status.INTERRUPTED:
                raise KeyboardInterrupt
            if ends:
                return


def work(connection: Connection) -> None:
    """Play the jobs that come through a pipe, and answer through it; the options come first."""
    options, output = connection.recv()

    def jobs() -> Iterable[Job]:
        while (job := connection.recv()) is not None:
            yield job

    connection.send(Ready())
    try:
        for done in play(options, output, jobs()):
            connection.send(done)
    except BasuError as error:
        connection.send(Refused(str(error)))


def main() -> None:
    """Work at a pipe; its descriptor is the first argument."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the command, which ends its workers
    with contextlib.suppress(EOFError, BrokenPipeError):  # the command has ended
        work(Connection(int(sys.argv[1])))
    if client_threads.is_held():
        client_threads.leave(0)


ATTEMPTS = 2  # at a job before it counts as failed
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
