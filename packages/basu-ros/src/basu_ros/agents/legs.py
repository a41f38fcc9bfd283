"""The goals of a route for a planner that takes one goal at a time: its end, or for a round several on the way."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from basu.routing.planned_route import Route

ROUND_M = 30.0  # a route with its ends nearer together is a round: its end alone is no goal
LEG_M = 500.0  # of route between two goals: short enough that the shortest way is that of the route
AHEAD_M = 100.0  # of route before a goal at which the next one is sent; op_global_planner plans on 30 m before a goal
SEARCH_M = 50.0  # of route in which the vehicle is looked for, from where it was last


class Legs:
    """The goals of a route in their order, and which of them is due."""

    def __init__(self, route: Route) -> None:
        """Divide the route."""
        self._route = route
        self._goals = goals_of(route)
        self._here = 0  # the point of the route that the vehicle has reached
        self._due = 0

    @property
    def goal(self) -> int:
        """The number of the route's point that is the present goal."""
        return self._goals[self._due]

    def advance(self, x_m: float, y_m: float) -> int | None:
        """Follow the vehicle to a place in CARLA's axes; return the next goal's point once it is to be sent."""
        s_m, points = self._route.s_m, self._route.points_m
        last = int(np.searchsorted(s_m, s_m[self._here] + SEARCH_M, side="right"))
        near = points[self._here : last, :2] - (x_m, y_m)
        self._here += int(np.argmin(np.hypot(near[:, 0], near[:, 1])))
        is_last = self._due == len(self._goals) - 1
        if is_last or s_m[self.goal] - s_m[self._here] > AHEAD_M:
            return None
        self._due += 1
        return self.goal


def goals_of(route: Route) -> list[int]:
    """Return the numbers of the points that are goals, the last point at the end."""
    last = len(route.s_m) - 1
    if math.dist(route.points_m[0, :2], route.points_m[-1, :2]) > ROUND_M:
        return [last]
    count = math.ceil(route.length_m / LEG_M)
    free = np.flatnonzero(~route.is_junction)  # a place in a junction lies on several lanes
    wanted = [route.length_m * number / count for number in range(1, count)]
    return [*(int(free[np.argmin(np.abs(route.s_m[free] - s_m))]) for s_m in wanted), last]
