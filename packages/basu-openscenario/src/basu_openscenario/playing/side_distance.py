"""Keeping a distance to the side of another entity."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from basu.errors import ScenarioError
from basu_openscenario.playing.running_action import ASIDE, RunningAction

if TYPE_CHECKING:
    from basu_openscenario.playing.mover import Mover
    from basu_openscenario.playing.world import World
    from basu_openscenario.reading.actions import LateralDistanceAction

REACHED_M = 0.01
"""A distance is reached when it is this close."""


class SideDistance(RunningAction):
    """Moves the entity over to the distance at once, in the entity's axes or the road's."""

    domains = ASIDE

    def __init__(self, name: str, world: World, mover: Mover, action: LateralDistanceAction) -> None:
        """Take the action as its file has it.

        Raises:
            ScenarioError: it has limits, or a system of coordinates that is not supported.
        """
        super().__init__(name, world, mover)
        if action.limits is not None:
            raise ScenarioError(
                f"the LateralDistanceAction '{name}' of '{mover.name}' has DynamicConstraints, which are not "
                "supported there; remove them, and the distance is taken at once"
            )
        if action.system not in {"entity", "road", "lane"}:
            raise ScenarioError(
                f"the LateralDistanceAction '{name}' of '{mover.name}' has the coordinateSystem "
                f"'{action.system}', which is not supported there; use entity or road"
            )
        self.action = action
        self.left_m = 0.0
        """The wanted distance to the left of the other entity."""

    def prepare(self) -> None:
        """Find out on which side of the other entity to be."""
        other = self.world.mover(self.action.entity)
        wanted = abs(self.action.distance_m or 0.0)
        if self.action.freespace:
            wanted += (self.mover.entity.box.width_m + other.entity.box.width_m) / 2.0
        self.left_m = -wanted if self.action.displacement == "rightToReferencedEntity" else wanted

    def work(self, step_s: float) -> bool:
        """Move to the line beside the other entity, and along it with what is left of the step."""
        mover = self.mover
        other = self.world.mover(self.action.entity).place
        place = mover.place
        if self.action.system == "entity":
            cos, sin = math.cos(other.h_rad), math.sin(other.h_rad)
            ahead, left = other.seen_from(place.x_m, place.y_m)
            aside_m = abs(self.left_m - left)
            ahead += max(abs(mover.speed_mps) * step_s - aside_m, 0.0)
            x_m, y_m = other.x_m + cos * ahead - sin * self.left_m, other.y_m + sin * ahead + cos * self.left_m
            place.set_world(x_m, y_m, other.h_rad, mover.fixed_z_m)
            mover.moved_along = mover.speed_is_set = True
            return not self.action.continuous and aside_m < REACHED_M
        way = other.to(place)
        if way is None:
            return True
        wanted = self.left_m if other.is_forward else -self.left_m
        over_m = wanted - way.dt_m
        place.set_track(place.road_number, place.s_m, place.t_m + over_m)
        return not self.action.continuous and abs(over_m) < REACHED_M
