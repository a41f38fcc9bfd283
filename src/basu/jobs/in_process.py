"""Plays jobs in this process, one after the other: for one worker, and for agents that exist only here."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.jobs.job import After, Done
from basu.jobs.pool import ATTEMPTS

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from basu.jobs.job import Job, PlayerSpec


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
