"""Marks of infractions: a number in a shape that tells the kind without colour, hollow where it is not scored."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from basu.output.report.markup import e, number

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    from basu.output.report.events import Event

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
    """What the mark of a kind looks like, in a word."""
    if kind == "collision_static":
        return "diamond"
    return SHAPES[CORNERS[kind][0]] if kind in CORNERS else "circle"


def symbol(kind: str, label: str = "", *, scored: bool = True) -> Element:
    """The mark of a kind with its label in it; hollow where it does not enter the score."""
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


def link(event: Event, style: str) -> Element:
    """A mark that opens the evidence of what it marks; ``style`` places it."""
    return e(
        "a",
        symbol(event.kind, event.label, scored=event.factor is not None),
        href=f"#{event.anchor}",
        class_="at mark",
        title=event.title,
        aria_label=event.title,
        style=style,
    )
