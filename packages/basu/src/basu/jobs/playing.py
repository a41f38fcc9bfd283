"""Plays jobs from a plan: by a pool of processes, or in this process, one after the other."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.jobs.job import After, Done
from basu.jobs.pool import ATTEMPTS, Pool
from basu.jobs.processes import Processes

if TYPE_CHECKING:
    from collections.abc import Generator, Iterable, Iterator, Sequence

    from basu.jobs.job import Job, Lost, PlayerSpec


def play_jobs(
    spec: PlayerSpec, jobs: Sequence[Job], workers: int, *, attempts: int = ATTEMPTS
) -> Generator[Done | Lost, None, None]:
    """Play jobs with up to ``workers`` processes; yield the answers in the order in which the jobs end.

    With one worker, or one job, the jobs are played in this process. Closing the generator ends the processes.

    Raises:
        UserError, SimulatorError: a worker cannot work, or the player cannot be opened.
        KeyboardInterrupt: the user interrupted a job; its answer has been yielded.
    """
    workers = min(workers, len(jobs))
    if workers <= 1:
        yield from play_here(spec, jobs, attempts=attempts)
        return
    pool = Pool(Processes(spec), workers, attempts=attempts)
    try:
        yield from pool.play(jobs)
    finally:
        pool.close()


def play_here(spec: PlayerSpec, jobs: Iterable[Job], *, attempts: int = ATTEMPTS) -> Iterator[Done]:
    """Play jobs with a player that is opened again where it asks for that.

    Raises:
        UserError, SimulatorError: the player cannot be opened.
        KeyboardInterrupt: the user interrupted a job; what came of it has been yielded.
    """
    waiting = iter(jobs)
    job, attempt = next(waiting, None), 1
    while job is not None:
        with spec.open() as play:
            while job is not None:
                played = play(job.data)
                if played.after is After.AGAIN and attempt < attempts:
                    attempt += 1
                    break
                yield Done(job.number, played.value, attempt)
                if played.after is After.INTERRUPTED:
                    raise KeyboardInterrupt
                job, attempt = next(waiting, None), 1
                if played.after is not After.GO_ON:
                    break
