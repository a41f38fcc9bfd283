"""``compare.html``: reads runs from their folders and writes page and picture of their comparison."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, NamedTuple
from urllib.parse import quote

import numpy as np

from basu.errors import UserError
from basu.files import write_bytes
from basu.output.report import events
from basu.output.report.comparison import (
    DIFFERENT_CONDITIONS,
    different_conditions,
    heads,
    histories,
    reasons,
    remarks,
    rows,
    shared_bounds,
    tables,
    text,
)
from basu.output.report.comparison_picture import draw
from basu.output.report.documents import REPORT_FILE, read_run
from basu.output.report.html.page import legend, page
from basu.output.report.plots.chart import Curve, chart
from basu.output.report.plots.signals import signals
from basu.output.report.plots.town_map import plain_map
from basu.output.report.streets import bounds_of
from basu.output.report.templates import render
from basu.output.report.tracks import titled

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path
    from xml.etree.ElementTree import Element

    from basu.output.report.comparison import ComparedRun
    from basu.output.report.documents import RunRecord
    from basu.output.report.streets import Bounds


MOST_BESIDE = 4  # runs that stand as columns, so that the table fits a phone


def comparison(runs: Sequence[RunRecord], folders: Sequence[Path], beside: Path, more: Sequence[Element] = ()) -> bytes:
    """Return the page, to lie in the folder ``beside``; ``more`` stands below the table."""
    compared, shared, axes = rows(runs), shared_bounds(runs), _axes(runs)
    reports = {row.agent: folder / REPORT_FILE for row, folder in zip(compared, folders, strict=True)}
    groups = tables(compared)
    body = render(
        "templates/comparison.j2",
        agents=[row.agent for row in compared],
        different=DIFFERENT_CONDITIONS,
        conditions=different_conditions(runs),
        remarks=[*remarks(runs, conditions=False), *reasons(runs)],
        tables=[
            _scores(group, reports, beside, titled(track) if len(groups) > 1 else "") for track, group in groups.items()
        ],
        more=more,
        legend=legend(),
        figures=[
            (
                row.agent,
                titled(row.track) if row.track else "",
                row.cell("driving score"),
                row.ended,
                _pictures(run, shared, axes),
            )
            for run, row in zip(runs, compared, strict=True)
        ],
    )
    return page("Comparison of runs", body)


def _scores(found: Sequence[ComparedRun], reports: Mapping[str, Path], beside: Path, title: str) -> dict[str, Any]:
    """Return the table of one track; ``reports`` are the pages of the runs by agent."""
    named = heads(found)
    return {
        "title": title,
        "heads": named,
        "rows": [
            (
                _address(reports[row.agent], beside) if reports[row.agent].exists() else None,
                [row.cell(head) for head in named],
            )
            for row in found
        ],
        "is_upright": len(found) <= MOST_BESIDE,
    }


def _address(report: Path, beside: Path) -> str:
    """Return the way from the comparison to a report, as a browser writes it."""
    return quote(os.path.relpath(report.resolve(), beside.resolve()))


class _Axes(NamedTuple):
    """The axes that the speeds of all runs fit into."""

    end_s: float
    highest_mps: float


def _axes(runs: Sequence[RunRecord]) -> _Axes:
    """Return the longest time and the highest speed or limit of all runs; zeros if nothing was driven."""
    felt = [signals(history) for history in histories(runs)]
    highest_mps = [np.nanmax([*each.speed_mps, *each.limit_mps], initial=0.0) for each in felt]
    return _Axes(max((float(each.t_s[-1]) for each in felt), default=0.0), float(max(highest_mps, default=0.0)))


def _pictures(run: RunRecord, shared: Bounds | None, axes: _Axes) -> list[Element]:
    """Return the path and the speed of a run; nothing if nothing was driven."""
    if run.history is None:
        return []
    felt = signals(run.history)
    curves = [Curve("driven", felt.speed_mps, "first"), Curve("limit", felt.limit_mps, "limit", steps=True)]
    bounds = shared or bounds_of(run.history)
    places = [
        (events.symbol(found.kind.value, str(number)), found.x_m, found.y_m)
        for number, found in enumerate(run.result.infractions, start=1)
    ]
    return [
        plain_map(run.history, run.streets.lines, bounds, places),
        chart(
            felt.t_s,
            curves,
            title="Speed",
            unit="m/s",
            least_range=(0.0, axes.highest_mps),
            least_end_s=axes.end_s,
        ),
    ]


PAGE_FILE, PICTURE_FILE = "compare.html", "compare.png"


def compare(folders: Sequence[Path], output: Path, more: Sequence[Element] = ()) -> str:
    """Write both files into ``output``; ``more`` stands below the table of the page.

    Raises:
        UserError: a folder is no run's, or ``output`` cannot be written.
    """
    runs = [read_run(folder) for folder in folders]
    try:
        output.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"{output} could not be made: {error.strerror}; name another place with --output") from error
    write_bytes(output / PAGE_FILE, comparison(runs, folders, output, more))
    draw(output / PICTURE_FILE, runs)
    return "\n".join([_table(runs), str(output / PAGE_FILE), str(output / PICTURE_FILE)])


def compared(folders: Sequence[Path]) -> str:
    """Return the table of a comparison with its remarks; nothing is written.

    Raises:
        UserError: a folder is no run's.
    """
    return _table([read_run(folder) for folder in folders])


def _table(runs: Sequence[RunRecord]) -> str:
    return "\n".join([text(rows(runs)), *remarks(runs), *reasons(runs)])
