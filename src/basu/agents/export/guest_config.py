"""The file that says which of BASU's agents drives as a guest, checked at once and answered in sentences."""

from __future__ import annotations

import difflib
from dataclasses import dataclass, fields
from pathlib import Path

from basu.errors import UserError
from basu.utils.json_file import read_json


@dataclass(frozen=True, slots=True, kw_only=True)
class GuestConfig:
    """Everything a guest is told beside its plan."""

    agent: str = "basic"  # a name of BASU's, FILE.py, or FILE.py:Class
    sensors: str | None = None  # a sensor file; None: as the agent says
    track: str = "SENSORS"  # of the leaderboard; the evaluator's --track must be the same


def read_config(name: str) -> GuestConfig:
    """Read the file, ``{"agent": "basic"}``; without a file every default.

    Raises:
        UserError: it cannot be read, or says something that means nothing.
    """
    if not name:
        return GuestConfig()
    path = Path(name)
    document = read_json(path, "agent config")
    if not isinstance(document, dict):
        raise UserError(f'agent config {path} must hold an object, such as {{"agent": "basic"}}')
    known = [field.name for field in fields(GuestConfig)]
    for key, value in document.items():
        if key not in known:
            close = difflib.get_close_matches(key, known, 1)
            hint = f"did you mean '{close[0]}'?" if close else f"it may have {', '.join(known)}"
            raise UserError(f"agent config {path} has the key '{key}', which means nothing here; {hint}")
        if not isinstance(value, str) or not value:
            raise UserError(f"agent config {path}: '{key}' is {value!r}; it must be a text")
    return GuestConfig(**document)
