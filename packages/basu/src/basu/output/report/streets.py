"""``streets.json``: the lanes around a run as lines, so that its map can be drawn again from its folder alone."""

from __future__ import annotations

import json
import re
from itertools import zip_longest
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.errors import UserError
from basu.files import loads, write_bytes
from basu.output.report.plots.decimate import path

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from basu.records.history import History
    from basu.routing.lane_graph import Street

STREETS_FILE = "streets.json"
SCHEMA_VERSION = 1
MARGIN_M = 40.0  # of street map around the route and the drive
EDGE_M = 1e6  # no town is so large
TOLERANCE_M = 0.25  # which a lane's line may be off

Line = list[tuple[float, float]]  # x, y in m, CARLA frame
GENERATED = re.compile(r"unnamed\b|road\s*\d*$", re.IGNORECASE)  # names that map editors give: "Road 12"


class Streets(NamedTuple):
    """The lanes around a run as lines, and the name of each lane's street; empty where it has none."""

    lines: list[Line]
    names: list[str]


class Bounds(NamedTuple):
    """A rectangle in m, CARLA frame."""

    west_m: float
    north_m: float  # y points south: north is the smaller one
    east_m: float
    south_m: float

    @property
    def width_m(self) -> float:
        """From west to east."""
        return self.east_m - self.west_m

    @property
    def height_m(self) -> float:
        """From north to south."""
        return self.south_m - self.north_m


def bounds_of(history: History, margin_m: float = MARGIN_M) -> Bounds:
    """Return what a map of this run has to show: the plan and the drive, with a margin."""
    plan, frames = history.facts.route.points_m, history.frames
    shown = np.concatenate([plan[:, :2], on_the_map(np.column_stack([frames["x_m"], frames["y_m"]]))])
    west_m, north_m = shown.min(axis=0).tolist()
    east_m, south_m = shown.max(axis=0).tolist()
    return Bounds(west_m - margin_m, north_m - margin_m, east_m + margin_m, south_m + margin_m)


def on_the_map(points_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Those of the points (N, 2) that are anywhere: a simulator may lose a vehicle into nan or beyond the world."""
    return points_m[(np.abs(points_m) < EDGE_M).all(axis=1)]


def union(found: Sequence[Bounds]) -> Bounds:
    """Return the rectangle around all of them."""
    west_m, north_m, east_m, south_m = zip(*found, strict=True)
    return Bounds(min(west_m), min(north_m), max(east_m), max(south_m))


def around(streets: Sequence[Street], history: History | None) -> Streets:
    """Return those of ``streets`` that come near the run, straight stretches thinned out; none without a record."""
    found = Streets([], [])
    if history is None:
        return found
    west_m, north_m, east_m, south_m = bounds_of(history)
    for lane, name in streets:
        x_m, y_m = lane[:, 0], lane[:, 1]
        if x_m.max() >= west_m and x_m.min() <= east_m and y_m.max() >= north_m and y_m.min() <= south_m:
            found.lines.append([(round(x, 2), round(y, 2)) for x, y in path(lane, TOLERANCE_M)])
            found.names.append("" if GENERATED.match(name) else name)
    return found


def write_streets(folder: Path, streets: Streets) -> None:
    """Write ``streets.json``.

    Raises:
        UserError: the disk is full or the folder cannot be written.
    """
    document = {"schema_version": SCHEMA_VERSION, "lanes_m": streets.lines, "names": streets.names}
    write_bytes(folder / STREETS_FILE, json.dumps(document, separators=(",", ":")).encode())


def read_streets(folder: Path) -> Streets:
    """Return the lanes of a run folder; none, or none with names, where it is older than these.

    Raises:
        UserError: the file is not what it should be.
    """
    file = folder / STREETS_FILE
    if not file.exists():
        return Streets([], [])
    try:
        document = loads(file.read_text(encoding="utf-8"))
        lines = [[(float(x), float(y)) for x, y in lane] for lane in document["lanes_m"]]
        return Streets(lines, [str(name) for _, name in zip_longest(lines, document.get("names", []), fillvalue="")])
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise UserError(f"{file} is no map of streets: {error!r}; without the file, the report has none") from error
