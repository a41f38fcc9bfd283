"""The timeline: what happened when, a row a kind, above one axis of time."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.metrics.stretches import spans
from basu.output.report import events
from basu.output.report.plots.chart import share, times
from basu.output.report.templates import e, percent
from basu.thresholds import AT_REST_MPS

if TYPE_CHECKING:
    from collections.abc import Sequence
    from xml.etree.ElementTree import Element

    from basu.metrics.display import TimedMark
    from basu.metrics.result import Result
    from basu.output.report.events import MarkedEvent
    from basu.output.report.plots.signals import Signals
    from basu.records.history import History

CROWDED, LOWER_PX = 0.02, 14  # marks nearer than this share of the time are shown lower, by so much


def timeline(history: History, felt: Signals, result: Result, found: Sequence[MarkedEvent]) -> Element:
    """Return all rows: the events ``found``, a row of each metric that has one, and where the vehicle stood."""
    begin_s, end_s = float(felt.t_s[0]), max(float(felt.t_s[-1]), float(felt.t_s[0]) + 1e-3)
    of_metrics = [
        (each.timeline_row, [_moment(moment, begin_s, end_s) for moment in each.moments(result, history)])
        for each in result.shown()
        if each.timeline_row
    ]
    standing = spans(history, felt.speed_mps < AT_REST_MPS, "standing", "standing")
    rows = [
        ("infractions", _marks([f for f in found if f.factor is not None], begin_s, end_s)),
        ("not scored", _marks([f for f in found if f.factor is None], begin_s, end_s)),
        *of_metrics,
        ("standing", [_moment(moment, begin_s, end_s) for moment in standing]),
    ]
    body = e("div", class_="rows")
    for name, things in rows:
        row = e("div", *things, e("i", class_="cursor"), class_="row timed")
        if not things:
            row.append(e("small", "none"))
        body.append(e("div", e("span", name, class_="name"), row, class_="line-of-time"))
    body.append(e("div", e("span", class_="name"), times(begin_s, end_s), class_="line-of-time"))
    return body


def _marks(found: Sequence[MarkedEvent], begin_s: float, end_s: float) -> list[Element]:
    """Return a mark for each, a link to its evidence."""
    placed, last_share, height = [], -1.0, 0
    for event in sorted(found, key=lambda event: event.t_s):
        at = (event.t_s - begin_s) / (end_s - begin_s)
        height = (height + 1) % 3 if at - last_share < CROWDED else 0  # those at one time, one below the other
        last_share = at
        placed.append(events.link(event, f"left:{percent(at)};--down:{height * LOWER_PX}px"))
    return placed


def _moment(moment: TimedMark, begin_s: float, end_s: float) -> Element:
    """Return a mark, or a bar; the shortest bar can still be seen."""
    left = f"left:{share(moment.begin_s, begin_s, end_s)}"
    if moment.end_s is None:
        tag = "span" if moment.label else "i"
        return e(tag, moment.label or None, class_=moment.style, title=moment.title, style=left)
    width = percent((moment.end_s - moment.begin_s) / (end_s - begin_s))
    style = f"span {moment.style}"
    return e("i", moment.label or None, class_=style, title=moment.title, style=f"{left};width:{width}")
