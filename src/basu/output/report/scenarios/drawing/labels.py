"""Words in a picture, each where nothing else stands; those that find no room are left out, unless they matter."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.output.report.markup import e, number
from basu.output.report.scenarios.drawing.canvas import WIDTH_PX

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
    """The words of one picture, in the order of their weight: who comes first has the choice."""

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
