"""``compare.png``: the paths of runs side by side."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from basu.files import write_bytes
from basu.output.report.comparison import rows, shared_bounds
from basu.output.report.plots.path_axes import png, show_drive, show_end, show_infractions, show_map
from basu.output.report.streets import bounds_of
from basu.output.report.templates import figure as figure_text
from basu.output.report.tracks import titled

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from basu.output.report.documents import RunRecord

MOST_COLUMNS, SIDE_INCHES, DPI = 4, 4.2, 110


def draw(path: Path, runs: Sequence[RunRecord]) -> None:
    """Write the picture; runs on one route share its frame.

    Raises:
        UserError: the disk is full or the folder cannot be written.
    """
    shared = shared_bounds(runs)
    columns = min(MOST_COLUMNS, len(runs))
    lines = math.ceil(len(runs) / columns)
    figure = Figure(figsize=(SIDE_INCHES * columns, (SIDE_INCHES + 1.0) * lines), layout="constrained")
    all_axes = figure.subplots(lines, columns, squeeze=False).flatten()
    for axes in all_axes[len(runs) :]:
        axes.set_axis_off()
    for axes, run, row in zip(all_axes, runs, rows(runs), strict=False):
        track = f", {titled(row.track)}" if row.track else ""
        axes.set_title(f"{row.agent}{track}: driving score {figure_text(row.driving)}", fontsize=11, parse_math=False)
        if run.history is None:
            axes.text(0.5, 0.5, "nothing was driven", ha="center", transform=axes.transAxes)
            axes.set_axis_off()
            continue
        show_map(axes, run.streets.lines, run.history, shared or bounds_of(run.history))
        show_drive(axes, run.history)
        show_end(axes, run.history)
        show_infractions(axes, run.result.infractions, is_named=False)
        plan = run.history.facts.route.points_m
        for name, end in (("A", plan[0]), ("B", plan[-1])):
            axes.annotate(name, end[:2], fontweight="bold", xytext=(6, 6), textcoords="offset points", zorder=7)
        axes.tick_params(labelsize=7)
    handles, labels = next((axes.get_legend_handles_labels() for axes in all_axes if axes.lines), ([], []))
    figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False)
    write_bytes(path, png(figure, DPI, "tight"))
