"""Disengagements: how often a person took over from the agent, and the miles from one to the next.

A disengagement is the change from the agent to a person while the vehicle is under test (as California's rules for
reports on autonomous vehicles have it, 13 CCR 227.02 and 227.50: the autonomous mode is deactivated). A drive that a
person begins has none until the agent had the vehicle; handing back to the agent is none. Miles per disengagement are
the miles that the agent drove, over their number; without one there is no such figure, only the miles.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from basu.metrics.infraction import Evidence, Incident, evidence, row_of
from basu.metrics.json_schema import EVIDENCE, integer, listing, number, record
from basu.metrics.registry import Drive, Metric, TimedMark, register
from basu.metrics.stretches import chords, path_m, spans, stretches, total_m

if TYPE_CHECKING:
    from basu.metrics.registry import JudgedRun
    from basu.records.history import History

M_PER_MILE = 1609.344


@dataclass(frozen=True, slots=True, kw_only=True)
class Disengagements:
    """How often a person took over."""

    events: tuple[Evidence, ...]
    autonomous_m: float  # that the agent drove
    manual_m: float  # that a person drove
    miles_per_disengagement: float | None  # None where there was none


def disengagements(history: History) -> Disengagements:
    """Count the takeovers and measure the way that the agent drove."""
    manual = history.frames["manual"] != 0
    pieces = chords(path_m(history.frames))
    by_person = manual[pieces.end]
    speed_mps = history.speed_mps()
    events = []
    for first, end in stretches(manual):
        if first == 0:
            continue
        seconds = (end - first) * history.facts.step_s
        until = f"for {seconds:.1f} s" if end < len(manual) else "to the end"
        alone_m = total_m(pieces.length_m[~by_person & (pieces.end < first)])
        events.append(
            evidence(
                history,
                Incident.DISENGAGEMENT,
                first,
                speed_mps=float(speed_mps[first]),
                other="a person",
                detail=f"a person took over at {speed_mps[first]:.2f} m/s, after {alone_m:.0f} m by the agent, {until}",
            )
        )
    autonomous_m = total_m(pieces.length_m[~by_person])
    return Disengagements(
        events=tuple(events),
        autonomous_m=autonomous_m,
        manual_m=total_m(pieces.length_m[by_person]),
        miles_per_disengagement=autonomous_m / M_PER_MILE / len(events) if events else None,
    )


@register
class Takeovers(Metric):
    """How often a person took over, and how far each drove."""

    name = "disengagements"
    title = "disengagements"
    order = 70
    timeline_row = "by hand"
    schema = record(
        null_=True,
        about_="takeovers by a person",
        number=integer(low=0),
        autonomous_m=number("m", low=0),
        manual_m=number("m", low=0),
        miles_per_disengagement=number("miles", low=0, null=True),
        events=listing(EVIDENCE),
    )

    def compute(self, drive: Drive) -> dict[str, Any]:
        """The number, the ways, and each takeover."""
        found = disengagements(drive.history)
        return {
            "number": len(found.events),
            "autonomous_m": found.autonomous_m,
            "manual_m": found.manual_m,
            "miles_per_disengagement": found.miles_per_disengagement,
            "events": [row_of(event) for event in found.events],
        }

    def lines(self, result: JudgedRun) -> list[str]:
        """A line where it happened."""
        found = result.metrics[self.name]
        if not found["number"]:
            return []
        miles = found["miles_per_disengagement"]
        return [f"disengagements    {found['number']}, {miles:.2f} miles by the agent to each"]

    def moments(self, result: JudgedRun, history: History) -> list[TimedMark]:  # noqa: ARG002 - of the record
        """Return the stretches in which a person drove."""
        return spans(history, history.frames["manual"].astype(np.bool_), "driven by hand", "manual")

    def remark(self, result: JudgedRun) -> str:
        """Say that a person drove a part of the way."""
        return "driven by hand" if (result.metrics.get(self.name) or {}).get("manual_m") else ""
