"""Actors from above: their boxes at one moment, and their trails with a dot a second."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.output.report.plots.decimate import path
from basu.output.report.streets import on_the_map
from basu.output.report.templates import DASH, e, number

if TYPE_CHECKING:
    from collections.abc import Sequence
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray

    from basu.output.report.scenarios.drawing.canvas import Canvas
    from basu.output.report.scenarios.drawing.encounter import Box, Point, Span
    from basu.records.history import History


LEAST_HALF_PX = 3.5  # half of the shorter side: a walker is small, and is to be seen
NOSE = 0.55  # from there on a box narrows to its front
ROUND_HALF_M = 0.6  # an actor not longer than twice this has no visible front


def body(box: Box, canvas: Canvas, style: str) -> Element:
    """Return a vehicle, pointed at its front; a circle for a person on foot."""
    x_m, y_m, _, half_length_m, half_width_m = box.tolist()
    if max(half_length_m, half_width_m) <= ROUND_HALF_M:
        x, y = canvas.at(x_m, y_m)
        radius = max(LEAST_HALF_PX + 1.0, (half_length_m + half_width_m) / 2.0 * canvas.pixels_per_m)
        return e("circle", cx=number(x, 1), cy=number(y, 1), r=number(radius, 1), class_=style)
    return e("polygon", points=_written(outline(box, canvas, nose=NOSE)), class_=style)


def block(box: Box, canvas: Canvas, style: str) -> Element:
    """Something that has no front."""
    return e("polygon", points=_written(outline(box, canvas, nose=1.0)), class_=style)


def outline(box: Box, canvas: Canvas, nose: float) -> list[Point]:
    """Return the corners in pixels, front left first; ``nose`` is where on its half length a box begins to narrow."""
    x_m, y_m, yaw_rad, half_length_m, half_width_m = box.tolist()
    least_m = LEAST_HALF_PX / canvas.pixels_per_m
    long_m, wide_m = max(half_length_m, least_m), max(half_width_m, least_m)
    corners: Sequence[Point] = [
        (long_m * nose, -wide_m),
        (long_m * nose, wide_m),
        (-long_m, wide_m),
        (-long_m, -wide_m),
    ]
    if nose < 1.0:
        corners = [(long_m, -wide_m * 0.35), (long_m, wide_m * 0.35), *corners[1:], corners[0]]
    cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
    return [
        canvas.at(x_m + ahead_m * cos - right_m * sin, y_m + ahead_m * sin + right_m * cos)
        for ahead_m, right_m in corners
    ]


def _written(points_px: Sequence[Point]) -> str:
    return " ".join(f"{number(x, 1)},{number(y, 1)}" for x, y in points_px)


# m/s: standing, crawling, as a walker, as a runner, as the shuttle, as a car in town, and beyond; one scale for all
# pictures, so that they can be compared
SPEEDS_MPS = (0.3, 2.0, 4.0, 6.0, 9.0)
TOLERANCE_M = 0.06  # which a trail may be off
SHORTEST_RUN = 4  # ticks: a shorter change of speed band cannot be seen
DOT_S = 1.0
EGO_PX, CASING_PX = 4.5, 6.5
LONELY_M = 0.5  # dots nearer to the one before than this are one dot


class Dot(NamedTuple):
    """A place on a trail at a whole second, or as long as nothing moved."""

    first_s: int
    last_s: int
    at_px: Point

    @property
    def label(self) -> str:
        """When that was."""
        return f"{self.first_s} s" if self.first_s == self.last_s else f"{self.first_s}{DASH}{self.last_s} s"


def own_trail(history: History, span: Span, canvas: Canvas) -> list[Element]:
    """Return the trail of the ego: a casing, and on it a stroke for each stretch of one speed band."""
    frames = history.frames[span.first : span.last + 1]
    points_m = np.column_stack([frames["x_m"], frames["y_m"]])
    speed_mps = history.speed_mps()[span.first : span.last + 1]
    found: dict[int, list[str]] = {}
    for first, last, band in _runs(np.searchsorted(SPEEDS_MPS, speed_mps, side="right")):
        found.setdefault(band, []).append(_whole(points_m[first : last + 2], canvas))
    strokes = {band: "".join(lines) for band, lines in sorted(found.items()) if any(lines)}
    casing = e("path", d="".join(strokes.values()) or None, class_="casing", stroke_width=CASING_PX)
    return [casing, *(e("path", d=d, class_=f"v{band}", stroke_width=EGO_PX) for band, d in strokes.items())]


def other_trail(x_m: NDArray[np.float64], y_m: NDArray[np.float64], canvas: Canvas) -> Element:
    """Return the trail of another actor."""
    return e("path", d=_whole(np.column_stack([x_m, y_m]), canvas), class_="way")


def dots(t_s: NDArray[np.float64], x_m: NDArray[np.float64], y_m: NDArray[np.float64], canvas: Canvas) -> list[Dot]:
    """Return an actor's places at whole seconds, as far as they are in the picture and apart from each other."""
    found: list[Dot] = []
    last_m: Point | None = None
    for second in range(int(np.ceil(t_s[0] - 1e-6)), int(t_s[-1] + 1e-6) + 1):
        index = int(np.argmin(np.abs(t_s - second)))
        place_m = (float(x_m[index]), float(y_m[index]))
        if abs(t_s[index] - second) > DOT_S / 4.0 or not len(on_the_map(np.array([place_m]))):
            continue
        if last_m is not None and np.hypot(place_m[0] - last_m[0], place_m[1] - last_m[1]) < LONELY_M:
            if found and found[-1].at_px == canvas.at(*last_m):
                found[-1] = found[-1]._replace(last_s=second)
            continue
        last_m = place_m
        placed = canvas.at(*place_m)
        if canvas.shows(*placed, 3.0):
            found.append(Dot(second, second, placed))
    return found


def drawn(found: list[Dot], style: str, radius_px: float) -> list[Element]:
    """Dots as circles."""
    return [
        e("circle", cx=number(dot.at_px[0], 1), cy=number(dot.at_px[1], 1), r=radius_px, class_=style) for dot in found
    ]


def _whole(points_m: NDArray[np.float64], canvas: Canvas) -> str:
    """Return a trail as a path with few points, as far as it comes into the picture."""
    finite = _moved(on_the_map(points_m))
    if len(finite) < 2:
        return ""
    thin = np.array(path(finite, TOLERANCE_M))
    if len(thin) < 2:
        return ""
    return "".join(canvas.line(piece) for piece in canvas.pieces(thin))


def _moved(points_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points (N, 2) without those at which nothing had moved, the last among them kept."""
    if len(points_m) <= 2:
        return points_m
    way_m = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points_m, axis=0).T))])
    kept = np.diff(np.floor(way_m / TOLERANCE_M), prepend=-1.0) > 0.0
    kept[-1] = True
    return points_m[kept]


def _runs(bands: NDArray[np.int64]) -> list[tuple[int, int, int]]:
    """Stretches of one band as (first, last, band); one too short to be seen belongs to the one before."""
    runs: list[tuple[int, int, int]] = []
    edges = np.flatnonzero(np.diff(bands)) + 1
    for first, end in zip([0, *edges.tolist()], [*edges.tolist(), len(bands)], strict=True):
        band = int(bands[first])
        if runs and (end - first < SHORTEST_RUN or runs[-1][2] == band):
            runs[-1] = (runs[-1][0], end - 1, runs[-1][2])
        else:
            runs.append((first, end - 1, band))
    return runs
