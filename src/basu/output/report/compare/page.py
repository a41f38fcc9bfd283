"""``compare.html``: runs side by side in one page that opens offline, with the parts that a report is made of."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING
from urllib.parse import quote

from basu.output.report.compare.table import heads, remarks, rows, shared_bounds
from basu.output.report.html.page import REPORT_FILE, page
from basu.output.report.markup import e, extended, figure
from basu.output.report.plots import marks
from basu.output.report.plots.chart import Line, chart
from basu.output.report.plots.signals import signals
from basu.output.report.plots.town_map import plain_map
from basu.output.report.streets import bounds_of

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path
    from xml.etree.ElementTree import Element

    from basu.output.report.compare.table import Row
    from basu.output.report.reading import RunRecord
    from basu.output.report.streets import Bounds


def comparison(runs: Sequence[RunRecord], folders: Sequence[Path], beside: Path, more: Sequence[Element] = ()) -> bytes:
    """The page, to lie in the folder ``beside``; ``more`` stands below the table."""
    compared = rows(runs)
    shared = shared_bounds(runs)
    body = e("body", e("header", e("h1", "Comparison"), e("p", ", ".join(row.agent for row in compared))))
    extended(body, [e("p", remark) for remark in remarks(runs)])
    body.append(_table(compared, folders, beside))
    extended(body, more)
    pictures = e("div", class_="side-by-side")
    for run, row in zip(runs, compared, strict=True):
        pictures.append(_picture(run, row, shared))
    legend = e("p", class_="legends")
    for style, words in (("planned", "planned path"), ("driven", "driven path")):
        sample = e("svg", e("path", d="M0 5H26", class_=style), viewBox="0 0 26 10", class_="sample")
        legend.append(e("span", sample, words, class_="legend"))
    body.append(e("section", e("h2", "Paths and speeds"), legend, pictures))
    return page("Comparison of runs", body)


def _table(found: Sequence[Row], folders: Sequence[Path], beside: Path) -> Element:
    """As table 5.1; each agent's name opens its report."""
    body, named = e("tbody"), heads(found)
    for row, folder in zip(found, folders, strict=True):
        cells = [row.cell(head) for head in named]
        report = folder / REPORT_FILE
        name: Element | str = cells[0]
        if report.exists():
            name = e("a", cells[0], href=_address(report, beside))
        body.append(e("tr", e("th", name, scope="row"), *(e("td", cell) for cell in cells[1:])))
    head = e("thead", e("tr", *(e("th", head, scope="col") for head in named)))
    return e("section", e("h2", "Scores"), e("div", e("table", head, body), class_="wide"))


def _address(report: Path, beside: Path) -> str:
    """The way from the comparison to a report, as a browser writes it."""
    return quote(os.path.relpath(report.resolve(), beside.resolve()))


def _picture(run: RunRecord, row: Row, shared: Bounds | None) -> Element:
    """One run: its path and its speed."""
    caption = e("figcaption", e("b", row.agent), f": driving score {figure(row.driving)}", e("br"), row.ended)
    if run.history is None:
        return e("figure", caption, e("p", "Nothing was driven."))
    felt = signals(run.history)
    curves = [Line("driven", felt.speed_mps, "first"), Line("limit", felt.limit_mps, "limit", steps=True)]
    bounds = shared or bounds_of(run.history)
    places = [
        (marks.symbol(found.kind.value, str(number)), found.x_m, found.y_m)
        for number, found in enumerate(run.result.infractions, start=1)
    ]
    return e(
        "figure",
        caption,
        plain_map(run.history, run.streets, bounds, places),
        chart(felt.t_s, curves, title="Speed", unit="m/s"),
    )
