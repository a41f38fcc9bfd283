"""A chart over time with round numbers on its axes; its text is HTML and stays readable at any width.

The plot is SVG in a square of 1000 by 1000 that is drawn out to its box; strokes keep their width. What is said by
colour is said by dashes and hatching, too.
"""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.output.report.plots.decimate import curve
from basu.output.report.templates import MINUS, e, number, percent

if TYPE_CHECKING:
    from collections.abc import Sequence
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray


LONG_S = 180.0  # runs longer than this have minutes on their axis
MINUTE_S = 60.0


def ticks(low: float, high: float, about: int = 5) -> list[float]:
    """Round values in ``low`` .. ``high``, about so many: steps of 1, 2 or 5 times a power of ten."""
    if not high > low:
        return [low]
    rough = (high - low) / about
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= rough * 0.999)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [number * step for number in range(first, last + 1)]


def time_ticks(low_s: float, high_s: float, about: int = 10) -> list[float]:
    """Round times in s: as :func:`ticks`, on a long axis whole parts of minutes."""
    if high_s - low_s <= LONG_S:
        return ticks(low_s, high_s, about)
    rough_s = (high_s - low_s) / about
    steps_s = (15.0, 30.0, 60.0, 120.0, 300.0, 600.0, 900.0, 1800.0)
    step_s = next((s for s in steps_s if s >= rough_s * 0.999), math.ceil(rough_s / 3600.0) * 3600.0)
    return [number * step_s for number in range(math.ceil(low_s / step_s), math.floor(high_s / step_s) + 1)]


def clock(t_s: float, long: bool) -> str:  # noqa: FBT001 - which of two ways an axis is written
    """Return a time on an axis: seconds, or minutes and seconds on a long one."""
    if not long:
        return f"{t_s:g}"
    return f"{int(t_s // MINUTE_S)}:{int(t_s % MINUTE_S):02d}"


SIDE = 1000.0  # of the square that is stretched
HEADROOM = 0.08  # of the range of values, above and below
LEAST_APART = 0.06  # of the range: names of levels nearer to each other than this could not be read


class Curve(NamedTuple):
    """One curve of a chart."""

    name: str
    values: NDArray[np.float64]  # (T,), nan where there is none
    style: str  # class in report.css: `first`, `second`, `limit`
    steps: bool = False  # it jumps from value to value


class Shade(NamedTuple):
    """A stretch of time with a meaning."""

    begin_s: float
    end_s: float
    style: str  # class in report.css: `over`, `manual`


class Flag(NamedTuple):
    """A moment that a chart points out; a link where there is something to open."""

    t_s: float
    label: str
    title: str
    href: str
    scored: bool = True


def chart(
    t_s: NDArray[np.float64],
    lines: Sequence[Curve],
    *,
    title: str,
    unit: str,
    id_: str | None = None,
    levels: Sequence[tuple[float, str]] = (),
    shades: Sequence[Shade] = (),
    marks: Sequence[Flag] = (),
    least_range: tuple[float, float] = (0.0, 0.0),
    least_end_s: float = 0.0,
) -> Element:
    """Return a figure with its plot.

    ``levels`` are heights with a name. The axes show at least ``least_range`` and the time until ``least_end_s``, so
    that charts can have common axes.
    """
    begin_s, end_s = float(t_s[0]), max(float(t_s[-1]), float(t_s[0]) + 1e-3, least_end_s)
    low, high = _range([line.values for line in lines], least_range)
    plot = e("div", class_="plot" + (" timed" if id_ else ""))
    plot.extend(_shades(shades, begin_s, end_s))
    plot.append(_square(t_s, lines, levels, begin_s, end_s, low, high))
    plot.extend(_heights(low, high))
    plot.extend(_level_names(levels, low, high))
    plot.extend(_mark(mark, begin_s, end_s) for mark in marks)
    if id_:
        plot.append(e("i", class_="cursor"))
    return e(
        "figure",
        e("figcaption", e("b", title), f" in {unit} ", *(_legend(line) for line in lines), e("output", class_="now")),
        plot,
        times(begin_s, end_s),
        class_="chart",
        id=id_,
    )


def times(begin_s: float, end_s: float) -> Element:
    """Return the axis below a chart."""
    axis = e("div", class_="times")
    is_long = end_s - begin_s > LONG_S
    for count, t_s in enumerate(time_ticks(begin_s, end_s)):
        axis.append(
            e(
                "span",
                clock(t_s, is_long),
                class_="minor" if count % 2 else None,
                style=f"left:{percent((t_s - begin_s) / (end_s - begin_s))}",
            )
        )
    axis.append(e("em", "min:s" if is_long else "s"))
    return axis


def share(t_s: float, begin_s: float, end_s: float) -> str:
    """Return where a time lies on an axis, in CSS."""
    return percent(min(1.0, max(0.0, (t_s - begin_s) / (end_s - begin_s))))


def _range(curves: Sequence[NDArray[np.float64]], least: tuple[float, float]) -> tuple[float, float]:
    """Return the heights that a chart shows: all values, with room."""
    values = np.concatenate([line[np.isfinite(line)] for line in curves])
    low = min(float(values.min(initial=np.inf)), least[0])
    high = max(float(values.max(initial=-np.inf)), least[1])
    if not high > low:
        high = low + 1.0
    room = HEADROOM * (high - low)
    return (low if low == 0.0 else low - room), high + room


def _square(
    t_s: NDArray[np.float64],
    lines: Sequence[Curve],
    levels: Sequence[tuple[float, str]],
    begin_s: float,
    end_s: float,
    low: float,
    high: float,
) -> Element:
    """Return the curves, with the grid behind them."""
    square = e("svg", viewBox=f"0 0 {SIDE:g} {SIDE:g}", preserveAspectRatio="none", aria_hidden="true")
    up = [(high - value) / (high - low) * SIDE for value in ticks(low, high)]
    square.append(e("path", d="".join(f"M0 {number(y, 1)}H{SIDE:g}" for y in up), class_="grid"))
    along = [(t - begin_s) / (end_s - begin_s) * SIDE for t in time_ticks(begin_s, end_s)]
    square.append(e("path", d="".join(f"M{number(x, 1)} 0V{SIDE:g}" for x in along), class_="grid"))
    if low < 0.0 < high:
        square.append(e("path", d=f"M0 {number(high / (high - low) * SIDE, 1)}H{SIDE:g}", class_="zero"))
    inside = [(high - value) / (high - low) * SIDE for value, _ in levels if low < value < high]
    if inside:
        square.append(e("path", d="".join(f"M0 {number(y, 1)}H{SIDE:g}" for y in inside), class_="line level"))
    x = (t_s - begin_s) / (end_s - begin_s) * SIDE
    for line in reversed(lines):  # the first on top
        y = (high - line.values) / (high - low) * SIDE
        square.append(e("path", d=_path(x, y, line.steps), class_=f"line {line.style}"))
    return square


def _path(x: NDArray[np.float64], y: NDArray[np.float64], steps: bool) -> str:  # noqa: FBT001 - of a Curve
    """Curves as SVG writes them."""
    parts = []
    for stretch in curve(y):
        across, up = x[stretch].tolist(), y[stretch].tolist()
        parts.append(f"M{number(across[0], 1)} {number(up[0], 1)}")
        if steps:
            jumps = zip(across[1:], up[1:], strict=True)
            parts += [f"H{number(at, 1)}V{number(height, 1)}" for at, height in jumps]
        else:
            parts.append("L" + " ".join(f"{number(at, 1)} {number(h, 1)}" for at, h in zip(across, up, strict=True)))
    return "".join(parts)


def _shades(shades: Sequence[Shade], begin_s: float, end_s: float) -> list[Element]:
    """Return the hatched stretches of time."""
    return [
        e(
            "i",
            class_=f"shade {shade.style}",
            style=f"left:{share(shade.begin_s, begin_s, end_s)};"
            f"right:{percent(1.0 - min(1.0, max(0.0, (shade.end_s - begin_s) / (end_s - begin_s))))}",
        )
        for shade in shades
        if shade.end_s >= begin_s and shade.begin_s <= end_s
    ]


def _heights(low: float, high: float) -> list[Element]:
    """Return the values beside the plot."""
    return [
        e(
            "span",
            f"{value:g}".replace("-", MINUS),
            class_="height",
            style=f"top:{percent((high - value) / (high - low))}",
        )
        for value in (round(tick, 9) for tick in ticks(low, high))
    ]


def _level_names(levels: Sequence[tuple[float, str]], low: float, high: float) -> list[Element]:
    """Return what the levels are called, where there is room for it."""
    named = sorted((value, name) for value, name in levels if name and low < value < high)
    gaps = [after - before for (before, _), (after, _) in itertools.pairwise(named)]
    if any(gap < LEAST_APART * (high - low) for gap in gaps):
        return []
    return [
        e("span", name, class_="level", style=f"top:{percent((high - value) / (high - low))}") for value, name in named
    ]


def _mark(mark: Flag, begin_s: float, end_s: float) -> Element:
    """Return a numbered flag at the top of a chart."""
    at = share(mark.t_s, begin_s, end_s)
    style = "flag" if mark.scored else "flag faint"
    return e("a", mark.label, href=mark.href, class_=style, title=mark.title, style=f"left:{at}")


def _legend(line: Curve) -> Element:
    """Return a sample of a curve and its name."""
    sample = e("svg", e("path", d="M0 5H26", class_=f"line {line.style}"), viewBox="0 0 26 10", class_="sample")
    return e("span", sample, line.name, class_="legend")
