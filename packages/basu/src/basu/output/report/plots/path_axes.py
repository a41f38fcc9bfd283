"""What PNG files of paths have in common: streets, the plan, drives, infractions, and the figure's bytes.

matplotlib draws these files, because it brings its own fonts. Pages draw SVG.
"""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

from matplotlib.collections import LineCollection

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from basu.metrics.infraction import Evidence
    from basu.output.report.streets import Bounds, Line
    from basu.records.history import History

STREET, PLANNED, DRIVEN, MARK = "#d9d9d9", "#3182bd", "#e6550d", "#a50f15"


def show_map(axes: Axes, streets: Sequence[Line] | Sequence[NDArray[Any]], history: History, bounds: Bounds) -> None:
    """Draw the centre lines of lanes and, wide and pale, the plan of a record."""
    plan = history.facts.route.points_m
    axes.add_collection(LineCollection(list(streets), colors=STREET, linewidths=2.0, zorder=1))
    axes.plot(plan[:, 0], plan[:, 1], color=PLANNED, linewidth=5.0, alpha=0.45, label="planned", zorder=2)
    axes.set_xlim(bounds.west_m, bounds.east_m)
    axes.set_ylim(bounds.south_m, bounds.north_m)  # CARLA's y points south: north is up
    axes.set_aspect("equal")


def name_axes(axes: Axes) -> None:
    """Write what the axes measure."""
    axes.set_xlabel("x (east) in m")
    axes.set_ylabel("y (south) in m")


def show_start(axes: Axes, history: History) -> None:
    """Mark where the plan begins."""
    start = history.facts.route.points_m[0, :2]
    axes.plot(*start, marker="o", color="black", markersize=7, linestyle="none", label="start", zorder=5)


def show_drive(axes: Axes, history: History, name: str = "driven", colour: str = DRIVEN) -> None:
    """Draw a drive, thin."""
    frames = history.frames
    axes.plot(frames["x_m"], frames["y_m"], color=colour, linewidth=1.4, label=name, zorder=3)


def show_end(axes: Axes, history: History) -> None:
    """Mark where the drive ended."""
    x_m, y_m = history.frames["x_m"][-1], history.frames["y_m"][-1]
    axes.plot(x_m, y_m, "s", color=DRIVEN, markersize=7, label="end of the drive", zorder=5)


def show_infractions(axes: Axes, found: Sequence[Evidence], *, is_labelled: bool = True, is_named: bool = True) -> None:
    """Mark infractions: one label for the legend, and the kind beside each if they are named."""
    for number, each in enumerate(found):
        label = "infraction" if is_labelled and number == 0 else None
        axes.plot(each.x_m, each.y_m, "X", color=MARK, markersize=9, label=label, zorder=6)
        if is_named:
            place, away = (each.x_m, each.y_m), (6, -10)
            axes.annotate(each.kind.value, place, away, textcoords="offset points", fontsize=7, color=MARK)


def png(figure: Figure, dpi: int, bbox: str | None = None) -> bytes:
    """Return a figure as a PNG file; ``bbox`` is matplotlib's "tight" or None."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=dpi, metadata={"Software": None}, bbox_inches=bbox)
    return buffer.getvalue()
