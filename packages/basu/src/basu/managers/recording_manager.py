"""`RecordingManager`: starts and stops the simulator's recorder for a run, and saves the OpenDRIVE map."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

from basu.errors import UserError
from basu.files import write_bytes
from basu.managers.base_manager import BaseManager
from basu.records.recording_files import MAP_FILE

if TYPE_CHECKING:
    from basu.managers.base_manager import Frame, Run

ADDITIONAL_DATA = True  # velocities, boxes, physics: the input of queries


class RecordingManager(BaseManager):
    """Has the simulator record from the first step to the last, and keeps the map that the log lies in.

    ``path`` is where the simulator says that it writes the log.
    """

    def __init__(self, name: str) -> None:
        """Record as ``name``: a path where simulator and benchmark share a disk, else a plain name."""
        self._name = name
        self._run: Run | None = None
        self.path: str | None = None

    def setup(self, run: Run) -> None:
        """Begin; present actors are written as of the first frame.

        Raises:
            UserError: the simulator cannot write it.
        """
        try:
            path = run.client.start_recorder(self._name, ADDITIONAL_DATA)
        except RuntimeError as error:
            raise UserError(f"--record: the simulator cannot write its log: {error}") from error
        if not path:
            raise UserError(
                f"--record: the simulator could not write its log {self._name} and did not say why; "
                "see whether its disk is full, or run without --record"
            )
        self._run, self.path = run, str(path)
        write_bytes(run.folder / MAP_FILE, run.carla_map.to_opendrive().encode())

    def tick(self, frame: Frame) -> None:
        """The simulator writes each frame itself."""

    def close(self) -> None:
        """End the log."""
        if self._run is not None:
            run, self._run = self._run, None
            with contextlib.suppress(RuntimeError):  # the simulator is gone; every whole frame is in the file
                run.client.stop_recorder()
