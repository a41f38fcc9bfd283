"""Path following: how much of the planned length was driven (equations 5.2 and 5.3 of the thesis)."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from basu.history import History

ARRIVED_M = 5.0  # a run that got this near to the end of the plan has driven to its end
SPACING_M = 0.25  # between the points that the driven path is measured with: finer would add up jitter


class PathFollowing(NamedTuple):
    """The two lengths and what comes of them."""

    driven_m: float  # L_A
    planned_m: float  # L_I
    score: float  # in [0, 1]


def path_following(history: History) -> PathFollowing:
    """Score the driven against the planned length.

    Equation 5.3 assumes that both paths end at the same place. Where a run ends early that does not hold, and driving
    in circles would add length; then no more than the progress along the plan counts as driven.
    """
    route, frames = history.facts.route, history.frames
    driven_m = arc_length_m(np.column_stack([frames["x_m"], frames["y_m"]]))
    progress_m = float(frames["route_s_m"].max(initial=0.0))
    if route.length_m - progress_m > ARRIVED_M:
        driven_m = min(driven_m, progress_m)
    return PathFollowing(driven_m, route.length_m, min(1.0, driven_m / route.length_m))


def arc_length_m(points_m: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> float:
    """Length of the polyline through ``points_m`` (T, 2), skipping those within ``SPACING_M`` of the last one taken.

    Equation 5.2 by chords. The last point is always taken, so a path of two points has its full length.
    """
    total_m = 0.0
    x_m, y_m = points_m[:, 0].tolist(), points_m[:, 1].tolist()
    if not x_m:
        return 0.0
    last_x_m, last_y_m = x_m[0], y_m[0]
    for at_x_m, at_y_m in zip(x_m, y_m, strict=True):
        chord_m = ((at_x_m - last_x_m) ** 2 + (at_y_m - last_y_m) ** 2) ** 0.5
        if chord_m >= SPACING_M:
            total_m += chord_m
            last_x_m, last_y_m = at_x_m, at_y_m
    return float(total_m + ((x_m[-1] - last_x_m) ** 2 + (y_m[-1] - last_y_m) ** 2) ** 0.5)
