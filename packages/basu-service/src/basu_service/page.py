"""``service.html``: the figures of a service, its vehicles over time and place, and its calls."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.files import write_bytes
from basu.output.report.html.page import page
from basu.output.report.templates import drawn, e
from basu_service.console import facts

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path
    from xml.etree.ElementTree import Element

    from basu_service.document import ServiceDocument
    from basu_service.operator import Trace
    from basu_service.plan import ServicePlan

PAGE_FILE = "service.html"
STYLE = "table.facts th{white-space:nowrap;width:9em}table.facts td{text-align:left}"
WIDE, HIGH, LEFT, TOP, BELOW = 900.0, 420.0, 60.0, 10.0, 34.0
COLOURS = ("#0b6e99", "#c2410c", "#15803d", "#7e22ce", "#a16207", "#be123c", "#334155", "#0f766e")
JUMP_SHARE = 0.5  # of a round between two seconds: the vehicle has begun the next one


def write_page(folder: Path, document: ServiceDocument, plan: ServicePlan, traces: Sequence[Sequence[Trace]]) -> None:
    """Write the page into a run's folder.

    Raises:
        UserError: the disk is full or the folder cannot be written.
    """
    rows = [e("tr", e("th", name, scope="row"), e("td", value)) for name, value in facts(document)]
    names = ("vehicle", "stop", "arrival", "departure", "planned", "held", "boarded", "alighted", "left behind")
    calls = [
        e("tr", *(e("td", text) for text in (
            str(call["vehicle"]), call["stop"], _clock(call["arrival_s"]), _clock(call["departure_s"]),
            _clock(call["planned_departure_s"]), f"{call['held_s']:.0f} s", str(call["boarded"]), str(call["alighted"]),
            str(call["left_behind"]),
        )))
        for call in document["calls"]
    ]  # fmt: skip
    body = e(
        "body",
        e("header", e("h1", "Service"), e("p", f"{document['begins']}, demand {document['demand']}")),
        e("section", e("h2", "Figures"), e("table", e("tbody", *rows), class_="facts")),
        e(
            "section",
            e("h2", "Vehicles over time"),
            e(
                "p",
                "Each line is a vehicle: time to the right, place in the round upwards. At level pieces it stands.",
            ),
            _diagram(document, plan, traces),
        ),
        e(
            "section",
            e("h2", "Calls"),
            e("p", "Times are minutes and seconds from the beginning of the service."),
            e(
                "div",
                e("table", e("thead", e("tr", *(e("th", name) for name in names))), e("tbody", *calls)),
                class_="wide",
            ),
        ),
        e("section", e("h2", "More"), e("p", e("a", "Report of vehicle 1", href="report.html"))),
    )
    write_bytes(folder / PAGE_FILE, page("Service", drawn(body), style=STYLE))


def _clock(value_s: float | None) -> str:
    return "-" if value_s is None else f"{int(value_s // 60)}:{int(value_s % 60):02d}"


def _diagram(document: ServiceDocument, plan: ServicePlan, traces: Sequence[Sequence[Trace]]) -> Element:
    """Draw place in the round over time."""
    lasts_s = max(document["lasts_s"], 1.0)

    def x(t_s: float) -> float:
        return LEFT + (WIDE - LEFT - 10.0) * t_s / lasts_s

    def y(place_m: float) -> float:
        return TOP + (HIGH - TOP - BELOW) * (1.0 - place_m / plan.length_m)

    parts: list[Element] = []
    for stop_id, place_m in plan.places_m:
        parts.append(
            e("line", x1=LEFT, x2=WIDE - 10.0, y1=y(place_m), y2=y(place_m), stroke="#999", stroke_dasharray="3 4")
        )
        parts.append(
            e("text", stop_id, x=LEFT - 6.0, y=y(place_m) + 4.0, text_anchor="end", font_size=12, fill="currentColor")
        )
    step_min = 5 if lasts_s > 900.0 else 1
    for minute in range(0, int(lasts_s // 60) + 1, step_min):
        label = str(minute) if minute else "0 min"
        parts.append(
            e("text", label, x=x(60.0 * minute), y=HIGH - 12.0, text_anchor="middle", font_size=12, fill="currentColor")
        )
    for number, trace in enumerate(traces):
        parts.append(
            e("text", f"vehicle {number + 1}", x=LEFT + 80.0 * number, y=HIGH + 4.0, font_size=12, fill=COLOURS[number])
        )
        for piece in _pieces(trace, plan.length_m):
            points = " ".join(f"{x(t_s):.1f},{y(place_m):.1f}" for t_s, place_m in piece)
            parts.append(e("polyline", points=points, fill="none", stroke=COLOURS[number], stroke_width=2))
    return e(
        "svg",
        *parts,
        viewBox=f"0 0 {WIDE:.0f} {HIGH + 10.0:.0f}",
        width="100%",
        role="img",
        xmlns="http://www.w3.org/2000/svg",
    )


def _pieces(trace: Sequence[Trace], length_m: float) -> list[list[tuple[float, float]]]:
    """Return the places of a vehicle in the round, cut where a new round begins."""
    pieces: list[list[tuple[float, float]]] = []
    before_m = -1.0
    for t_s, place_m in trace:
        if not pieces or abs(place_m - before_m) > JUMP_SHARE * length_m:
            pieces.append([])
        pieces[-1].append((t_s, place_m))
        before_m = place_m
    return pieces
