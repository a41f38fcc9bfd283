"""``path.png``: the path driven against the path planned, on the streets of the town."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from basu.files import write_bytes
from basu.metrics.score import infractions
from basu.output.report.plots.path_axes import (
    PLANNED,
    name_axes,
    png,
    show_drive,
    show_end,
    show_infractions,
    show_map,
    show_start,
)
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
    show_map(axes, streets, history, bounds)
    show_drive(axes, history)
    show_start(axes, history)
    show_end(axes, history)
    _name_stops(axes, history)
    show_infractions(axes, infractions(history, scoring))
    name_axes(axes)
    axes.set_title(title)
    figure.legend(loc="lower center", ncols=5, frameon=False)
    write_bytes(path, png(figure, DPI))


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


def _name_stops(axes: Axes, history: History) -> None:
    """Mark the service stops, with their names."""
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
