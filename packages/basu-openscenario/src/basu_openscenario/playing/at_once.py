"""Private actions that are done at once: places, routes, visibility, controllers; and lights."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu_openscenario.playing.running_action import ALONG, BOTH, AtOnce, RunningAction
from basu_openscenario.playing.towing import align
from basu_openscenario.playing.transition import SMALL

if TYPE_CHECKING:
    from basu_openscenario.playing.mover import Mover
    from basu_openscenario.playing.world import World
    from basu_openscenario.reading.actions import (
        AcquirePositionAction,
        AssignControllerAction,
        AssignRouteAction,
        LightStateAction,
        TeleportAction,
        VisibilityAction,
    )


class Teleport(AtOnce):
    """Puts the entity elsewhere."""

    domains = BOTH

    def __init__(self, name: str, world: World, mover: Mover, action: TeleportAction) -> None:
        """Take the action as its file has it."""
        super().__init__(name, world, mover)
        self.action = action

    def prepare(self) -> None:
        """Take the place that the position means now."""
        place = self.world.place_of(self.action.position, self.mover)
        place.route = self.mover.place.route
        place.at_end_of_road = False
        self.mover.place, self.mover.rear_m = place, None
        self.mover.moved_along = self.mover.speed_is_set = self.mover.teleported = True
        if self.mover.tow is None:
            align(self.mover)


class RouteAssignment(AtOnce):
    """Lets the entity follow a route."""

    def __init__(self, name: str, world: World, mover: Mover, action: AssignRouteAction) -> None:
        """Take the action as its file has it."""
        super().__init__(name, world, mover)
        self.action = action

    def prepare(self) -> None:
        """Find the roads of the route."""
        self.mover.place.route = tuple(self.world.route_roads(self.world.waypoints(self.action.route)))


class Acquisition(AtOnce):
    """Lets the entity take the shortest way to a place."""

    domains = ALONG

    def __init__(self, name: str, world: World, mover: Mover, action: AcquirePositionAction) -> None:
        """Take the action as its file has it."""
        super().__init__(name, world, mover)
        self.action = action

    def prepare(self) -> None:
        """Find the roads of the way."""
        there = self.world.place_of(self.action.position, self.mover)
        self.mover.place.route = tuple(self.world.route_roads([self.mover.place.copy(), there]))


class VisibilityChange(AtOnce):
    """Shows or hides the entity; its motion goes on."""

    def __init__(self, name: str, world: World, mover: Mover, action: VisibilityAction) -> None:
        """Take the action as its file has it."""
        super().__init__(name, world, mover)
        self.action = action

    def prepare(self) -> None:
        """Note for what the entity is visible."""
        action = self.action
        self.mover.visibility = {"graphics": action.graphics, "sensors": action.sensors, "traffic": action.traffic}


class ControllerAssignment(AtOnce):
    """Gives the entity a controller; `basu_openscenario.playing.controllers` says which may become active."""

    def __init__(self, name: str, world: World, mover: Mover, action: AssignControllerAction) -> None:
        """Take the action as its file has it."""
        super().__init__(name, world, mover)
        self.action = action

    def prepare(self) -> None:
        """Note the controller."""
        self.mover.controllers[self.action.controller.name] = self.action.controller


class ControllerActivation(AtOnce):
    """Activates a controller that leaves the entity to the scenario."""

    def prepare(self) -> None:
        """Change nothing: the default controller moves the entity as the storyboard says."""


LIGHT_GROUPS = {
    "indicatorLeft": {"indicators"},
    "indicatorRight": {"indicators"},
    "warningLights": {"indicators"},
    "fogLights": {"fogLightsFront", "fogLightsRear"},
}
"""Lights that exclude each other; other lights exclude only themselves."""


class LightChange(RunningAction):
    """Switches a light; a flashing light flashes until an action on the same or an excluded light begins."""

    def __init__(self, name: str, world: World, mover: Mover, action: LightStateAction) -> None:
        """Take the action as its file has it."""
        super().__init__(name, world, mover)
        self.action = action
        self.domains = frozenset(LIGHT_GROUPS.get(action.light, {action.light}))
        self.lasted_s = 0.0

    def prepare(self) -> None:
        """Note the light's mode."""
        self.lasted_s = 0.0
        self.mover.lights[self.action.light] = self.action.mode

    def work(self, step_s: float) -> bool:
        """Wait for the end of the transition."""
        is_over = self.lasted_s > self.action.transition_s - SMALL and self.action.mode != "flashing"
        self.lasted_s += step_s
        return is_over
