"""What the next traffic light on the planned route shows."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.records.history.model import NO_LIGHT
from basu.routing import ControlKind

if TYPE_CHECKING:
    import carla

    from basu.routing import Route

BEHIND_M = 1.0  # a light counts until its line is so far behind the rear: the leaderboard judges the tail out to there


class RouteLights:
    """The lights of a route, asked for once; their states come with every tick."""

    def __init__(self, world: carla.World, route: Route, rear_m: float) -> None:
        """Look them up; ``rear_m`` is how far the vehicle reaches behind its origin."""
        self._rear_m = rear_m
        on_route = [control for control in route.controls if control.kind is ControlKind.TRAFFIC_LIGHT]
        found = [(control.s_m, world.get_traffic_light_from_opendrive_id(control.landmark_id)) for control in on_route]
        self._lights = [(s_m, light) for s_m, light in found if light is not None]

    def next_state(self, route_s_m: float) -> int:
        """The carla.TrafficLightState of the next light whose line is not ``BEHIND_M`` behind the rear, or NO_LIGHT."""
        for line_s_m, light in self._lights:
            if line_s_m >= route_s_m - self._rear_m - BEHIND_M:
                return int(light.get_state())
        return NO_LIGHT
