"""The picture of a boundary in two parameters: drives, the boundary, and the band in which it lies."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from basu.output.report.scenarios.sweep.plane import (
    HEIGHT_PX,
    LEFT_PX,
    TOP_PX,
    WIDTH_PX,
    Scale,
    axes,
    grid,
    region,
    scales,
)
from basu.output.report.scenarios.sweep.study import Axis
from basu.output.report.scenarios.sweep.success_map import PICTURE_WIDTH_PX, mark
from basu.output.report.templates import e, extended, number
from basu_search.findings import MAY, SURE

if TYPE_CHECKING:
    from collections.abc import Iterator
    from xml.etree.ElementTree import Element

    from basu.campaigns.search_space import Dimension
    from basu_search.findings import Boundary, Drives

COLUMNS, ROWS = 85, 55  # of the grid on which the surrogate is computed
HALF = 0.5
UNJUDGED_PX = 2.0  # half of the mark of a drive that was not judged


def boundary_map(found: Boundary) -> Element | None:
    """The picture; None where the search has not two parameters, or no boundary."""
    drives = found.drives
    if len(drives.space) != 2 or found.surrogate is None:
        return None
    x, y = scales(*(_axis(each) for each in drives.space))
    plot_px = TOP_PX + HEIGHT_PX + 44.0
    view = f"0 0 {number(PICTURE_WIDTH_PX, 1)} {number(plot_px + 34.0, 1)}"
    said = f"{drives.title}: {' '.join(found.sentences)}"
    picture = e("svg", e("title", said), class_="success-map", viewBox=view, role="img")
    picture.append(e("rect", y=0.0, width=PICTURE_WIDTH_PX, height=plot_px + 34.0, class_="below"))
    extended(picture, axes(x, y))
    side = found.surrogate.failing(np.clip(grid(x, y, COLUMNS, ROWS), 0.0, 1.0)).reshape(ROWS, COLUMNS)
    may, _ = region(side, MAY)
    sure, _ = region(side, SURE)
    _, edge = region(side, HALF)
    for path, style in ((may, "some"), (sure, "most"), (edge, "boundary under"), (edge, "boundary")):
        picture.append(e("path", d=path or None, class_=style))
    extended(picture, _marks(drives, x, y))
    return extended(picture, _legend(plot_px + 12.0, has_unjudged=not drives.judged.all()))


def _axis(dimension: Dimension) -> Axis:
    """A parameter over its whole range."""
    ends = np.array([dimension.low, dimension.high])
    return Axis(dimension.name, dimension.unit, "", ends, ())


def _marks(drives: Drives, x: Scale, y: Scale) -> list[Element]:
    """A mark for each drive; failures on top."""
    across, down = (
        scale.at(each.low + drives.points[:, column] * (each.high - each.low))
        for column, (scale, each) in enumerate(zip((x, y), drives.space, strict=True))
    )
    drawn = [
        _mark(drives, place, float(right), float(below))
        for place, (right, below) in enumerate(zip(across, down, strict=True))
    ]
    return sorted(drawn, key=lambda element: element.get("class") == "fail")


def _mark(drives: Drives, place: int, right: float, below: float) -> Element:
    """One drive."""
    if drives.judged[place]:
        return mark("fail" if drives.failed[place] else "pass", right, below, drives.ids[place])
    title = e("title", f"{drives.ids[place]}: not judged")
    return e("circle", title, cx=number(right, 1), cy=number(below, 1), r=UNJUDGED_PX, class_="axis")


def _legend(y: float, *, has_unjudged: bool) -> Iterator[Element]:
    """What marks and areas mean."""
    x = LEFT_PX
    for style, text in (("pass", "passed"), ("fail", "failed")):
        yield mark(style, x + 5.0, y)
        yield e("text", text, x=x + 14.0, y=y + 4.0, class_="small")
        x += 30.0 + 6.4 * len(text)
    if has_unjudged:
        yield e("circle", cx=x + 3.0, cy=y, r=UNJUDGED_PX, class_="axis")
        yield e("text", "not judged", x=x + 12.0, y=y + 4.0, class_="small")
        x += 86.0
    for style, text in (("most", "fails"), ("some", "the boundary lies here")):
        yield e("rect", x=x, y=y - 7.0, width=18, height=13, class_=f"{style} swatch")
        yield e("text", text, x=x + 24.0, y=y + 4.0, class_="small")
        x += 40.0 + 6.0 * len(text)
    yield e("path", d=f"M{number(x, 1)} {number(y, 1)}h18", class_="boundary")
    yield e("text", "likeliest", x=x + 24.0, y=y + 4.0, class_="small")
    assert x < LEFT_PX + WIDTH_PX, "the legend fits"
