"""The files of a recording in a run's folder, and the map in an OpenDRIVE file as the official client reads it."""

from __future__ import annotations

from pathlib import Path

import carla

from basu.errors import UserError

LOG_FILE, MAP_FILE, CONDITIONS_FILE = "recording.log", "map.xodr", "recording.json"  # in a run's folder


def read_map(path: Path, name: str) -> carla.Map:
    """The map in an OpenDRIVE file, as the client reads it, without a server.

    Raises:
        UserError: it cannot be read.
    """
    try:
        return carla.Map(name, path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, RuntimeError) as error:
        raise UserError(f"the map {path} cannot be read: {error}; name an OpenDRIVE file (.xodr)") from error
