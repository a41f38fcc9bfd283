"""The map of a run: streets, the planned and the driven path, signs, service stops and marks of what was found.

Lines are SVG in metres of CARLA's frame (x east, y south: north is up without any turning). Words and marks are HTML at
shares of its width and height, so that they keep their size on a telephone and can be reached by keyboard.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from basu.output.report import events
from basu.output.report.plots.chart import ticks
from basu.output.report.plots.decimate import path
from basu.output.report.plots.street_names import MarkPlace, placed_names
from basu.output.report.streets import bounds_of, on_the_map
from basu.output.report.templates import e, number, percent
from basu.routing import ControlKind

if TYPE_CHECKING:
    from collections.abc import Sequence
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray

    from basu.output.report.events import MarkedEvent
    from basu.output.report.streets import Bounds, Line, Streets
    from basu.records.history import History

TOLERANCE_M = 0.1  # which the paths may be off
GREATEST_WIDTH_PX, GREATEST_HEIGHT_PX = 1100.0, 760.0
CROWDED = 0.022  # marks nearer than this share of the map's larger side are stacked
STACKED_PX, SERVICE_PX = 22, 17


def town_map(history: History, streets: Streets, found: Sequence[MarkedEvent]) -> Element:
    """Return the whole map; its lines have ids, so that close-ups use them again."""
    bounds = bounds_of(history)
    frame = e("div", class_="map", id="map", style=box(bounds))
    frame.append(
        e(
            "svg",
            e("title", "Map of the planned and the driven path"),
            e("g", e("path", d=lines(streets.lines), class_="streets"), id="map-streets"),
            e("g", *paths(history), id="map-paths"),
            viewBox=view(bounds),
            role="img",
        )
    )
    plan, frames = history.facts.route.points_m, history.frames
    frame.extend(_names(history, streets, found, bounds))
    frame.append(_word("A", float(plan[0, 0]), float(plan[0, 1]), bounds, "end", "A: where the plan begins"))
    frame.append(_word("B", float(plan[-1, 0]), float(plan[-1, 1]), bounds, "end", "B: where the plan ends"))
    frame.append(_word("", float(frames["x_m"][-1]), float(frames["y_m"][-1]), bounds, "last", "where the drive ended"))
    frame.extend(_signs(history, bounds))
    frame.extend(_services(history, bounds))
    frame.extend(_marks(found, bounds))
    frame.append(e("i", class_="here", id="here", hidden="hidden"))
    frame.append(_scale(bounds))
    return frame


def plain_map(
    history: History, streets: Sequence[Line], bounds: Bounds, places: Sequence[tuple[Element, float, float]]
) -> Element:
    """Return a small map without words: paths on streets, with symbols at places (x, y in m)."""
    picture = e(
        "svg",
        e("title", "Map of the planned and the driven path"),
        e("path", d=lines(streets), class_="streets"),
        *paths(history),
        viewBox=view(bounds),
        role="img",
    )
    frame = e("div", picture, class_="map", style=box(bounds, height_px=520.0))
    plan, frames = history.facts.route.points_m, history.frames
    frame.append(_word("A", float(plan[0, 0]), float(plan[0, 1]), bounds, "end", "A: where the plan begins"))
    frame.append(_word("B", float(plan[-1, 0]), float(plan[-1, 1]), bounds, "end", "B: where the plan ends"))
    frame.append(_word("", float(frames["x_m"][-1]), float(frames["y_m"][-1]), bounds, "last", "end of the drive"))
    frame.extend(e("span", symbol, class_="at mark", style=place(x_m, y_m, bounds)) for symbol, x_m, y_m in places)
    frame.append(_scale(bounds))
    return frame


def paths(history: History) -> list[Element]:
    """Return the plan, wide and pale, and on it the drive."""
    frames = history.frames
    driven_m = on_the_map(np.column_stack([frames["x_m"], frames["y_m"]]))
    return [
        e("path", d=lines([path(history.facts.route.points_m, TOLERANCE_M)]), class_="planned"),
        e("path", d=lines([path(driven_m, TOLERANCE_M)]), class_="driven"),
    ]


def lines(found: Sequence[Sequence[tuple[float, float]]]) -> str:
    """Polylines as SVG writes them, to the decimetre."""
    return "".join(
        "M" + " ".join(f"{number(x_m, 1)} {number(y_m, 1)}" for x_m, y_m in line) for line in found if len(line)
    )


def view(bounds: Bounds) -> str:
    """Return the view box of a map's SVG."""
    return " ".join(number(v, 1) for v in (bounds.west_m, bounds.north_m, bounds.width_m, bounds.height_m))


def box(bounds: Bounds, width_px: float = GREATEST_WIDTH_PX, height_px: float = GREATEST_HEIGHT_PX) -> str:
    """Return the shape and the greatest size of a map, in CSS."""
    ratio = bounds.width_m / bounds.height_m
    return f"--ratio:{number(ratio, 4)};max-width:{number(min(width_px, height_px * ratio), 0)}px"


def place(x_m: float, y_m: float, bounds: Bounds) -> str:
    """Return where something lies on a map, in CSS."""
    left, top = (x_m - bounds.west_m) / bounds.width_m, (y_m - bounds.north_m) / bounds.height_m
    return f"left:{percent(left)};top:{percent(top)}"


def _word(text: str, x_m: float, y_m: float, bounds: Bounds, style: str, title: str, up_px: int = 0) -> Element:
    """Return a small label at a place, or so far above it."""
    return e("span", text, class_=f"at {style}", title=title, style=f"{place(x_m, y_m, bounds)};--up:{up_px}px")


def _names(history: History, streets: Streets, found: Sequence[MarkedEvent], bounds: Bounds) -> list[Element]:
    """Return the names of streets that have room beside all marks."""
    route = history.facts.route
    marks = [MarkPlace(x_m, y_m, 0.0) for x_m, y_m in route.points_m[[0, -1], :2].tolist()]
    for group, step_px in ((found, STACKED_PX), (route.stops, SERVICE_PX), (route.controls, 0)):
        places = [(float(each.x_m), float(each.y_m)) for each in group]
        marks += [MarkPlace(*at, step_px * up) for at, up in zip(places, _stacked(places, bounds), strict=True)]
    width_px = min(GREATEST_WIDTH_PX, GREATEST_HEIGHT_PX * bounds.width_m / bounds.height_m)
    return [
        e(
            "span",
            each.name,
            class_="at street minor" if each.is_minor else "at street",
            style=f"{place(each.x_m, each.y_m, bounds)};"
            f"--turn:{number(each.angle_deg, 1)}deg;--beside:{each.beside_px:g}px",
        )
        for each in placed_names(streets, bounds, width_px, marks)
    ]


def _services(history: History, bounds: Bounds) -> list[Element]:
    """Return the service stops of the route by name."""
    stops = history.facts.route.stops
    heights = _stacked([(stop.x_m, stop.y_m) for stop in stops], bounds)
    return [
        _word(
            stop.id, stop.x_m, stop.y_m, bounds, "service", f"service stop {stop.id}: {stop.name}", SERVICE_PX * height
        )
        for stop, height in zip(stops, heights, strict=True)
    ]


def _stacked(places_m: Sequence[tuple[float, float]], bounds: Bounds) -> list[int]:
    """Return how many of the places before each lie so near that it has to be shown above them."""
    near_m = CROWDED * max(bounds.width_m, bounds.height_m)
    seen: NDArray[np.float64] = np.array(places_m, dtype=np.float64).reshape(-1, 2)
    return [int(np.count_nonzero(np.hypot(*(seen[:index] - seen[index]).T) < near_m)) for index in range(len(places_m))]


def _signs(history: History, bounds: Bounds) -> list[Element]:
    """Return the stop signs of the route, each once."""
    signs = {c.landmark_id: c for c in history.facts.route.controls if c.kind is ControlKind.STOP_SIGN}
    return [
        e("i", class_="at sign", title=f"stop sign {sign.landmark_id}", style=place(sign.x_m, sign.y_m, bounds))
        for sign in signs.values()
    ]


def _marks(found: Sequence[MarkedEvent], bounds: Bounds) -> list[Element]:
    """Return a mark for each event, those at one place stacked, each a link to its evidence."""
    heights = _stacked([(event.x_m, event.y_m) for event in found], bounds)
    return [
        events.link(event, f"{place(event.x_m, event.y_m, bounds)};--up:{STACKED_PX * height}px")
        for event, height in zip(found, heights, strict=True)
    ]


def _scale(bounds: Bounds) -> Element:
    """Return a length to compare with, and where north is."""
    length_m = ticks(0.0, bounds.width_m, 5)[1]
    return e(
        "div",
        e("span", f"{length_m:g} m"),
        e("b", "↑ N"),
        class_="scale",
        style=f"width:{percent(length_m / bounds.width_m)}",
    )
