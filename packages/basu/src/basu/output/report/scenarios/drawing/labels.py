"""Labels of a case's picture, placed without overlap, and the legend below it."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.output.report.plots.chart import ticks
from basu.output.report.scenarios.drawing.actors import EGO_PX, SPEEDS_MPS
from basu.output.report.scenarios.drawing.canvas import WIDTH_PX
from basu.output.report.templates import e, number

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray

    from basu.output.report.scenarios.drawing.canvas import Canvas
    from basu.output.report.scenarios.drawing.encounter import Point


CHARACTER = 0.58  # width of one on average, in heights of the script
EDGE_PX = 3.0
REACHES = (1.0, 2.2, 3.6)  # how far away a word may stand, in gaps
ALONG_PX, LINE_PX = 14.0, 3.5  # how far apart, and how wide, a line is kept free of words
AROUND = (  # where a word may stand beside what it names: shares of its width and height, then of the gap, both ways
    (0.0, -1.0, 0.55, -0.55),
    (0.0, 0.0, 0.55, 0.55),
    (-0.5, -1.0, 0.0, -1.0),
    (-0.5, 0.0, 0.0, 1.0),
    (0.0, -0.5, 1.0, 0.0),
    (-1.0, -0.5, -1.0, 0.0),
    (-1.0, -1.0, -0.55, -0.55),
    (-1.0, 0.0, -0.55, 0.55),
)

Way = tuple[float, float, float, float]


class Taken(NamedTuple):
    """A rectangle in pixels."""

    left: float
    top: float
    right: float
    bottom: float

    def meets(self, other: Taken) -> bool:
        """Whether the two overlap."""
        return (
            self.left < other.right and other.left < self.right and self.top < other.bottom and other.top < self.bottom
        )


class Labels:
    """The words of one picture, in the order of their weight: the first has the choice."""

    def __init__(self, canvas: Canvas) -> None:
        self._canvas = canvas
        self._taken: list[Taken] = []
        self.drawn: list[Element] = []

    def keep_free(self, points_px: list[Point], margin_px: float = 1.0) -> None:
        """No word is to stand on this."""
        across, down = zip(*points_px, strict=True)
        self._taken.append(
            Taken(min(across) - margin_px, min(down) - margin_px, max(across) + margin_px, max(down) + margin_px)
        )

    def keep_line_free(self, points_px: NDArray[np.float64]) -> None:
        """Nor along this line (N, 2), where there is another place."""
        steps_px = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points_px, axis=0).T))])
        stations_px = np.arange(0.0, steps_px[-1], ALONG_PX)
        across, down = (np.interp(stations_px, steps_px, points_px[:, axis]) for axis in (0, 1))
        for x, y in zip(across.tolist(), down.tolist(), strict=True):
            if self._canvas.shows(x, y, -ALONG_PX):
                self._taken.append(Taken(x - LINE_PX, y - LINE_PX, x + LINE_PX, y + LINE_PX))

    def put(self, text: str, at_px: Point, style: str, *, size_px: float, gap_px: float, needed: bool = False) -> None:
        """Write it beside a place, where there is room."""
        width, height = len(text) * size_px * CHARACTER, size_px * 1.1
        chosen: Taken | None = None
        for reach, way in itertools.product(REACHES if needed else REACHES[:1], AROUND):
            place = self._place(at_px, width, height, gap_px * reach, way)
            if self._inside(place) and not any(place.meets(taken) for taken in self._taken):
                chosen = place
                break
        if chosen is None and needed:
            chosen = self._held(self._place(at_px, width, height, gap_px, AROUND[0]))
        if chosen is None:
            return
        self._taken.append(chosen)
        baseline = chosen.bottom - 0.27 * height
        self.drawn.append(e("text", text, x=number(chosen.left, 1), y=number(baseline, 1), class_=style))

    def _place(self, at_px: Point, width: float, height: float, gap_px: float, way: Way) -> Taken:
        """One of the places beside a point."""
        left = at_px[0] + way[0] * width + way[2] * gap_px
        top = at_px[1] + way[1] * height + way[3] * gap_px
        return Taken(left, top, left + width, top + height)

    def _held(self, place: Taken) -> Taken:
        """Moved into the picture."""
        right, bottom = WIDTH_PX - EDGE_PX, self._canvas.height_px - EDGE_PX
        left = max(EDGE_PX, min(place.left, right - (place.right - place.left)))
        top = max(EDGE_PX, min(place.top, bottom - (place.bottom - place.top)))
        return Taken(left, top, left + place.right - place.left, top + place.bottom - place.top)

    def _inside(self, place: Taken) -> bool:
        return self._canvas.shows(place.left, place.top, EDGE_PX) and self._canvas.shows(
            place.right, place.bottom, EDGE_PX
        )


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
    """Return a length, and where north is."""
    length_m = ticks(0.0, WIDTH_PX / canvas.pixels_per_m, 6)[1]
    length_px, y = length_m * canvas.pixels_per_m, canvas.height_px - 12.0
    return [
        e("path", d=f"M10 {number(y - 5.0, 1)}v5h{number(length_px, 1)}v-5", class_="scale"),
        e("text", f"{length_m:g} m", x=14, y=number(y - 4.0, 1), class_="small halo"),
        e("text", "↑ N", x=WIDTH_PX - 8.0, y=18, class_="strong halo", text_anchor="end"),
    ]


def _entry(group: Element, name: str, words: str, x: float, y: float) -> float:
    """Draw a sign with its meaning, and return where the next may begin."""
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
    """Return the mark of a contact."""
    arms = "".join(
        f"M{number(x + 7.0 * a, 1)} {number(y + 7.0 * b, 1)}L{number(x - 7.0 * a, 1)} {number(y - 7.0 * b, 1)}"
        for a, b in ((1, 1), (1, -1))
    )
    return e("g", e("path", d=arms, class_="hit under"), e("path", d=arms, class_="hit"))
