"""A route up to a place on it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from basu.routing.model import Route

LEAST_POINTS = 2  # of a route


def until(route: Route, s_m: float) -> Route:
    """The route as if it ended at its last point not beyond ``s_m``; distances along it stay what they are."""
    count = max(LEAST_POINTS, int(np.searchsorted(route.s_m, s_m, side="right")))
    if count >= len(route.s_m):
        return route
    last_s_m = float(route.s_m[count - 1])
    per_point = {name: getattr(route, name)[:count] for name in PER_POINT}
    return replace(
        route,
        **per_point,
        stops=tuple(stop for stop in route.stops if stop.s_m <= last_s_m),
        controls=tuple(control for control in route.controls if control.s_m <= last_s_m),
    )


PER_POINT = (
    "points_m",
    "s_m",
    "yaw_rad",
    "lane_width_m",
    "speed_limit_mps",
    "is_junction",
    "road_id",
    "lane_id",
    "waypoints",
)
