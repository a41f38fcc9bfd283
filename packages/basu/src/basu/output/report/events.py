"""The events of a result with place, time, sentence and mark: infractions by number, others by letter."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from basu.metrics.infraction import row_of
from basu.output.report.templates import e, number, words

if TYPE_CHECKING:
    from collections.abc import Mapping
    from xml.etree.ElementTree import Element

    from basu.metrics.result import Result


@dataclass(frozen=True, slots=True, kw_only=True)
class MarkedEvent:
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
        """Return the event as one line."""
        what = "Event" if self.factor is None else "Infraction"
        return f"{what} {self.label}: {words(self.kind)} at {self.t_s:.1f} s"


def events(result: Result) -> tuple[MarkedEvent, ...]:
    """Return all of a result: first the infractions, then the rest, each in order of time."""
    penalties = result.scoring["penalties"]
    scored = [
        _event(str(number), f"infraction-{number}", penalties.get(found.kind.value, 1.0), row_of(found))
        for number, found in enumerate(result.infractions, start=1)
    ]
    rest = [
        _event(_letters(number), f"event-{_letters(number)}", None, row) for number, row in enumerate(result.events())
    ]
    return (*scored, *rest)


def _event(label: str, anchor: str, factor: float | None, row: Mapping[str, Any]) -> MarkedEvent:
    """Return a row of a result."""
    return MarkedEvent(
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


CORNERS = {  # of a regular polygon, and its turn in degrees; a circle for every other kind
    "collision_pedestrian": (3, -90.0),
    "collision_vehicle": (4, -45.0),
    "collision_static": (4, -90.0),
    "stop_sign": (8, -67.5),
    "red_light": (6, -90.0),
    "speeding": (5, -90.0),
}
SHAPES = {3: "triangle", 4: "square", 5: "pentagon", 6: "hexagon", 8: "octagon"}


def shape(kind: str) -> str:
    """Return what the mark of a kind looks like, in a word."""
    if kind == "collision_static":
        return "diamond"
    return SHAPES[CORNERS[kind][0]] if kind in CORNERS else "circle"


def symbol(kind: str, label: str = "", *, scored: bool = True) -> Element:
    """Return the mark of a kind with its label in it; hollow where it does not enter the score."""
    if kind in CORNERS:
        corners, turn_deg = CORNERS[kind]
        radius = {3: 13.0, 4: 12.5}.get(corners, 11.0)
        middle = 14.5 if corners == 3 else 12.0
        angles = [math.radians(turn_deg + 360.0 * corner / corners) for corner in range(corners)]
        places = [f"{number(12 + radius * math.cos(a))},{number(middle + radius * math.sin(a))}" for a in angles]
        outline = e("polygon", points=" ".join(places))
    else:
        outline = e("circle", cx=12, cy=12, r=10)
    text = e("text", label, x=12, y=16.5 if kind == "collision_pedestrian" else 15.5, text_anchor="middle")
    style = "symbol" if scored else "symbol hollow"
    return e("svg", outline, text, viewBox="-1 -1 26 26", class_=style, aria_hidden="true")


def link(event: MarkedEvent, style: str) -> Element:
    """Return a mark that opens the evidence of what it marks; ``style`` places it."""
    return e(
        "a",
        symbol(event.kind, event.label, scored=event.factor is not None),
        href=f"#{event.anchor}",
        class_="at mark",
        title=event.title,
        aria_label=event.title,
        style=style,
    )
