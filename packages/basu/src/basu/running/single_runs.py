"""`SingleRuns`: the runs of one command without a series, which go on after the command was killed.

While they last, a hidden folder beside their own folders holds the drafts and ``runs.json``. That file has the name of
each run's folder, and which runs are done. The name of the hidden folder is a digest of what the results depend on, so
the same command with ``--resume`` finds it. A drive that was under way begins again, under the same name.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import shutil
from typing import TYPE_CHECKING, Any

from basu.errors import UserError
from basu.files import read_json
from basu.output.report.documents import DRAFTS, RESULT_FILE, write_json
from basu.running.batch import Batch, counts
from basu.running.folder_lock import locked

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from basu.running.drive import DriveDone

RUNS_FILE = "runs.json"


class SingleRuns(Batch):
    """The runs of one command in the folder of all runs. ``open_runs`` makes one."""

    def __init__(self, output: Path, hidden: Path, document: dict[str, Any]) -> None:
        """Take up the runs that ``document`` lists; their drafts are in ``hidden``."""
        super().__init__(output, {int(number): name for number, name in document["names"].items()})
        self.drafts, self._hidden, self._document = hidden, hidden, document

    @property
    def done(self) -> frozenset[int]:
        """The numbers of the runs that count and have a folder."""
        there = self._document["done"].items()
        return frozenset(int(number) for number, name in there if (self.folder / name / RESULT_FILE).exists())

    @property
    def is_over(self) -> bool:
        """Whether nothing is left that could go on: all runs are done, or none."""
        return len(self.done) in {0, len(self._document["names"])}

    def clear(self) -> None:
        """Throw away the drafts of a command that was killed."""
        for draft in self._hidden.glob(DRAFTS):
            shutil.rmtree(draft, ignore_errors=True)

    def publish(self, done: DriveDone) -> DriveDone:
        """Give a draft the name of its run, note the run where it counts, and return it with that folder.

        Raises:
            UserError: the disk does not let us.
        """
        published = super().publish(done)
        if published.folder is not None and all(map(counts, published.results)):
            self._document["done"][str(published.number)] = published.folder.name
            self.write()
        return published

    def write(self) -> None:
        """Write the list, at once or not at all.

        Raises:
            UserError: the disk does not let us.
        """
        write_json(self._hidden / RUNS_FILE, self._document)


@contextlib.contextmanager
def open_runs(output: Path, given: Mapping[str, Any], names: Mapping[int, str], *, resume: bool) -> Iterator[Batch]:
    """Begin the runs of a command, or go on with those of one that was killed; ``given`` is all that they depend on.

    A second command that is the same and runs at the same time cannot be resumed.

    Raises:
        UserError: there is nothing to go on with, or another command drives it.
    """
    digest = hashlib.sha256(json.dumps(given, sort_keys=True).encode()).hexdigest()[:16]
    hidden = output / f".begun-{digest}"
    if resume and not (hidden / RUNS_FILE).exists():
        raise UserError(
            f"nothing in {output} was begun with these options and is unfinished; leave out --resume to begin, or name "
            "the series with --series"
        )
    with contextlib.ExitStack() as stack:
        try:
            stack.enter_context(locked(hidden))
        except UserError:
            if resume or not hidden.is_dir():
                raise
            yield Batch(output, names)
            return
        document = {"names": {str(number): name for number, name in names.items()}, "done": {}}
        if resume:
            document = read_json(hidden / RUNS_FILE, "the list of runs", "remove the folder and begin again")
        runs = SingleRuns(output, hidden, document)
        runs.clear()
        runs.write()
        try:
            yield runs
        finally:
            if runs.is_over and not any(hidden.glob(DRAFTS)):
                (hidden / RUNS_FILE).unlink(missing_ok=True)
                stack.close()
                with contextlib.suppress(OSError):
                    hidden.rmdir()
