"""The events of a result with place, time and a sentence: infractions by number, what is not scored by letter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from basu.metrics.infraction import row_of
from basu.output.report.markup import words

if TYPE_CHECKING:
    from collections.abc import Mapping

    from basu.metrics.result import Result


@dataclass(frozen=True, slots=True, kw_only=True)
class Event:
    """One of them."""

    label: str  # 1, 2, 3 for infractions, a, b, c for the rest
    anchor: str  # its name in the page
    kind: str
    factor: float | None  # on the infraction score; None where it is not scored
    tick: int
    t_s: float
    x_m: float
    y_m: float
    speed_mps: float | None
    route_s_m: float
    other: str | None
    detail: str
    responsibility: str | None = None  # a sentence about a collision

    @property
    def title(self) -> str:
        """It in a line."""
        what = "Event" if self.factor is None else "Infraction"
        return f"{what} {self.label}: {words(self.kind)} at {self.t_s:.1f} s"


def events(result: Result) -> tuple[Event, ...]:
    """All of a result: first the infractions, then the rest, each in order of time."""
    penalties = result.scoring["penalties"]
    scored = [
        _event(str(number), f"infraction-{number}", penalties.get(found.kind.value, 1.0), row_of(found))
        for number, found in enumerate(result.infractions, start=1)
    ]
    rest = [
        _event(_letters(number), f"event-{_letters(number)}", None, row) for number, row in enumerate(result.events())
    ]
    return (*scored, *rest)


def _event(label: str, anchor: str, factor: float | None, row: Mapping[str, Any]) -> Event:
    """A row of a result."""
    return Event(
        label=label,
        anchor=anchor,
        kind=row["kind"],
        factor=factor,
        tick=row["tick"],
        t_s=row["t_s"],
        x_m=row["x_m"],
        y_m=row["y_m"],
        speed_mps=row.get("speed_mps"),
        route_s_m=row["route_s_m"],
        other=row.get("other"),
        detail=row["detail"],
        responsibility=None if row.get("responsibility") is None else row["responsibility"]["sentence"],
    )


def _letters(number: int) -> str:
    """0, 1, 2, ... 25, 26 as a, b, c, ... z, aa."""
    text = ""
    number += 1
    while number:
        number, digit = divmod(number - 1, 26)
        text = chr(ord("a") + digit) + text
    return text
