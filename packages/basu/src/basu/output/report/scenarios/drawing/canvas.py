"""`Canvas` maps CARLA's coordinates (m) to pixels of a case's picture; `what_matters` selects the points to show."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, TypeVar

import numpy as np

from basu.output.report.templates import number

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from basu.output.report.scenarios.drawing.encounter import CaseData, Point

Metres = TypeVar("Metres", float, "NDArray[np.float64]")
WIDTH_PX = 560.0
LEAST_HEIGHT_PX, GREATEST_HEIGHT_PX = 290.0, 430.0
LEAST_M, MARGIN_M = 26.0, 5.0  # what a picture shows at the least from west to east, and around what matters
NEAR_M, FAR_M = 58.0, 120.0  # around the encounter, and of a drive without an encounter
BEFORE_S, AFTER_S = 2.0, 3.0  # of driving that is shown in any case


class Canvas(NamedTuple):
    """A piece of the town and the pixels it is drawn on."""

    west_m: float
    north_m: float  # y points south: north is the smaller one
    pixels_per_m: float
    height_px: float

    def at(self, x_m: Metres, y_m: Metres) -> tuple[Metres, Metres]:
        """Return a place in pixels, or many."""
        return (x_m - self.west_m) * self.pixels_per_m, (y_m - self.north_m) * self.pixels_per_m

    def line(self, points_m: Iterable[Point]) -> str:
        """Return a polyline as SVG writes it, to a tenth of a pixel."""
        placed = (self.at(x_m, y_m) for x_m, y_m in points_m)
        return "M" + " ".join(f"{number(x, 1)} {number(y, 1)}" for x, y in placed)

    def shows(self, x_px: float, y_px: float, margin_px: float = 0.0) -> bool:
        """Return whether a place in pixels is in the picture, so far from its edge."""
        return margin_px <= x_px <= WIDTH_PX - margin_px and margin_px <= y_px <= self.height_px - margin_px

    def pieces(self, line_m: NDArray[np.float64], margin_m: float = 6.0) -> list[list[Point]]:
        """Those stretches of a polyline (N, 2) that may come into the picture; a segment is whole or not there."""
        width_m, height_m = WIDTH_PX / self.pixels_per_m, self.height_px / self.pixels_per_m
        low, high = np.minimum(line_m[:-1], line_m[1:]), np.maximum(line_m[:-1], line_m[1:])
        seen = (
            (high[:, 0] > self.west_m - margin_m)
            & (low[:, 0] < self.west_m + width_m + margin_m)
            & (high[:, 1] > self.north_m - margin_m)
            & (low[:, 1] < self.north_m + height_m + margin_m)
        )
        edges = np.flatnonzero(np.diff(np.concatenate([[False], seen, [False]]).astype(np.int8))).reshape(-1, 2)
        return [[(x, y) for x, y in line_m[first : last + 1].tolist()] for first, last in edges.tolist()]


def canvas_for(points_m: NDArray[np.float64]) -> Canvas:
    """Return the picture that shows all the points (N, 2), not too small and of a shape that fits on a page."""
    low, high = points_m.min(axis=0) - MARGIN_M, points_m.max(axis=0) + MARGIN_M
    width_m, height_m = np.maximum(high - low, [LEAST_M, 0.0]).tolist()
    width_m = max(width_m, height_m * WIDTH_PX / GREATEST_HEIGHT_PX)
    height_m = max(height_m, width_m * LEAST_HEIGHT_PX / WIDTH_PX)
    middle_x_m, middle_y_m = ((low + high) / 2.0).tolist()
    scale = WIDTH_PX / width_m
    return Canvas(middle_x_m - width_m / 2.0, middle_y_m - height_m / 2.0, scale, height_m * scale)


def what_matters(story: CaseData) -> NDArray[np.float64]:
    """Return the points (N, 2) that a picture is to show: the drive and the scenario's actors around the encounter."""
    history, span, met = story.history, story.span, story.met
    frames = history.frames[span.first : span.last + 1]
    own_m = np.column_stack([frames["x_m"], frames["y_m"]])
    if met is None:
        finite = own_m[np.isfinite(own_m).all(axis=1)]
        middle_m = finite[len(finite) // 2] if len(finite) else np.zeros(2)
        return _near(own_m, middle_m, FAR_M / 2.0)
    met_s = float(history.frames["t_s"][met.tick])
    begin_s = min(met_s, story.result["phases_s"].get("conflict", met_s)) - BEFORE_S
    end_s = met_s + AFTER_S
    shown = own_m[(frames["t_s"] >= begin_s) & (frames["t_s"] <= end_s)]
    t_s = history.frames["t_s"][history.others["tick"] - history.frames["tick"][0]]
    is_theirs = (t_s >= begin_s) & (t_s <= end_s) & np.isin(history.others["id"], list(story.roles))
    others = history.others[is_theirs]
    theirs = np.column_stack([others["x_m"], others["y_m"]])
    middle_m = (np.array(met.own_m) + np.array(met.theirs_m)) / 2.0
    return np.concatenate([_near(np.concatenate([shown, theirs]), middle_m, NEAR_M), [met.own_m, met.theirs_m]])


def _near(points_m: NDArray[np.float64], middle_m: NDArray[np.float64], reach_m: float) -> NDArray[np.float64]:
    """Return those of the points within a distance of the middle, and the middle."""
    away_m = np.hypot(*(points_m - middle_m).T)
    return np.concatenate([points_m[away_m <= reach_m], [middle_m]])
