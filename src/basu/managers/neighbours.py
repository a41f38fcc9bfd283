"""Who else is on the road near the vehicle: read from the world snapshot, asking the server only about newcomers."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from basu.records.history.model import NEAR_M, NEAREST

if TYPE_CHECKING:
    import carla

    from basu.managers.base_manager import Frame

LOOK_AGAIN_TICKS = 20  # the list of actors is compared at least so often, and whenever the number of actors changes
MOVING_KINDS = ("vehicle.", "walker.")


class Neighbours:
    """Vehicles and walkers other than the ego. ``met`` holds the type of each that was ever near, ``sizes`` its box."""

    def __init__(self, world: carla.World, ego_id: int) -> None:
        self._world, self._ego_id = world, ego_id
        self._actors: dict[int, carla.Actor] = {}
        self._count = -1
        self.met: dict[int, str] = {}
        self.sizes: dict[int, tuple[float, float]] = {}  # half the length and half the width, m

    def near(self, frame: Frame) -> list[tuple[float, ...]]:
        """Rows of ``history.OTHER``, the nearest first, ties by id."""
        if len(frame.snapshot) != self._count or frame.tick % LOOK_AGAIN_TICKS == 0:
            self._look_again(len(frame.snapshot))
        found: list[tuple[float, int, carla.ActorSnapshot]] = []
        for actor_id in self._actors:
            actor = frame.snapshot.find(actor_id)
            if actor is None:
                continue
            at = actor.get_transform().location
            away_m = math.hypot(at.x - frame.ego.x_m, at.y - frame.ego.y_m)
            if away_m <= NEAR_M:
                found.append((away_m, actor_id, actor))
        return [self._row(frame.tick, actor_id, actor) for _, actor_id, actor in sorted(found)[:NEAREST]]

    def counts(self) -> tuple[int, int]:
        """Return how many other vehicles and how many walkers the world has, as of the last look."""
        walkers = sum(actor.type_id.startswith("walker.") for actor in self._actors.values())
        return len(self._actors) - walkers, walkers

    def _look_again(self, count: int) -> None:
        """Take the moving actors out of the world's list; costs no call to the server unless somebody is new."""
        self._count = count
        self._actors = {
            actor.id: actor
            for actor in self._world.get_actors()
            if actor.id != self._ego_id and actor.type_id.startswith(MOVING_KINDS)
        }

    def _row(self, tick: int, actor_id: int, actor: carla.ActorSnapshot) -> tuple[float, ...]:
        """One row, in the order of ``history.OTHER``."""
        if actor_id not in self.met:
            met = self._actors[actor_id]
            self.met[actor_id] = met.type_id
            self.sizes[actor_id] = (met.bounding_box.extent.x, met.bounding_box.extent.y)
        transform, velocity = actor.get_transform(), actor.get_velocity()
        at = transform.location
        return (tick, actor_id, at.x, at.y, at.z, math.radians(transform.rotation.yaw), velocity.x, velocity.y)
