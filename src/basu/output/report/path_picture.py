"""``path.png``: the path driven against the path planned, on the streets of the town."""

from __future__ import annotations

import io
import math
from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from basu.files import write_bytes
from basu.metrics.score import infractions
from basu.output.report.streets import bounds_of

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from basu.metrics.scoring import Scoring
    from basu.output.report.streets import Line
    from basu.records.history import History


CROWDED_M = 60.0  # stops nearer to each other than this have their names one below the other
MOST_INCHES = np.array([9.0, 14.0])  # of the map: width, height
LEAST_INCHES, DPI = 7.0, 130  # of the picture's width, which the legend needs
LEFT_INCHES, RIGHT_INCHES, TITLE_INCHES, LEGEND_INCHES = 0.75, 0.2, 0.4, 0.85
STREET, PLANNED, DRIVEN, MARK = "#d9d9d9", "#3182bd", "#e6550d", "#a50f15"


def draw(
    path: Path,
    history: History,
    streets: Sequence[Line] | Sequence[NDArray[np.float64]],
    title: str,
    scoring: Scoring | None = None,
) -> None:
    """Write the picture, with the infractions that ``scoring`` makes of the drive.

    ``streets`` are the centre lines of the lanes around, each (K, 2) in m, CARLA frame.
    """
    bounds = bounds_of(history)
    figure, axes = _sheet(np.array([bounds.width_m, bounds.height_m]))
    axes.add_collection(LineCollection(list(streets), colors=STREET, linewidths=2.0, zorder=1))
    _paths(axes, history)
    _marks(axes, history, scoring)
    axes.set_xlim(bounds.west_m, bounds.east_m)
    axes.set_ylim(bounds.south_m, bounds.north_m)  # CARLA's y points south: north is up
    axes.set_aspect("equal")
    axes.set_xlabel("x (east) in m")
    axes.set_ylabel("y (south) in m")
    axes.set_title(title)
    figure.legend(loc="lower center", ncols=5, frameon=False)
    buffer = io.BytesIO()
    with mpl.rc_context({"savefig.bbox": None}):
        figure.savefig(buffer, format="png", dpi=DPI, metadata={"Software": None})
    write_bytes(path, buffer.getvalue())


def _sheet(spread_m: NDArray[np.float64]) -> tuple[Figure, Axes]:
    """Return a figure and axes in it for a map of this width and height.

    Its margins are fixed. A layout that matplotlib finds by itself draws everything twice more.
    """
    width, height = spread_m * (MOST_INCHES / spread_m).min()
    whole = max(width + LEFT_INCHES + RIGHT_INCHES, LEAST_INCHES), height + LEGEND_INCHES + TITLE_INCHES
    figure = Figure(figsize=whole)
    left = LEFT_INCHES + (whole[0] - width - LEFT_INCHES - RIGHT_INCHES) / 2.0
    axes = figure.add_axes((left / whole[0], LEGEND_INCHES / whole[1], width / whole[0], height / whole[1]))
    return figure, axes


def _paths(axes: Axes, history: History) -> None:
    """The plan below, wide and pale; the drive on it, thin."""
    route, frames = history.facts.route, history.frames
    plan = route.points_m
    axes.plot(plan[:, 0], plan[:, 1], color=PLANNED, linewidth=5.0, alpha=0.45, label="planned", zorder=2)
    axes.plot(frames["x_m"], frames["y_m"], color=DRIVEN, linewidth=1.4, label="driven", zorder=3)
    axes.plot(*plan[0, :2], marker="o", color="black", markersize=7, linestyle="none", label="start", zorder=5)
    axes.plot(frames["x_m"][-1], frames["y_m"][-1], "s", color=DRIVEN, markersize=7, label="end of the drive", zorder=5)


def _marks(axes: Axes, history: History, scoring: Scoring | None) -> None:
    """Service stops by name, infractions by kind."""
    stops = history.facts.route.stops
    west_m, east_m = history.facts.route.points_m[:, 0].min(), history.facts.route.points_m[:, 0].max()
    for number, stop in enumerate(stops):
        near = sum(math.hypot(stop.x_m - s.x_m, stop.y_m - s.y_m) < CROWDED_M for s in stops[:number])
        axes.plot(stop.x_m, stop.y_m, marker="D", color=PLANNED, markersize=6, zorder=4)
        is_east = stop.x_m > west_m + 0.7 * (east_m - west_m)  # a name there would leave the picture
        axes.annotate(
            stop.name,
            (stop.x_m, stop.y_m),
            xytext=(-6 if is_east else 6, 6 - 16 * near),
            ha="right" if is_east else "left",
            textcoords="offset points",
            fontsize=7,
        )
    for number, found in enumerate(infractions(history, scoring)):
        axes.plot(
            found.x_m,
            found.y_m,
            marker="X",
            color=MARK,
            markersize=9,
            linestyle="none",
            label="infraction" if number == 0 else None,
            zorder=6,
        )
        axes.annotate(
            found.kind.value,
            (found.x_m, found.y_m),
            xytext=(6, -10),
            textcoords="offset points",
            fontsize=7,
            color=MARK,
        )
