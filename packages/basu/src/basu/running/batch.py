"""`Batch`: drives with a folder each, played by workers, published by one rule, and found again after a kill.

A worker writes a drive as a draft. The command gives the draft its name in one step, so a folder under its name is a
whole one. When a batch goes on, it finds the finished folders, throws drafts away, and drives the rest.
"""

from __future__ import annotations

import contextlib
import shutil
import sys
from typing import TYPE_CHECKING, NamedTuple

from tqdm import tqdm

from basu.jobs.job import Job, Lost
from basu.jobs.playing import play_jobs
from basu.metrics.result import Result
from basu.outcome import Fault
from basu.output.report.documents import DRAFTS, RESULT_FILE, publish, read_result
from basu.routing.route_file import OWN_ROUTE

if TYPE_CHECKING:
    from collections.abc import Collection, Generator, Iterable, Iterator, Mapping
    from pathlib import Path

    from basu.jobs.job import PlayerSpec
    from basu.running.drive import WrittenDrive

COUNTED = frozenset({Fault.NONE, Fault.AGENT})
"""What ended otherwise says nothing of the agent, unless its record was unsafe before: that is a failure."""


class NotBegun(NamedTuple):
    """A drive that could not begin."""

    sentence: str
    fault: Fault


class PublishedDrive(NamedTuple):
    """What came of a job: a folder, or the reason why there is none."""

    number: int  # of the job
    written: WrittenDrive | None
    folder: Path | None
    failure: NotBegun | None = None


def counts(result: Result) -> bool:
    """Return whether a drive says something of the agent; the others are driven again when a batch goes on."""
    return result.outcome.status.fault in COUNTED or result.success.passed is False


class Batch:
    """The drives of one command in a folder."""

    def __init__(self, folder: Path, names: Mapping[int, str]) -> None:
        """Describe the batch; ``names`` are the folders of its drives below ``folder``, by number of the job."""
        self.folder, self._names = folder, names

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
        self, player: PlayerSpec, jobs: Iterable[Job], workers: int, *, unit: str = ""
    ) -> Generator[PublishedDrive, None, None]:
        """Play jobs and publish the folder of each; yield what came of them in the order in which they end.

        A ``unit``, such as "case", shows a progress bar of all jobs.

        Raises:
            UserError, AgentError, SimulatorError: a worker cannot work, or a drive in this process cannot begin.
            KeyboardInterrupt: the user interrupted a drive; it has been yielded.
        """
        waiting = list(jobs)
        with (
            tqdm(total=len(waiting), unit=unit, disable=None if unit else True, file=sys.stderr) as bar,
            contextlib.closing(play_jobs(player, waiting, workers)) as answers,
        ):
            for answer in answers:
                bar.update()
                if isinstance(answer, Lost):
                    yield PublishedDrive(answer.number, None, None, NotBegun(answer.sentence, Fault.BENCHMARK))
                elif isinstance(answer.value, NotBegun):
                    yield PublishedDrive(answer.number, None, None, answer.value)
                else:
                    written: WrittenDrive = answer.value
                    yield PublishedDrive(answer.number, written, self.publish(written, answer.number))

    def publish(self, written: WrittenDrive, number: int) -> Path:
        """Give a draft the name of its job, or one with a number where that is taken; return the folder.

        The name of a route that the agent has planned says that it is its own.

        Raises:
            UserError: the disk does not let us.
        """
        name = (self.folder / self._names[number]).name
        is_own = written.result.has_own_route and not name.endswith(OWN_ROUTE)
        return publish(written.draft, f"{name}{OWN_ROUTE}" if is_own else name)
