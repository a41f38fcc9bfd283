"""Each parameter by itself: how many cases passed and failed along it, and the rule that tells them best."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from basu.output.report.markup import e, number
from basu.output.report.scenarios.sweep.plane import Scale, title

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray

    from basu.output.report.scenarios.sweep.boundary import Boundary
    from basu.output.report.scenarios.sweep.rules import Rule
    from basu.output.report.scenarios.sweep.study import Axis

COLUMNS, STRIP_WIDTH_PX, STRIP_HEIGHT_PX = 2, 272.0, 52.0
ROW_PX = 104.0  # from one row of strips to the next
BINS = 16


def strips(found: Boundary, top_px: float) -> list[Element]:
    """A small histogram for every parameter that varied, two in a row."""
    rules = {rule.axis.name: rule for rule in found.each if rule.is_sure}
    drawn = []
    for number_, axis in enumerate(found.study.axes):
        left = 24.0 + (number_ % COLUMNS) * (STRIP_WIDTH_PX + 52.0)
        top = top_px + 20.0 + (number_ // COLUMNS) * ROW_PX
        drawn.append(_strip(axis, found.study.failed, rules.get(axis.name), left, top))
    return drawn


def height_px(axes: int) -> float:
    """How high all strips are together."""
    return ROW_PX * -(-axes // COLUMNS) + 4.0


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
    group.append(e("text", _told(rule), x=left + STRIP_WIDTH_PX, y=top - 7.0, text_anchor="end", class_="small"))
    for index in range(len(all_)):
        x, width = at[index] + 1.0, at[index + 1] - at[index] - 2.0
        whole, part = (STRIP_HEIGHT_PX * count / highest for count in (all_[index], fails[index]))
        if all_[index]:
            told = f"{fails[index]} of {all_[index]} fail"
            bar = {"x": number(x, 1), "width": number(width, 1)}
            group.append(
                e(
                    "rect",
                    e("title", told),
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


def _told(rule: Rule | None) -> str:
    """The rule in words, beside the parameter's name."""
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
