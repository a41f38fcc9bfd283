"""What an agent's ``config()`` may say, checked at once and answered in sentences."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

from basu.errors import UserError


@dataclass(frozen=True, slots=True, kw_only=True)
class AgentConfig:
    """An agent's wishes; file names as given, looked for later."""

    routes: str = "routes/linden_leap.xml"
    sensors: str | None = None
    sumo: str | None = None
    vehicle: str = "vehicle.easymile.ez10"
    weather: str = "ClearNoon"


def parse_config(given: Any, agent: str) -> AgentConfig:  # noqa: ANN401 - whatever a stranger's method returned
    """Check what the ``config()`` of ``agent`` returned; None takes every default.

    Raises:
        UserError: it is no dict, has a key that means nothing, or a value that is no text.
    """
    if given is None:
        return AgentConfig()
    if not isinstance(given, Mapping):
        raise UserError(f"config() of {agent} returned {type(given).__name__}; it must return a dict, such as {{}}")
    known = [field.name for field in fields(AgentConfig)]
    for key, value in given.items():
        if key not in known:
            close = difflib.get_close_matches(str(key), known, 1)
            hint = f"did you mean '{close[0]}'?" if close else f"it may have {', '.join(known)}"
            raise UserError(f"config() of {agent} has the key {key!r}, which means nothing here; {hint}")
        if value is not None and (not isinstance(value, str) or not value):
            raise UserError(f"config() of {agent}: '{key}' is {value!r}; it must be a text")
    return AgentConfig(**{key: value for key, value in given.items() if value is not None})
