"""What the signs in a case's picture mean, below it; and the length to compare with."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.output.report.markup import e, number
from basu.output.report.plots.axis import ticks
from basu.output.report.scenarios.drawing.canvas import WIDTH_PX
from basu.output.report.scenarios.drawing.trails import EGO_PX, SPEEDS_MPS

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    from basu.output.report.scenarios.drawing.canvas import Canvas

HEIGHT_PX = 54.0
SWATCH_PX = 20.0
LETTER_PX = 6.2  # the width of one, on average


def legend(top_px: float, shown: set[str]) -> Element:
    """Two lines: the speeds, and those signs that are ``shown``."""
    group = e("g", class_="legend")
    y, x = top_px + 16.0, 8.0
    group.append(e("text", "ego, m/s", x=x, y=y + 4.0, class_="small"))
    x += 58.0
    for band in range(len(SPEEDS_MPS) + 1):
        group.append(e("path", d=f"M{number(x, 1)} {y}h{SWATCH_PX}", class_=f"v{band}", stroke_width=EGO_PX + 2.0))
        x += SWATCH_PX
        if band < len(SPEEDS_MPS):
            group.append(e("text", f"{SPEEDS_MPS[band]:g}", x=x, y=y + 15.0, class_="small", text_anchor="middle"))
    x += 14.0
    for name, words in (
        ("dot", "a dot a second"),
        ("way", "others"),
        ("plan", "planned route"),
    ):
        x = _entry(group, name, words, x, y)
    x, y = 66.0, y + 27.0
    for name, words in (
        ("ghost", "conflict begins"),
        ("gap", "least distance"),
        ("hit", "contact"),
        ("thing", "standing things"),
    ):
        if name in shown:
            x = _entry(group, name, words, x, y)
    return group


def scale(canvas: Canvas) -> list[Element]:
    """A length, and where north is."""
    length_m = ticks(0.0, WIDTH_PX / canvas.pixels_per_m, 6)[1]
    length_px, y = length_m * canvas.pixels_per_m, canvas.height_px - 12.0
    return [
        e("path", d=f"M10 {number(y - 5.0, 1)}v5h{number(length_px, 1)}v-5", class_="scale"),
        e("text", f"{length_m:g} m", x=14, y=number(y - 4.0, 1), class_="small halo"),
        e("text", "↑ N", x=WIDTH_PX - 8.0, y=18, class_="strong halo", text_anchor="end"),
    ]


def _entry(group: Element, name: str, words: str, x: float, y: float) -> float:
    """A sign with its meaning; returns where the next may begin."""
    signs = {
        "dot": lambda: e("circle", cx=x + 8.0, cy=y, r=2.6, class_="dot"),
        "way": lambda: e("path", d=f"M{number(x, 1)} {y}h18", class_="way"),
        "plan": lambda: e("path", d=f"M{number(x, 1)} {y}h18", class_="plan", stroke_width=9.0),
        "ghost": lambda: e("rect", x=x + 1.0, y=y - 5.0, width=16, height=10, class_="ghost"),
        "gap": lambda: e("path", d=f"M{number(x, 1)} {y}h18", class_="gap"),
        "hit": lambda: cross(x + 9.0, y),
        "thing": lambda: e("rect", x=x + 3.0, y=y - 5.0, width=12, height=10, class_="thing"),
    }
    group.append(signs[name]())
    group.append(e("text", words, x=x + 23.0, y=y + 4.0, class_="small"))
    return x + 23.0 + LETTER_PX * len(words) + 14.0


def cross(x: float, y: float) -> Element:
    """The mark of a contact."""
    arms = "".join(
        f"M{number(x + 7.0 * a, 1)} {number(y + 7.0 * b, 1)}L{number(x - 7.0 * a, 1)} {number(y - 7.0 * b, 1)}"
        for a, b in ((1, 1), (1, -1))
    )
    return e("g", e("path", d=arms, class_="hit under"), e("path", d=arms, class_="hit"))
