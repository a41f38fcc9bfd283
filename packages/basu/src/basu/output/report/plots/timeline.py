"""The timeline: what happened when, a row a kind, above one axis of time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from basu.metrics.path_following import serving
from basu.output.report import events
from basu.output.report.plots.chart import share, times
from basu.output.report.plots.signals import stretches
from basu.output.report.templates import e, percent
from basu.thresholds import AT_REST_MPS

if TYPE_CHECKING:
    from collections.abc import Sequence
    from xml.etree.ElementTree import Element

    from basu.output.report.events import Event
    from basu.output.report.plots.signals import Signals
    from basu.records.history import History

CROWDED, LOWER_PX = 0.02, 14  # marks nearer than this share of the time are shown lower, by so much


class TimelineSpan(NamedTuple):
    """From when to when something lasted."""

    begin_s: float
    end_s: float
    style: str  # class in report.css
    label: str
    title: str


def timeline(history: History, felt: Signals, document: dict[str, Any], found: Sequence[Event]) -> Element:
    """Return all rows; ``document`` is the run's result."""
    begin_s, end_s = float(felt.t_s[0]), max(float(felt.t_s[-1]), float(felt.t_s[0]) + 1e-3)
    rows = [
        ("infractions", _marks([f for f in found if f.factor is not None], begin_s, end_s)),
        ("not scored", _marks([f for f in found if f.factor is None], begin_s, end_s)),
        ("stop signs", _signs(document["stop_signs"], begin_s, end_s)),
        ("service stops", _spans(_services(history, felt), begin_s, end_s)),
        ("standing", _spans(_standing(felt), begin_s, end_s)),
        (
            "by hand",
            _spans(
                [TimelineSpan(*s, "manual", "", _lasted("driven by hand", *s)) for s in _by_hand(felt)], begin_s, end_s
            ),
        ),
        ("lane lines crossed", _invasions(history, begin_s, end_s)),
    ]
    body = e("div", class_="rows")
    for name, things in rows:
        row = e("div", *things, e("i", class_="cursor"), class_="row timed")
        if not things:
            row.append(e("small", "none"))
        body.append(e("div", e("span", name, class_="name"), row, class_="line-of-time"))
    body.append(e("div", e("span", class_="name"), times(begin_s, end_s), class_="line-of-time"))
    return body


def _marks(found: Sequence[Event], begin_s: float, end_s: float) -> list[Element]:
    """Return a mark for each, a link to its evidence."""
    placed, last_share, height = [], -1.0, 0
    for event in sorted(found, key=lambda event: event.t_s):
        at = (event.t_s - begin_s) / (end_s - begin_s)
        height = (height + 1) % 3 if at - last_share < CROWDED else 0  # those at one time, one below the other
        last_share = at
        placed.append(events.link(event, f"left:{percent(at)};--down:{height * LOWER_PX}px"))
    return placed


def _signs(signs: Sequence[dict[str, Any]], begin_s: float, end_s: float) -> list[Element]:
    """Return every stop sign that was passed: a tick where the vehicle stopped, a cross where it did not."""
    return [
        e(
            "span",
            "✓" if sign["stopped"] else "✗",
            class_="at passed" + ("" if sign["stopped"] else " run"),
            title=f"stop sign {sign['id']} {'stopped at' if sign['stopped'] else 'run'}, "
            f"passed at {sign['t_s']:.1f} s, lowest speed {sign['lowest_speed_mps']:.2f} m/s",
            style=f"left:{share(sign['t_s'], begin_s, end_s)}",
        )
        for sign in signs
    ]


def _services(history: History, felt: Signals) -> list[TimelineSpan]:
    """At rest at a service stop."""
    found = []
    standing = felt.speed_mps < AT_REST_MPS
    for stop in history.facts.route.stops:
        here = standing & serving(history, stop.s_m)
        found += [
            TimelineSpan(*s, "service", stop.id, _lasted(f"{stop.id}, {stop.name}", *s))
            for s in stretches(here, felt.t_s)
        ]
    return sorted(found)


def _standing(felt: Signals) -> list[TimelineSpan]:
    """At rest, wherever."""
    at_rest = stretches(felt.speed_mps < AT_REST_MPS, felt.t_s)
    return [TimelineSpan(*s, "standing", "", _lasted("standing", *s)) for s in at_rest]


def _by_hand(felt: Signals) -> list[tuple[float, float]]:
    """Return the stretches of time in which a person drove."""
    return stretches(felt.manual, felt.t_s)


def _invasions(history: History, begin_s: float, end_s: float) -> list[Element]:
    """Return a stroke for each lane invasion."""
    return [
        e(
            "i",
            class_="stroke",
            title=f"{', '.join(event.markings)} at {history.frames['t_s'][event.tick]:.1f} s",
            style=f"left:{share(float(history.frames['t_s'][event.tick]), begin_s, end_s)}",
        )
        for event in history.lane_invasions
    ]


def _spans(spans: Sequence[TimelineSpan], begin_s: float, end_s: float) -> list[Element]:
    """Bars; the shortest can still be seen."""
    return [
        e(
            "i",
            span.label or None,
            class_=f"span {span.style}",
            title=span.title,
            style=f"left:{share(span.begin_s, begin_s, end_s)};"
            f"width:{percent((span.end_s - span.begin_s) / (end_s - begin_s))}",
        )
        for span in spans
    ]


def _lasted(what: str, begin_s: float, end_s: float) -> str:
    """Return a stretch of time in words."""
    return f"{what} from {begin_s:.1f} s to {end_s:.1f} s"
