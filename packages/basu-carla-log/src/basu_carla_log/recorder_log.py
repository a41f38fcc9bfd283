"""The recorder file that a command names, read with its problems printed, and a bar of its frames."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from tqdm import tqdm

from basu_carla_log import Log, read_log
from basu_carla_log.sources import Source, source


def read_recording(recording: Path, carla_map: Path | None) -> tuple[Log, Source]:
    """Read a run's recorder file, or one by itself, and print a warning where it ends early.

    Raises:
        UserError: there is none, or it cannot be read.
    """
    where = source(recording, carla_map)
    log = read_log(where.log)
    if log.problem is not None:
        print(f"basu: warning: {log.problem}", file=sys.stderr)
    return log, where


def progress_bar(total: int | None = None) -> Any:  # noqa: ANN401 - tqdm is generic to the type checker only
    """Return a bar of frames on the console; it is a context manager."""
    return tqdm(total=total, unit=" frames", desc="replaying", mininterval=0.1 if sys.stderr.isatty() else 10.0)
