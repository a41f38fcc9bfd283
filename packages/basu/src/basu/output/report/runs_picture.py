"""Pictures of one or several runs on one sheet: their paths on the streets, and their speeds with the limit."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from basu.output.report.plots.path_axes import (
    MARK,
    name_axes,
    png,
    show_drive,
    show_infractions,
    show_map,
    show_start,
)
from basu.output.report.streets import bounds_of, union

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.metrics.infraction import Evidence
    from basu.output.report.streets import Line
    from basu.records.history import History


WIDTH_INCHES, LEAST_INCHES, GREATEST_INCHES, DPI = 8.0, 2.4, 8.0, 100
LIMIT = "#636363"
COLOURS = ("#e6550d", "#3182bd", "#31a354", "#756bb1", "#8c6d31")  # one a run, in turn


class Trace(NamedTuple):
    """A run as it is drawn."""

    name: str
    history: History
    infractions: Sequence[Evidence]


def paths_png(runs: Sequence[Trace], streets: Sequence[Line]) -> bytes:
    """Return the paths of runs by name, over the first one's planned route, as PNG. Streets are centre lines in m."""
    first, bounds = runs[0].history, union([bounds_of(run.history) for run in runs])
    height = float(np.clip(WIDTH_INCHES * bounds.height_m / bounds.width_m, LEAST_INCHES, GREATEST_INCHES)) + 0.8
    figure = Figure(figsize=(WIDTH_INCHES, height), layout="constrained")
    axes = figure.add_subplot()
    show_map(axes, streets, first, bounds)
    for number, (name, run) in enumerate(zip(_distinct([run.name for run in runs]), runs, strict=True)):
        show_drive(axes, run.history, name, COLOURS[number % len(COLOURS)])
        show_infractions(axes, run.infractions, is_labelled=number == 0)
    show_start(axes, first)
    name_axes(axes)
    figure.legend(loc="outside lower center", ncols=5, frameon=False)
    return png(figure, DPI)


def speeds_png(runs: Sequence[Trace], *, along_route: bool) -> bytes:
    """Return the speeds of runs by name, over time or along the route, with the first one's posted limit, as PNG."""
    names = _distinct([run.name for run in runs])
    column = "route_s_m" if along_route else "t_s"
    figure = Figure(figsize=(WIDTH_INCHES, 3.2), layout="constrained")
    axes = figure.add_subplot()
    frames = runs[0].history.frames
    limit = np.where(frames["speed_limit_mps"] > 0.0, frames["speed_limit_mps"], np.nan)
    axes.plot(frames[column], limit, color=LIMIT, linewidth=1.0, linestyle="--", label="posted limit")
    for number, (name, run) in enumerate(zip(names, runs, strict=True)):
        speed_mps, along = run.history.speed_mps(), run.history.frames[column]
        axes.plot(along, speed_mps, color=COLOURS[number % len(COLOURS)], linewidth=1.4, label=name)
        for found in run.infractions:
            axes.plot(along[found.tick], speed_mps[found.tick], "X", color=MARK, markersize=8, zorder=6)
    axes.set_xlabel("along the route in m" if along_route else "time in s")
    axes.set_ylabel("speed in m/s")
    axes.set_ylim(bottom=0.0)
    axes.grid(color="#eeeeee")
    figure.legend(loc="outside lower center", ncols=5, frameon=False)
    return png(figure, DPI)


def _distinct(names: Sequence[str]) -> list[str]:
    """Return the names, numbered where one occurs several times."""
    return [
        name if names.count(name) == 1 else f"{name} ({names[: number + 1].count(name)})"
        for number, name in enumerate(names)
    ]
