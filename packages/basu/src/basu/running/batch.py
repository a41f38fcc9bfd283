"""`Batch`: drives with a folder each, played by workers, published by one rule, and found again after a kill.

A worker writes a drive as a draft. The command gives the draft its name in one step, so a folder under its name is a
whole one. When a batch goes on, it finds the finished folders, throws drafts away, and drives the rest.

Runs, series, matrices, the thesis's experiment and campaigns are batches. They differ in `Batch.publish`: what they
write when a drive is over.
"""

from __future__ import annotations

import contextlib
import shutil
from typing import TYPE_CHECKING

from basu.jobs.job import Lost
from basu.metrics.result import Result
from basu.outcome import Fault
from basu.output.report.documents import DRAFTS, RESULT_FILE, publish, read_result
from basu.routing.route_file import OWN_ROUTE
from basu.running.drive import DriveDone, lost

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Generator, Iterator, Mapping
    from pathlib import Path
    from typing import Any

    from tqdm import tqdm

    from basu.jobs.job import Done

COUNTED = frozenset({Fault.NONE, Fault.AGENT})
"""What ended otherwise says nothing of the agent, unless its record was unsafe before: that is a failure."""


def counts(result: Result) -> bool:
    """Return whether a drive says something of its agent; the others are driven again when a batch goes on."""
    return result.outcome.status.fault in COUNTED or result.success.passed is False


class Batch:
    """The drives of one command in a folder."""

    def __init__(self, folder: Path, names: Mapping[int, str]) -> None:
        """Describe the batch; ``names`` are the folders of its drives below ``folder``, by number of the job."""
        self.folder, self._names = folder, names
        self.drafts: Path | None = None  # where drafts of all drives are made; None: beside their folders

    @property
    def done(self) -> frozenset[int]:
        """The numbers of the drives that an earlier command has finished."""
        return frozenset()

    def name(self, number: int) -> str:
        """Return the name of a drive's folder."""
        return self._names[number]

    def clear(self) -> None:
        """Throw away the drafts of commands that were killed."""
        for parent in {(self.folder / name).parent for name in self._names.values()}:
            for draft in parent.glob(DRAFTS):
                if draft.is_dir():
                    shutil.rmtree(draft, ignore_errors=True)

    def finished(self, but: Collection[int] = ()) -> Iterator[tuple[int, Result]]:
        """Yield the number and the result of each drive with a finished folder, without the numbers in ``but``.

        Raises:
            UserError: a result is not what it should be.
        """
        for number, name in self._names.items():
            if number not in but and (self.folder / name / RESULT_FILE).exists():
                yield number, Result.from_document(read_result(self.folder / name))

    def set_aside(self, number: int, result: Result) -> Path:
        """Rename the folder of a finished drive that does not count, and return it under its new name.

        Raises:
            UserError: the disk does not let us.
        """
        folder = self.folder / self._names[number]
        return publish(folder, f"{folder.name}-{result.outcome.status.value}")

    def play(
        self, answers: Generator[Done | Lost, None, None], bar: tqdm[Any] | None = None
    ) -> Generator[DriveDone, None, None]:
        """Publish each drive that workers answer with; yield them in the order in which they end.

        ``bar`` is a progress bar of all jobs.

        Raises:
            UserError, AgentError, SimulatorError: a worker cannot work, or a drive in this process cannot begin.
            KeyboardInterrupt: the user interrupted a drive; it has been yielded.
        """
        with contextlib.closing(answers):
            for answer in answers:
                done = lost(answer.sentence) if isinstance(answer, Lost) else answer.value
                published = self.publish(done._replace(number=answer.number, attempts=answer.attempts))
                if bar is not None:
                    bar.update()
                yield published

    def publish(self, done: DriveDone) -> DriveDone:
        """Give a draft the name of its job, or one with a number where that is taken; return it with that folder.

        The name of a route that the agent has planned says that it is its own.

        Raises:
            UserError: the disk does not let us.
        """
        if done.folder is None:
            return done
        folder = self.folder / self._names[done.number]
        is_own = done.result.has_own_route and not folder.name.endswith(OWN_ROUTE)
        name = f"{folder.name}{OWN_ROUTE}" if is_own else folder.name
        return done._replace(folder=publish(done.folder, name, folder.parent))


def changes(before: Mapping[str, Any], now: Mapping[str, Any], shown: Callable[[Any], str] = repr) -> str:
    """Name the conditions that are different, with both values as ``shown`` writes them; empty where none is."""
    return "; ".join(
        f"{name} was {shown(before.get(name))} and is {shown(now.get(name))}"
        for name in sorted({*before, *now})
        if before.get(name) != now.get(name)
    )
