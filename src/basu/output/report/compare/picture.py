"""``compare.png``: the driven against the planned path of each run, side by side, as figure 5.3 of the thesis."""

from __future__ import annotations

import io
import math
from typing import TYPE_CHECKING

import matplotlib as mpl
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from basu.output.report.compare.table import rows, shared_bounds
from basu.output.report.markup import figure as written
from basu.output.report.streets import bounds_of
from basu.utils.atomic import write_bytes

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from matplotlib.axes import Axes

    from basu.output.report.reading import RunRecord
    from basu.output.report.streets import Bounds

MOST_COLUMNS, SIDE_INCHES, DPI = 4, 4.2, 110
STREET, PLANNED, DRIVEN = "#d9d9d9", "#3182bd", "#a33b00"


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
        axes.set_title(f"{row.agent}: driving score {written(row.driving)}", fontsize=11, parse_math=False)
        if run.history is None:
            axes.text(0.5, 0.5, "nothing was driven", ha="center", transform=axes.transAxes)
            axes.set_axis_off()
        else:
            _paths(axes, run, shared or bounds_of(run.history))
    handles, labels = next((axes.get_legend_handles_labels() for axes in all_axes if axes.lines), ([], []))
    figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False)
    buffer = io.BytesIO()
    with mpl.rc_context({"savefig.bbox": "tight"}):
        figure.savefig(buffer, format="png", dpi=DPI, metadata={"Software": None})
    write_bytes(path, buffer.getvalue())


def _paths(axes: Axes, run: RunRecord, bounds: Bounds) -> None:
    """One run on its streets."""
    assert run.history is not None  # draw asks
    plan, frames = run.history.facts.route.points_m, run.history.frames
    axes.add_collection(LineCollection(run.streets, colors=STREET, linewidths=2.0, zorder=1))
    axes.plot(plan[:, 0], plan[:, 1], color=PLANNED, linewidth=5.0, alpha=0.45, label="planned", zorder=2)
    axes.plot(frames["x_m"], frames["y_m"], color=DRIVEN, linewidth=1.4, label="driven", zorder=3)
    axes.plot(frames["x_m"][-1], frames["y_m"][-1], "s", color=DRIVEN, markersize=6, label="end of the drive", zorder=5)
    for number, infraction in enumerate(run.result.infractions):
        label = "infraction" if number == 0 else None
        axes.plot(infraction.x_m, infraction.y_m, "X", color="black", markersize=8, label=label, zorder=6)
    for name, end in (("A", plan[0]), ("B", plan[-1])):
        axes.annotate(name, end[:2], fontweight="bold", xytext=(6, 6), textcoords="offset points", zorder=7)
    axes.set_xlim(bounds.west_m, bounds.east_m)
    axes.set_ylim(bounds.south_m, bounds.north_m)  # CARLA's y points south: north is up
    axes.set_aspect("equal")
    axes.tick_params(labelsize=7)
