"""SUMO's own outputs of a run: trip information, summary, collisions and surrogate safety measures, as XML files."""

from __future__ import annotations

import contextlib
import re
from typing import TYPE_CHECKING

from basu.errors import UserError
from basu.files import write_bytes

if TYPE_CHECKING:
    from pathlib import Path

FOLDER = "sumo"  # in the run's folder
TRIPS, SUMMARY, COLLISIONS, SAFETY = "tripinfo.xml", "summary.xml", "collisions.xml", "ssm.xml"
TOTALS = "statistics.xml"
SUMMARY_S = 1.0
_HEADER = re.compile(rb"<!-- generated on .*?-->\s*", re.DOTALL)  # SUMO's note on when and how it ran


class Outputs:
    """The files in a run's folder; without a folder there are none."""

    def __init__(self, run_folder: Path | None, watched: str) -> None:
        """Make their folder. ``watched`` is the vehicle of the safety measures.

        Raises:
            UserError: the folder cannot be made.
        """
        self._folder = None if run_folder is None else (run_folder / FOLDER).resolve()
        self._watched = watched
        if self._folder is not None:
            try:
                self._folder.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise UserError(f"cannot make {self._folder}: {error.strerror}; leave out --sumo-output") from error

    @property
    def options(self) -> tuple[str, ...]:
        """SUMO's options for them."""
        if self._folder is None:
            return ()
        folder = self._folder
        return (
            *("--tripinfo-output", str(folder / TRIPS), "--tripinfo-output.write-unfinished", "true"),
            *("--summary-output", str(folder / SUMMARY), "--summary-output.period", f"{SUMMARY_S:g}"),
            *("--collision-output", str(folder / COLLISIONS)),
            *("--device.ssm.explicit", self._watched, "--device.ssm.file", str(folder / SAFETY)),
        )

    @property
    def alone(self) -> tuple[str, ...]:
        """SUMO's options for a play without a simulator: trip information, and totals by SUMO itself."""
        if self._folder is None:
            return ()
        trips = ("--tripinfo-output", str(self._folder / TRIPS), "--tripinfo-output.write-unfinished", "true")
        return (*trips, "--statistic-output", str(self._folder / TOTALS))

    @staticmethod
    def trips_of(run_folder: Path) -> Path:
        """Return the file of trip information in a run's folder."""
        return run_folder / FOLDER / TRIPS

    def finish(self) -> None:
        """Take the time of writing out of the files, once SUMO has ended: the same run gives the same bytes.

        A file that cannot be written again keeps it.
        """
        for path in () if self._folder is None else sorted(self._folder.glob("*.xml")):
            with contextlib.suppress(OSError, UserError):
                write_bytes(path, _HEADER.sub(b"", path.read_bytes(), count=1))
