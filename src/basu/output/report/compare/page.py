"""``compare.html``: runs side by side in one page that opens offline, with the parts that a report is made of."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING
from urllib.parse import quote

from basu.output.report.compare.table import heads, remarks, rows, shared_bounds
from basu.output.report.html.page import REPORT_FILE, legend, page
from basu.output.report.plots import marks
from basu.output.report.plots.chart import Line, chart
from basu.output.report.plots.signals import signals
from basu.output.report.plots.town_map import plain_map
from basu.output.report.streets import bounds_of
from basu.output.report.templates import render

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path
    from xml.etree.ElementTree import Element

    from basu.output.report.reading import RunRecord
    from basu.output.report.streets import Bounds


def comparison(runs: Sequence[RunRecord], folders: Sequence[Path], beside: Path, more: Sequence[Element] = ()) -> bytes:
    """The page, to lie in the folder ``beside``; ``more`` stands below the table."""
    compared, shared = rows(runs), shared_bounds(runs)
    named, reports = heads(compared), [folder / REPORT_FILE for folder in folders]
    body = render(
        "compare/templates/compare.j2",
        agents=[row.agent for row in compared],
        remarks=remarks(runs),
        heads=named,
        rows=[
            (_address(path, beside) if path.exists() else None, [row.cell(head) for head in named])
            for row, path in zip(compared, reports, strict=True)
        ],
        more=more,
        legend=legend(),
        figures=[
            (row.agent, row.cell("driving score"), row.ended, _pictures(run, shared))
            for run, row in zip(runs, compared, strict=True)
        ],
    )
    return page("Comparison of runs", body)


def _address(report: Path, beside: Path) -> str:
    """The way from the comparison to a report, as a browser writes it."""
    return quote(os.path.relpath(report.resolve(), beside.resolve()))


def _pictures(run: RunRecord, shared: Bounds | None) -> list[Element]:
    """One run: its path and its speed; none where nothing was driven."""
    if run.history is None:
        return []
    felt = signals(run.history)
    curves = [Line("driven", felt.speed_mps, "first"), Line("limit", felt.limit_mps, "limit", steps=True)]
    bounds = shared or bounds_of(run.history)
    places = [
        (marks.symbol(found.kind.value, str(number)), found.x_m, found.y_m)
        for number, found in enumerate(run.result.infractions, start=1)
    ]
    return [
        plain_map(run.history, run.streets, bounds, places),
        chart(felt.t_s, curves, title="Speed", unit="m/s"),
    ]
