"""Path following: how much of the planned length was driven (equations 5.2 and 5.3 of the thesis)."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from basu.metrics.arrival import PARKED_M
from basu.metrics.stretches import chords, path_m, total_m

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from basu.records.history import History


class PathFollowing(NamedTuple):
    """The two lengths and what comes of them."""

    driven_m: float  # L_A
    planned_m: float  # L_I
    score: float  # in [0, 1]


def path_following(history: History) -> PathFollowing:
    """Score the driven against the planned length."""
    progress_m = float(history.frames["route_s_m"].max(initial=0.0))
    return compared(arc_length_m(path_m(history.frames)), progress_m, history.facts.route.length_m)


def compared(driven_m: float, progress_m: float, planned_m: float) -> PathFollowing:
    """Equation 5.3, which assumes that both paths end at the same place.

    Where a run ends early, farther from the end than a vehicle may park, that does not hold, and driving in circles
    would add length; then no more than the progress along the plan counts as driven.
    """
    if planned_m - progress_m > PARKED_M:
        driven_m = min(driven_m, progress_m)
    return PathFollowing(driven_m, planned_m, min(1.0, driven_m / planned_m))


def arc_length_m(points_m: NDArray[np.float64]) -> float:
    """Length of the polyline through ``points_m`` (T, 2), equation 5.2 by chords."""
    return total_m(chords(points_m).length_m)
