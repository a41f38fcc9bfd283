"""Pictures of one or several runs on one sheet: their paths on the streets, and their speeds with the limit."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from basu.metrics.infraction import Evidence
    from basu.output.report.streets import Line
    from basu.records.history import History


MARGIN_M = 30.0  # of street map around the paths
WIDTH_INCHES, LEAST_INCHES, GREATEST_INCHES, DPI = 8.0, 2.4, 8.0, 100
STREET, PLANNED, LIMIT, MARK = "#d9d9d9", "#9ecae1", "#636363", "#a50f15"
DRIVEN = ("#e6550d", "#3182bd", "#31a354", "#756bb1", "#8c6d31")  # one a run, in turn


class Trace(NamedTuple):
    """A run as it is drawn."""

    name: str
    history: History
    infractions: Sequence[Evidence]


def paths_png(runs: Sequence[Trace], streets: Sequence[Line]) -> bytes:
    """Return the paths of runs by name, over the first one's planned route, as PNG. Streets are centre lines in m."""
    names = _distinct([run.name for run in runs])
    route = runs[0].history.facts.route
    points = [route.points_m[:, :2], *(_places_m(run.history) for run in runs)]
    low = np.min([each.min(axis=0) for each in points], axis=0) - MARGIN_M
    high = np.max([each.max(axis=0) for each in points], axis=0) + MARGIN_M
    spread = high - low
    height = float(np.clip(WIDTH_INCHES * spread[1] / spread[0], LEAST_INCHES, GREATEST_INCHES)) + 0.8
    figure = Figure(figsize=(WIDTH_INCHES, height), layout="constrained")
    axes = figure.add_subplot()
    axes.add_collection(LineCollection([np.asarray(line)[:, :2] for line in streets], colors=STREET, linewidths=2.0))
    axes.plot(*route.points_m[:, :2].T, color=PLANNED, linewidth=6.0, label="planned")
    for number, (name, run) in enumerate(zip(names, runs, strict=True)):
        colour = DRIVEN[number % len(DRIVEN)]
        axes.plot(*_places_m(run.history).T, color=colour, linewidth=1.6, label=name, zorder=3)
        _mark_infractions(axes, run.infractions, is_first=number == 0)
    axes.plot(*route.points_m[0, :2], marker="o", color="black", linestyle="none", label="start", zorder=5)
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(high[1], low[1])  # CARLA's y points south: north is up
    axes.set_aspect("equal")
    axes.set_xlabel("x (east) in m")
    axes.set_ylabel("y (south) in m")
    figure.legend(loc="outside lower center", ncols=5, frameon=False)
    return _png(figure)


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
        axes.plot(along, speed_mps, color=DRIVEN[number % len(DRIVEN)], linewidth=1.4, label=name)
        for found in run.infractions:
            axes.plot(along[found.tick], speed_mps[found.tick], "X", color=MARK, markersize=8, zorder=6)
    axes.set_xlabel("along the route in m" if along_route else "time in s")
    axes.set_ylabel("speed in m/s")
    axes.set_ylim(bottom=0.0)
    axes.grid(color="#eeeeee")
    figure.legend(loc="outside lower center", ncols=5, frameon=False)
    return _png(figure)


def _mark_infractions(axes: Axes, infractions: Sequence[Evidence], *, is_first: bool) -> None:
    for number, found in enumerate(infractions):
        label = "infraction" if is_first and number == 0 else None
        axes.plot(found.x_m, found.y_m, "X", color=MARK, markersize=9, label=label, zorder=6)
        axes.annotate(
            found.kind.value, (found.x_m, found.y_m), (6, -10), textcoords="offset points", fontsize=7, color=MARK
        )


def _distinct(names: Sequence[str]) -> list[str]:
    """Return the names, numbered where one occurs several times."""
    return [
        name if names.count(name) == 1 else f"{name} ({names[: number + 1].count(name)})"
        for number, name in enumerate(names)
    ]


def _places_m(history: History) -> NDArray[np.float64]:
    """(T, 2) where the vehicle was."""
    return np.column_stack([history.frames["x_m"], history.frames["y_m"]])


def _png(figure: Figure) -> bytes:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=DPI, metadata={"Software": None})
    return buffer.getvalue()
