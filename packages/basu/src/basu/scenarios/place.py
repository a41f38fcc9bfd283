"""`Place`: the ego's route and trigger point in a case, and poses, lane widths and stop lines at distances from it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from basu.errors import ScenarioError
from basu.routing import ControlKind
from basu.scenarios.stage import Pose

if TYPE_CHECKING:
    import carla

    from basu.routing import Route
    from basu.scenarios.xml_elements import GivenActor


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """The ego's route with a scenario on it. ``ahead_m`` counts along the route from the trigger point."""

    route: Route
    trigger_s_m: float  # of the trigger point, along the route
    carla_map: carla.Map
    others: tuple[GivenActor, ...] = ()  # actors placed by the file itself

    def at(self, ahead_m: float, right_m: float = 0.0, turned_deg: float = 0.0) -> Pose:
        """The pose so far ahead along the route, so far to its right, turned clockwise from its direction.

        Beyond the ends of the route it goes straight on.
        """
        route, s_m = self.route, self.trigger_s_m + ahead_m
        held_m = min(max(s_m, 0.0), route.length_m)
        x_m, y_m, z_m = (float(np.interp(held_m, route.s_m, route.points_m[:, axis])) for axis in range(3))
        yaw_rad = self.heading_rad(ahead_m)
        over_m = s_m - held_m
        return Pose(
            x_m + over_m * math.cos(yaw_rad) - right_m * math.sin(yaw_rad),
            y_m + over_m * math.sin(yaw_rad) + right_m * math.cos(yaw_rad),
            z_m,
            math.remainder(yaw_rad + math.radians(turned_deg), math.tau),
        )

    def heading_rad(self, ahead_m: float) -> float:
        """The direction of the route there."""
        route = self.route
        s_m = min(max(self.trigger_s_m + ahead_m, 0.0), route.length_m)
        return float(np.interp(s_m, route.s_m, np.unwrap(route.yaw_rad)))

    def width_m(self, ahead_m: float) -> float:
        """The width of the route's lane there."""
        index = int(np.searchsorted(self.route.s_m, self.trigger_s_m + ahead_m))
        return float(self.route.lane_width_m[min(index, len(self.route.s_m) - 1)])

    def waypoint(self, ahead_m: float) -> carla.Waypoint:
        """The map's way point of the route there.

        Raises:
            ScenarioError: the route was not laid on a map.
        """
        if not self.route.waypoints:
            raise ScenarioError(f"the route '{self.route.id}' was not laid on a map, so nothing is known beside it")
        index = int(np.searchsorted(self.route.s_m, self.trigger_s_m + ahead_m - 1e-6))
        return self.route.waypoints[min(index, len(self.route.waypoints) - 1)]

    def stop_line_m(self, before_m: float = math.inf) -> float | None:
        """How far ahead the next stop sign's line is; None where there is none on the next ``before_m`` metres."""
        ahead_m = [c.s_m - self.trigger_s_m for c in self.route.controls if c.kind is ControlKind.STOP_SIGN]
        return next((at_m for at_m in ahead_m if 0.0 < at_m < before_m), None)

    @property
    def left_m(self) -> float:
        """How far the route goes on from the trigger point."""
        return self.route.length_m - self.trigger_s_m
