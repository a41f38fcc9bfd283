"""The pool: gives jobs to workers, replaces workers that end, and tries a job again where its worker died."""

from __future__ import annotations

import time
from collections import deque
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

from basu.errors import UserError
from basu.jobs.job import After, Died, Done, Job, JobOutcome, Lost, Ready, Refused, raised, versions

if TYPE_CHECKING:
    from collections.abc import Generator, Iterable, Iterator, Sequence

    from basu.jobs.job import PlayerAnswer

ATTEMPTS = 3  # at a job before it counts as lost
STARTS = 3  # of workers in a row that end before they are ready
WAIT_S = 1.0  # from one look at the time limits to the next


class Worker(Protocol):
    """A worker of a backend."""

    def give(self, data: Any) -> None:  # noqa: ANN401 - plain data of a job
        """Send a job's data; the answer comes through `Backend.answers`."""

    def end(self, *, at_once: bool) -> None:
        """End it: at once, or in good order within a limit."""


W = TypeVar("W", bound=Worker)


class Backend(Protocol[W]):
    """A kind of workers."""

    def start(self) -> W:
        """Start a worker, which answers `Ready` as its first."""

    def answers(self, workers: Sequence[W], timeout_s: float) -> list[tuple[W, PlayerAnswer]]:
        """Wait until some of ``workers`` have answered, at most ``timeout_s`` of wall time."""

    def close(self) -> None:
        """Release what the backend holds."""


class _Duty:
    """A job in work."""

    def __init__(self, job: Job, attempt: int, limit_s: float | None) -> None:
        self.job, self.attempt = job, attempt
        self.deadline_s = None if limit_s is None else time.monotonic() + limit_s


class Pool(Generic[W]):
    """The workers of one command. Call ``play`` once, and ``close`` in every case.

    Jobs are taken one by one as workers become free, so their number does not matter for the memory.
    """

    def __init__(
        self, backend: Backend[W], workers: int, *, attempts: int = ATTEMPTS, job_limit_s: float | None = None
    ) -> None:
        """Describe a pool of at most ``workers``; a job that takes longer than ``job_limit_s`` counts as a death."""
        self._backend, self._most, self._attempts, self._limit_s = backend, workers, attempts, job_limit_s
        self._workers: dict[W, _Duty | None] = {}  # None: it starts, or is idle
        self._idle: list[W] = []
        self._again: deque[tuple[Job, int]] = deque()  # with the number of the next attempt
        self._failed_starts = 0
        self._ready_once: set[W] = set()

    def play(self, jobs: Iterable[Job | None]) -> Generator[Done | Lost, None, None]:
        """Play all jobs; what comes of each, in the order in which they end.

        ``jobs`` may yield None where the next job depends on an answer; it is continued after the next answers.

        Raises:
            UserError, SimulatorError: a worker cannot work.
            RuntimeError: workers end before they are ready, which is a bug of ours.
        """
        waiting = iter(jobs)
        following = self._next(waiting)
        while following is not None or self._busy():
            while following is not None and self._idle:
                self._give(self._idle.pop(), *following)
                following = self._next(waiting)
            wanted = self._busy() if following is None else self._most
            while len(self._workers) < wanted:
                self._workers[self._backend.start()] = None
            for worker, answer in self._backend.answers(list(self._workers), WAIT_S):
                yield from self._take(worker, answer)
            yield from self._kill_late()
            if following is None:
                following = self._next(waiting)

    def close(self) -> None:
        """End all workers: idle ones in good order, the others at once."""
        for worker, duty in list(self._workers.items()):
            worker.end(at_once=duty is not None or worker not in self._ready_once)
        self._workers.clear()
        self._backend.close()

    def _next(self, waiting: Iterator[Job | None]) -> tuple[Job, int] | None:
        """The next job with the number of its attempt; None where there is none at present."""
        if self._again:
            return self._again.popleft()
        job = next(waiting, None)
        return None if job is None else (job, 1)

    def _busy(self) -> int:
        return sum(duty is not None for duty in self._workers.values())

    def _give(self, worker: W, job: Job, attempt: int) -> None:
        self._workers[worker] = _Duty(job, attempt, self._limit_s)
        worker.give(job.data)

    def _take(self, worker: W, answer: PlayerAnswer) -> Iterator[Done | Lost]:
        """Act on an answer.

        Raises:
            UserError, SimulatorError, RuntimeError: see ``play``.
        """
        if worker not in self._workers:
            return
        if isinstance(answer, Ready):
            _check_versions(answer)
            self._failed_starts = 0
            self._ready_once.add(worker)
            self._idle.append(worker)
        elif isinstance(answer, Refused):
            raise raised(answer)
        elif isinstance(answer, Died):
            yield from self._died(worker, answer.sentence)
        else:
            yield from self._played(worker, answer)

    def _played(self, worker: W, played: JobOutcome) -> Iterator[Done | Lost]:
        """Pass on what came of a job, or try it again."""
        duty = self._workers[worker]
        assert duty is not None, "only a worker with a job answers so"
        self._workers[worker] = None
        if played.after is After.GO_ON:
            self._idle.append(worker)
        else:
            self._remove(worker, at_once=False)
        if played.after is After.AGAIN and duty.attempt < self._attempts:
            self._again.append((duty.job, duty.attempt + 1))
            return
        yield Done(duty.job.number, played.value, duty.attempt)
        if played.after is After.INTERRUPTED:
            raise KeyboardInterrupt

    def _died(self, worker: W, sentence: str) -> Iterator[Done | Lost]:
        """Remove a worker that has died; its job is tried again, or lost."""
        duty = self._workers[worker]
        if worker not in self._ready_once:
            self._failed_starts += 1
            if self._failed_starts >= STARTS:
                raise RuntimeError(f"a worker ended before it was ready ({sentence}); its error stands above")
        self._remove(worker, at_once=True)
        if duty is None:
            return
        if duty.attempt < self._attempts:
            self._again.append((duty.job, duty.attempt + 1))
            return
        yield Lost(duty.job.number, f"its worker died {duty.attempt} times; the last time {sentence}", duty.attempt)

    def _kill_late(self) -> Iterator[Done | Lost]:
        """End workers that take too long over their job."""
        now_s = time.monotonic()
        late = [w for w, duty in self._workers.items() if duty and duty.deadline_s and duty.deadline_s < now_s]
        for worker in late:
            yield from self._died(worker, f"it was ended after {self._limit_s:g} s over one job")

    def _remove(self, worker: W, *, at_once: bool) -> None:
        del self._workers[worker]
        self._ready_once.discard(worker)
        if worker in self._idle:
            self._idle.remove(worker)
        worker.end(at_once=at_once)


def _check_versions(ready: Ready) -> None:
    """Refuse a worker with programs of other versions.

    Raises:
        UserError: names the first that differs.
    """
    for name, ours in versions().items():
        theirs = ready.versions.get(name, "none")
        if theirs != ours:
            raise UserError(
                f"a worker has {name} {theirs}, and this command {ours}; install the same versions on every node"
            )
