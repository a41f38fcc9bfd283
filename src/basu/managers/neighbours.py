"""Actors near the vehicle, moving ones and things: read from the world snapshot; only new actors cost a call."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from basu.records.history.model import NEAR_M, NEAREST

if TYPE_CHECKING:
    import carla

    from basu.managers.base_manager import Frame

LOOK_AGAIN_TICKS = 20  # the list of actors is compared at least so often, and whenever the number of actors changes
MOVING_KINDS = ("vehicle.", "walker.")
THING_KINDS = ("static.prop.",)  # scenery is no actor; sensors, signs and friction triggers stand in nobody's way
SMALLEST_M = 0.15  # half size of a body whose box the simulator leaves empty
OVERHEAD_M = 3.0  # a thing whose box begins so far above the road is driven under


class _Shape(NamedTuple):
    """What stays the same about an actor; its box's middle and half sizes in its own frame, m."""

    type_id: str
    x_m: float
    y_m: float
    bottom_m: float
    half_length_m: float
    half_width_m: float

    @property
    def moves(self) -> bool:
        """Whether it is a vehicle or a walker."""
        return self.type_id.startswith(MOVING_KINDS)


class Neighbours:
    """Actors other than the ego. ``met`` holds the type of each that was ever near, ``sizes`` its box."""

    def __init__(self, world: carla.World, ego_id: int) -> None:
        self._world, self._ego_id = world, ego_id
        self._shapes: dict[int, _Shape] = {}
        self._count = -1
        self._last: tuple[Frame | None, list[tuple[float, ...]]] = (None, [])
        self.met: dict[int, str] = {}
        self.sizes: dict[int, tuple[float, float]] = {}  # half the length and half the width, m

    def near(self, frame: Frame) -> list[tuple[float, ...]]:
        """Rows of ``history.OTHER``: vehicles and walkers, then things, the nearest of each first, ties by id."""
        if self._last[0] is not frame:
            self._last = (frame, self._found(frame))
        return self._last[1]

    def _found(self, frame: Frame) -> list[tuple[float, ...]]:
        """The rows of a frame that was not asked for yet."""
        if len(frame.snapshot) != self._count or frame.tick % LOOK_AGAIN_TICKS == 0:
            self._look_again(len(frame.snapshot))
        moving: list[tuple[float, int, carla.ActorSnapshot]] = []
        things: list[tuple[float, int, carla.ActorSnapshot]] = []
        for actor_id, shape in self._shapes.items():
            actor = frame.snapshot.find(actor_id)
            if actor is None:
                continue
            at = actor.get_transform().location
            away_m = math.hypot(at.x - frame.ego.x_m, at.y - frame.ego.y_m)
            if away_m > NEAR_M:
                continue
            if shape.moves:
                moving.append((away_m, actor_id, actor))
            elif at.z + shape.bottom_m < frame.ego.z_m + OVERHEAD_M:
                things.append((away_m, actor_id, actor))
        chosen = [*sorted(moving)[:NEAREST], *sorted(things)[:NEAREST]]
        return [self._row(frame.tick, actor_id, actor) for _, actor_id, actor in chosen]

    def counts(self) -> tuple[int, int]:
        """Return how many other vehicles and how many walkers the world has, as of the last look."""
        kinds = [shape.type_id.partition(".")[0] for shape in self._shapes.values()]
        return kinds.count("vehicle"), kinds.count("walker")

    def _look_again(self, count: int) -> None:
        """Take vehicles, walkers and things out of the world's list; only new actors cost a call to the server."""
        self._count = count
        self._shapes = {
            actor.id: self._shapes.get(actor.id) or _shape(actor)
            for actor in self._world.get_actors()
            if actor.id != self._ego_id and actor.type_id.startswith((*MOVING_KINDS, *THING_KINDS))
        }

    def _row(self, tick: int, actor_id: int, actor: carla.ActorSnapshot) -> tuple[float, ...]:
        """One row, in the order of ``history.OTHER``: the place is that of the middle of the box."""
        shape = self._shapes[actor_id]
        if actor_id not in self.met:
            self.met[actor_id] = shape.type_id
            self.sizes[actor_id] = (shape.half_length_m, shape.half_width_m)
        transform, velocity = actor.get_transform(), actor.get_velocity()
        at, yaw_rad = transform.location, math.radians(transform.rotation.yaw)
        cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
        x_m = at.x + shape.x_m * cos - shape.y_m * sin
        y_m = at.y + shape.x_m * sin + shape.y_m * cos
        return (tick, actor_id, x_m, y_m, at.z, yaw_rad, velocity.x, velocity.y)


def _shape(actor: carla.Actor) -> _Shape:
    """The box of an actor."""
    box = actor.bounding_box
    return _Shape(
        type_id=actor.type_id,
        x_m=box.location.x,
        y_m=box.location.y,
        bottom_m=box.location.z - box.extent.z,
        half_length_m=max(box.extent.x, SMALLEST_M),
        half_width_m=max(box.extent.y, SMALLEST_M),
    )
