"""The exit code of finished runs: of the party at fault, or of a score below what ``--require`` asks for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.outcome import Fault

if TYPE_CHECKING:
    from collections.abc import Mapping

    from basu.outcome import Status


def exit_code(status: Status, scores: Mapping[str, float] | None, required: Mapping[str, float]) -> int:
    """Return the exit code of a run; if only a score is too low, print which one.

    ``scores`` are in 0..1, None if nothing was driven. ``required`` gives the least value by the score's name.
    """
    if status.fault is not Fault.NONE:
        return int(status.fault.value)
    reached = scores or {}
    low = {name: least for name, least in required.items() if reached.get(name, 0.0) < least}
    for name, least in low.items():
        print(f"basu: the score {name} is {reached.get(name, 0.0):.4g}; --require asks for {least:g} or more")
    return Fault.AGENT.value if low else 0
