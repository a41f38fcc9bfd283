"""The plane of two parameters in pixels: axes with round numbers, places of cases, and where failures are common."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from contourpy import FillType, LineType, contour_generator

from basu.output.report.plots.chart import ticks
from basu.output.report.templates import e, number

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray

    from basu.output.report.scenarios.sweep.study import Axis

LEFT_PX, TOP_PX, WIDTH_PX, HEIGHT_PX = 64.0, 12.0, 560.0, 360.0  # of the plot in the picture
ROOM = 0.04  # of an axis, beyond its ends
GOLDEN = 0.6180339887498949  # spreads cases of one option evenly, in any number
SPREAD = 0.55  # of the room that an option has

LETTER_PX = 6.6  # the width of one, on average


class Scale(NamedTuple):
    """An axis in pixels from its low to its high end; choices stand in the middle of equal parts."""

    axis: Axis
    begin_px: float
    end_px: float
    room: float = ROOM

    def at(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values as pixels."""
        if self.axis.options:
            shares = (values + 0.5) / len(self.axis.options)
        else:
            shares = self.room + (1.0 - 2.0 * self.room) * self.axis.share(values)
        placed: NDArray[np.float64] = self.begin_px + shares * (self.end_px - self.begin_px)
        return placed

    def inside(self, pixels: NDArray[np.float64]) -> NDArray[np.float64]:
        """Pixels as shares of the axis's reach; for a choice, of its options."""
        shares = (pixels - self.begin_px) / (self.end_px - self.begin_px)
        if self.axis.options:
            count = len(self.axis.options)
            return np.floor(np.clip(shares * count, 0.0, count - 1e-9)) / max(count - 1, 1)
        back: NDArray[np.float64] = (shares - self.room) / (1.0 - 2.0 * self.room)
        return back

    def spread(self) -> NDArray[np.float64]:
        """(N,) the places of all cases; those of one option beside each other."""
        placed = self.at(self.axis.values)
        if self.axis.options:
            turn = (np.arange(len(placed)) * GOLDEN) % 1.0 - 0.5
            placed = placed + turn * SPREAD * (self.end_px - self.begin_px) / len(self.axis.options)
        return placed

    def ticks(self) -> list[tuple[float, str]]:
        """Return the places of the axis with a text, and the texts."""
        if self.axis.options:
            numbers = np.arange(len(self.axis.options), dtype=np.float64)
            room = abs(self.end_px - self.begin_px) / len(self.axis.options)
            names = [shortened(name, int(room / LETTER_PX)) for name in self.axis.options]
            return list(zip(self.at(numbers).tolist(), names, strict=True))
        values = ticks(self.axis.low, self.axis.high, 6)
        return [
            (place, f"{value:.6g}") for place, value in zip(self.at(np.array(values)).tolist(), values, strict=True)
        ]


def shortened(name: str, letters: int) -> str:
    """Return a name in so much room: its end is kept, which tells cases of one scenario apart."""
    return name if len(name) <= letters else f"…{name[-max(letters - 1, 1) :]}"


def scales(x: Axis, y: Axis) -> tuple[Scale, Scale]:
    """Return both axes of the map."""
    return Scale(x, LEFT_PX, LEFT_PX + WIDTH_PX), Scale(y, TOP_PX + HEIGHT_PX, TOP_PX)


def axes(x: Scale, y: Scale) -> list[Element]:
    """Frame, grid and words."""
    bottom, right = TOP_PX + HEIGHT_PX, LEFT_PX + WIDTH_PX
    drawn = [e("rect", x=LEFT_PX, y=TOP_PX, width=WIDTH_PX, height=HEIGHT_PX, class_="paper")]
    for place, text in x.ticks():
        drawn.append(e("path", d=f"M{number(place, 1)} {TOP_PX}V{bottom}", class_="grid"))
        drawn.append(e("text", text, x=number(place, 1), y=bottom + 16.0, text_anchor="middle", class_="small"))
    for place, text in y.ticks():
        drawn.append(e("path", d=f"M{LEFT_PX} {number(place, 1)}H{right}", class_="grid"))
        drawn.append(_beside(text, place, is_name=bool(y.axis.options)))
    middle = number(TOP_PX + HEIGHT_PX / 2.0, 1)
    drawn.append(
        e("text", title(x.axis), x=LEFT_PX + WIDTH_PX / 2.0, y=bottom + 34.0, text_anchor="middle", class_="strong")
    )
    turned = f"rotate(-90 16 {middle})"
    drawn.append(e("text", title(y.axis), x=16, y=middle, text_anchor="middle", transform=turned, class_="strong"))
    return drawn


def _beside(text: str, place: float, *, is_name: bool) -> Element:
    """Return a tick's text to the left of the plot; a name runs upwards, or it would cover the axis's own."""
    if not is_name:
        return e("text", text, x=LEFT_PX - 6.0, y=number(place + 4.0, 1), text_anchor="end", class_="small")
    x, y = LEFT_PX - 10.0, number(place, 1)
    return e("text", text, x=x, y=y, text_anchor="middle", transform=f"rotate(-90 {x} {y})", class_="small")


def title(axis: Axis) -> str:
    """Return a parameter with its unit."""
    return f"{axis.name}, {axis.unit}" if axis.unit else axis.name


def region(share: NDArray[np.float64], level: float) -> tuple[str, str]:
    """Return paths of where a grid (R, C) over the plot is above a level: its area, and its edge within the plot."""
    rows, columns = share.shape
    x, y = np.linspace(LEFT_PX, LEFT_PX + WIDTH_PX, columns), np.linspace(TOP_PX, TOP_PX + HEIGHT_PX, rows)
    contours: Any = contour_generator(x, y, share, fill_type=FillType.OuterOffset, line_type=LineType.Separate)
    points, offsets = contours.filled(level, np.inf)
    rings = [ring for each, ends in zip(points, offsets, strict=True) for ring in np.split(each, ends[1:-1])]
    area = "".join(f"M{_line(ring)}z" for ring in rings)
    return area, "".join(f"M{_line(line)}" for line in contours.lines(level))


def _line(places: NDArray[np.float64]) -> str:
    return " ".join(f"{number(x, 1)} {number(y, 1)}" for x, y in places.tolist())


def grid(x: Scale, y: Scale, columns: int, rows: int) -> NDArray[np.float64]:
    """(rows * columns, 2) places all over the plot, as shares of both axes."""
    across = x.inside(LEFT_PX + WIDTH_PX * np.arange(columns, dtype=np.float64) / (columns - 1))
    down = y.inside(TOP_PX + HEIGHT_PX * np.arange(rows, dtype=np.float64) / (rows - 1))
    placed_x, placed_y = np.meshgrid(across, down)
    return np.column_stack([placed_x.ravel(), placed_y.ravel()])
