"""Where a vehicle is along its route: searched for near the last place, so a route may cross or accompany itself."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from basu.routing.model import Route

BACK_M, AHEAD_M = 5.0, 30.0  # how far from the last known place the next one is searched for


class Progress(NamedTuple):
    """A place along a route."""

    s_m: float  # along it
    lateral_m: float  # off the route, positive to the right
    distance_m: float  # from the nearest point of the route's polyline within the search window

    @staticmethod
    def at_start() -> Progress:
        """Before the first advance."""
        return Progress(0.0, 0.0, 0.0)


def advance(route: Route, before: Progress, x_m: float, y_m: float) -> Progress:
    """The place of (x, y), CARLA frame, searched for near ``before``: some metres back to thirty ahead.

    A vehicle that left the route is searched for farther ahead, as far again as it is away, so that it may come back
    beyond what it went round.
    """
    first = max(0, int(np.searchsorted(route.s_m, before.s_m - BACK_M)) - 1)
    ahead_m = before.s_m + AHEAD_M + 2.0 * before.distance_m
    end = min(len(route.s_m), int(np.searchsorted(route.s_m, ahead_m)) + 1)
    points_m = route.points_m
    away2 = (points_m[first:end, 0] - x_m) ** 2 + (points_m[first:end, 1] - y_m) ** 2
    nearest = first + int(away2.argmin())
    candidates = [
        _on_segment(route, index, x_m, y_m) for index in (nearest - 1, nearest) if 0 <= index < len(route.s_m) - 1
    ]
    return min(candidates, key=_distance)


def _distance(place: Progress) -> float:
    return place.distance_m


def _on_segment(route: Route, index: int, x_m: float, y_m: float) -> Progress:
    """The nearest place on the segment from point ``index`` to the next."""
    x0_m, y0_m = float(route.points_m[index, 0]), float(route.points_m[index, 1])
    along_x_m = float(route.points_m[index + 1, 0]) - x0_m
    along_y_m = float(route.points_m[index + 1, 1]) - y0_m
    length_m = math.hypot(along_x_m, along_y_m)
    to_x_m, to_y_m = x_m - x0_m, y_m - y0_m
    share = min(1.0, max(0.0, (to_x_m * along_x_m + to_y_m * along_y_m) / (length_m * length_m)))
    off_x_m, off_y_m = to_x_m - share * along_x_m, to_y_m - share * along_y_m
    right = along_x_m * off_y_m - along_y_m * off_x_m  # y points south: positive is to the right
    distance_m = math.hypot(off_x_m, off_y_m)
    return Progress(float(route.s_m[index]) + share * length_m, math.copysign(distance_m, right), distance_m)
