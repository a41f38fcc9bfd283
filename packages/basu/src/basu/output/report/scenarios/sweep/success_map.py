"""The success map: cases in the plane of the two most decisive parameters, and each parameter by itself."""

from __future__ import annotations

import functools
import math
import textwrap
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree.ElementTree import tostring

import numpy as np

from basu.output.report.scenarios.sweep.boundary import boundary_of, sentences
from basu.output.report.scenarios.sweep.failure_rates import shares
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
    title,
)
from basu.output.report.scenarios.sweep.study import Axis, studies
from basu.output.report.templates import e, extended, number

if TYPE_CHECKING:
    from collections.abc import Sequence
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray

    from basu.output.report.scenarios.sweep.boundary import FailureBoundary, Rule
    from basu.output.report.scenarios.sweep.study import Study


STRIP_COLUMNS, STRIP_WIDTH_PX, STRIP_HEIGHT_PX = 2, 272.0, 52.0
ROW_PX = 104.0  # from one row of strips to the next
BINS = 16


def strips(found: FailureBoundary, top_px: float) -> list[Element]:
    """Return a small histogram for every parameter that varied, two in a row."""
    rules = {rule.axis.name: rule for rule in found.each if rule.is_sure}
    drawn = []
    for number_, axis in enumerate(found.study.axes):
        left = 24.0 + (number_ % STRIP_COLUMNS) * (STRIP_WIDTH_PX + 52.0)
        top = top_px + 20.0 + (number_ // STRIP_COLUMNS) * ROW_PX
        drawn.append(_strip(axis, found.study.failed, rules.get(axis.name), left, top))
    return drawn


def height_px(axes: int) -> float:
    """Return how high all strips are together."""
    return ROW_PX * -(-axes // STRIP_COLUMNS) + 4.0


def _strip(axis: Axis, failed: NDArray[np.bool_], rule: Rule | None, left: float, top: float) -> Element:
    """One of them: failures below, filled; passes on top of them, hollow."""
    edges = _edges(axis)
    beyond = (edges[-1] - edges[0]) / max(axis.high - axis.low, 1e-12) - 1.0  # of the outer bins, over the axis's ends
    scale = Scale(axis, left, left + STRIP_WIDTH_PX, beyond / 2.0 / (1.0 + beyond))
    bottom = top + STRIP_HEIGHT_PX
    fails, all_ = (np.histogram(axis.values[chosen], edges)[0] for chosen in (failed, np.ones_like(failed)))
    highest = max(int(all_.max()), 1)
    at = scale.at(edges)
    group = e("g", e("text", title(axis), x=left, y=top - 7.0, class_="strong"))
    group.append(e("text", _words_of(rule), x=left + STRIP_WIDTH_PX, y=top - 7.0, text_anchor="end", class_="small"))
    for index in range(len(all_)):
        x, width = at[index] + 1.0, at[index + 1] - at[index] - 2.0
        whole, part = (STRIP_HEIGHT_PX * count / highest for count in (all_[index], fails[index]))
        if all_[index]:
            sentence = f"{fails[index]} of {all_[index]} fail"
            bar = {"x": number(x, 1), "width": number(width, 1)}
            group.append(
                e(
                    "rect",
                    e("title", sentence),
                    y=number(bottom - whole, 1),
                    height=number(whole, 1),
                    class_="passes",
                    **bar,
                )
            )
            group.append(e("rect", y=number(bottom - part, 1), height=number(part, 1), class_="fails", **bar))
    group.append(e("path", d=f"M{left} {bottom}h{STRIP_WIDTH_PX}", class_="axis"))
    for place, text in scale.ticks():
        group.append(e("text", text, x=number(place, 1), y=bottom + 14.0, text_anchor="middle", class_="small"))
    if rule is not None and not axis.options:
        for value in (rule.low, rule.high):
            if math.isfinite(value):
                x = float(scale.at(np.array([value]))[0])
                group.append(e("path", d=f"M{number(x, 1)} {top - 3.0}V{bottom + 3.0}", class_="threshold"))
    return group


def _words_of(rule: Rule | None) -> str:
    """Return the rule in words, beside the parameter's name."""
    if rule is None:
        return "tells nothing by itself"
    return f"{rule.condition()}: {rule.failed_inside} of {int(rule.inside.sum())} fail"


def _edges(axis: Axis) -> NDArray[np.float64]:
    """Of the bins: of a grid or of choices one a value, else of equal width."""
    distinct = np.unique(axis.values)
    if len(distinct) <= BINS:
        half = float(np.diff(distinct).min()) / 2.0
        edges = np.concatenate([[distinct[0] - half], (distinct[1:] + distinct[:-1]) / 2.0, [distinct[-1] + half]])
    else:
        edges = np.linspace(axis.low, axis.high, BINS + 1)
    return edges.astype(np.float64)


STYLE_FILE = Path(__file__).parent / "success_map.css"
PICTURE_WIDTH_PX = 640.0
COLUMNS, ROWS = 57, 37  # of the grid on which the share of failures is known
HALF, SOME = 0.5, 0.2  # levels of it that are drawn
MARK_PX = 4.2  # half of a case's mark
LINE_PX, LINE_CHARACTERS = 16.0, 104


@functools.lru_cache
def map_style() -> str:
    """Return the style that a page with such maps needs."""
    return STYLE_FILE.read_text(encoding="utf-8")


def sweep_map(matrix: dict[str, Any], agent: str | None = None, scenario: str | None = None) -> str:
    """Return the map of one scenario and one agent as a file of its own, the first of each where none is named.

    An empty text where no parameter varied.
    """
    chosen = [s for s in studies(matrix) if agent in {None, s.agent} and scenario in {None, s.scenario}]
    if not chosen:
        return ""
    found = boundary_of(chosen[0])
    lines = [line for text in sentences(found) for line in textwrap.wrap(text[0].upper() + text[1:], LINE_CHARACTERS)]
    head_px = 30.0 + LINE_PX * len(lines)
    picture = drawing(found, head_px)
    picture.set("xmlns", "http://www.w3.org/2000/svg")
    picture.insert(0, e("style", map_style()))
    picture.append(e("text", f"{chosen[0].scenario} with {chosen[0].agent}", x=8, y=20.0 - head_px, class_="strong"))
    for row, line in enumerate(lines):
        picture.append(e("text", line, x=8, y=40.0 - head_px + LINE_PX * row, class_="small"))
    return tostring(picture, encoding="unicode") + "\n"


def drawing(found: FailureBoundary, head_px: float = 0.0) -> Element:
    """Return the map, its legend and the strips as a part of a page that has ``map_style()``."""
    study = found.study
    plot_px = TOP_PX + HEIGHT_PX + 44.0
    whole_px = plot_px + 28.0 + height_px(len(study.axes))
    view = " ".join(number(v, 1) for v in (0.0, -head_px, PICTURE_WIDTH_PX, whole_px + head_px))
    picture = e("svg", e("title", _title(found)), class_="success-map", viewBox=view, role="img")
    picture.append(e("rect", y=-head_px, width=PICTURE_WIDTH_PX, height=whole_px + head_px, class_="below"))
    x, y = scales(*_axes(found))
    extended(picture, axes(x, y))
    tells = found.pair is not None and found.pair.tells
    if tells:
        extended(picture, _shaded(study, x, y))
    extended(picture, _cases(study, x, y))
    extended(picture, _legend(study, plot_px + 12.0, tells=tells))
    return extended(picture, strips(found, plot_px + 34.0))


def _title(found: FailureBoundary) -> str:
    """Return the map in a sentence, for screen readers."""
    study = found.study
    return f"{study.scenario} with {study.agent}: " + " ".join(sentences(found))


def _axes(found: FailureBoundary) -> tuple[Axis, Axis]:
    """What the map lies between: the pair that predicts best; where only one parameter varied, the least distance."""
    if found.pair is not None:
        return found.pair.x, found.pair.y
    distance_m = np.nan_to_num(found.study.distance_m, nan=0.0)
    return found.study.axes[0], Axis("least distance", "m", "", distance_m, ())


def _shaded(study: Study, x: Scale, y: Scale) -> list[Element]:
    """Where some and where most of the cases around fail, and the line between most and few."""
    share = shares(study, x.axis, y.axis, grid(x, y, COLUMNS, ROWS)).reshape(ROWS, COLUMNS)
    some, _ = region(share, SOME)
    most, edge = region(share, HALF)
    return [
        e("path", d=some or None, class_="some"),
        e("path", d=most or None, class_="most"),
        e("path", d=edge or None, class_="boundary under"),
        e("path", d=edge or None, class_="boundary"),
    ]


def _cases(study: Study, x: Scale, y: Scale) -> list[Element]:
    """Return a mark a case; cases at one place as one mark with their count."""
    placed = np.column_stack([x.spread(), y.spread()]).round(1)
    places, which = np.unique(placed, axis=0, return_inverse=True)
    drawn: list[Element] = []
    for number_, (across, down) in enumerate(places.tolist()):
        here = np.flatnonzero(which.reshape(-1) == number_)
        if len(here) == 1:
            case = int(here[0])
            style = "broken" if study.broken[case] else "fail" if study.failed[case] else "pass"
            drawn.append(mark(style, across, down, study.ids[case]))
        else:
            drawn += _together(across, down, int(study.failed[here].sum()), len(here))
    return sorted(drawn, key=lambda element: element.get("class") != "pass")  # failures on top


def mark(style: str, x: float, y: float, sentence: str | None = None) -> Element:
    """One case: a hollow circle passes, a cross fails, a triangle broke down."""
    title = None if sentence is None else e("title", sentence)
    if style == "pass":
        return e("circle", title, cx=number(x, 1), cy=number(y, 1), r=MARK_PX - 0.8, class_=style)
    left, right, top, bottom = (number(v, 1) for v in (x - MARK_PX, x + MARK_PX, y - MARK_PX, y + MARK_PX))
    if style == "fail":
        return e("path", title, d=f"M{left} {top}L{right} {bottom}M{right} {top}L{left} {bottom}", class_=style)
    return e("polygon", title, points=f"{number(x, 1)},{top} {right},{bottom} {left},{bottom}", class_=style)


def _together(x: float, y: float, failed: int, count: int) -> list[Element]:
    """Several cases at one place: a box filled from below by the share that failed, and the count."""
    width, height = 34.0, 20.0
    filled = height * failed / count
    left, top = x - width / 2.0, y - height / 2.0
    return [
        e("rect", x=number(left, 1), y=number(top, 1), width=width, height=height, class_="together"),
        e(
            "rect",
            x=number(left, 1),
            y=number(top + height - filled, 1),
            width=width,
            height=number(filled, 1),
            class_="fails",
        ),
        e("text", f"{failed}/{count}", x=number(x, 1), y=number(y + 4.0, 1), text_anchor="middle", class_="count halo"),
    ]


def _legend(study: Study, y: float, *, tells: bool) -> Sequence[Element]:
    """Return the meaning of the marks."""
    drawn: list[Element] = []
    x = LEFT_PX
    words = [("pass", "passed"), ("fail", "failed")]
    if study.broken.any():
        words.append(("broken", "agent fault"))
    for style, text in words:
        drawn += [mark(style, x + 5.0, y), e("text", text, x=x + 14.0, y=y + 4.0, class_="small")]
        x += 30.0 + 6.4 * len(text)
    if tells:
        for style, text in (("most", "more than half of those around fail"), ("some", "more than a fifth")):
            drawn.append(e("rect", x=x, y=y - 7.0, width=18, height=13, class_=f"{style} swatch"))
            drawn.append(e("text", text, x=x + 24.0, y=y + 4.0, class_="small"))
            x += 40.0 + 6.0 * len(text)
    elif study.is_mixed:
        drawn.append(e("text", "these two show no boundary", x=min(x, LEFT_PX + WIDTH_PX), y=y + 4.0, class_="small"))
    return drawn
