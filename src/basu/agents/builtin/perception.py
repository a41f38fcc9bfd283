"""The driving agents' eyes: who is around, from the one snapshot of a tick that the client has received anyway."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from basu.agents.builtin.rules.traffic_lights import Light
from basu.agents.builtin.scene import Ego, Kind, Other

if TYPE_CHECKING:
    from collections.abc import Iterable

    import carla

RADIUS_M = 80.0  # who is farther away does not matter: 11 m/s through the longest gap that is waited for
LOOK_AGAIN_TICKS = 10  # somebody may come in the tick in which another goes: then the number stays
SMALLEST_M = 0.15  # half size of a body whose box the server leaves empty
KIND_OF_PREFIX = {"vehicle.": Kind.VEHICLE, "walker.pedestrian.": Kind.WALKER, "static.prop.": Kind.PROP}


class _Shape(NamedTuple):
    """What stays the same about another actor."""

    kind: Kind
    half_length_m: float
    half_width_m: float
    offset_m: float  # of the box's centre, along the actor's axis


class Perception:
    """Remembers what each actor is, so that a tick asks the server only about those it has never seen."""

    def __init__(self, world: carla.World, own_id: int, radius_m: float = RADIUS_M) -> None:
        self._world = world
        self._radius_m = radius_m
        self._shapes: dict[int, _Shape | None] = {own_id: None}  # None: nothing that one could drive into
        self._solid: list[int] = []  # who could be driven into, in the snapshot's order when it was last gone through
        self._count, self._left = -1, 0  # actors in it then, and ticks until it is gone through again

    def others(self, snapshot: carla.WorldSnapshot, ego: Ego) -> list[Other]:
        """All bodies within the radius, in the snapshot's order."""
        if len(snapshot) != self._count or self._left == 0:
            self._go_through(snapshot)
        self._left -= 1
        shapes, radius_m = self._shapes, self._radius_m
        found = []
        for actor_id in self._solid:
            shape, actor = shapes[actor_id], snapshot.find(actor_id)
            if shape is None or actor is None:
                continue
            pose = actor.get_transform()
            at = pose.location
            if abs(at.x - ego.x_m) < radius_m and abs(at.y - ego.y_m) < radius_m:
                found.append(_other(actor, pose, shape))
        return found

    def _go_through(self, snapshot: carla.WorldSnapshot) -> None:
        """Look who is there: a town has hundreds of lights and signs, and most ticks nobody comes or goes."""
        ids = [actor.id for actor in snapshot]
        unknown = [actor_id for actor_id in ids if actor_id not in self._shapes]
        if unknown:
            self._learn(unknown)
        self._solid = [actor_id for actor_id in ids if self._shapes[actor_id] is not None]
        self._count, self._left = len(ids), LOOK_AGAIN_TICKS

    def _learn(self, ids: Iterable[int]) -> None:
        """Ask what new actors are."""
        ids = list(ids)
        self._shapes.update(dict.fromkeys(ids))
        for actor in self._world.get_actors(ids):
            kind = next((k for prefix, k in KIND_OF_PREFIX.items() if actor.type_id.startswith(prefix)), None)
            if kind is not None:
                box = actor.bounding_box
                self._shapes[actor.id] = _Shape(
                    kind, max(box.extent.x, SMALLEST_M), max(box.extent.y, SMALLEST_M), box.location.x
                )


def _other(actor: carla.ActorSnapshot, pose: carla.Transform, shape: _Shape) -> Other:
    """One actor of a snapshot."""
    velocity, yaw_rad = actor.get_velocity(), math.radians(pose.rotation.yaw)
    return Other(
        actor.id,
        shape.kind,
        pose.location.x + shape.offset_m * math.cos(yaw_rad),
        pose.location.y + shape.offset_m * math.sin(yaw_rad),
        yaw_rad,
        velocity.x,
        velocity.y,
        math.radians(actor.get_angular_velocity().z),
        shape.half_length_m,
        shape.half_width_m,
    )


def see_ego(snapshot: carla.WorldSnapshot, own: carla.ActorSnapshot, gear: int) -> Ego:
    """The driven vehicle of a snapshot, which does not tell its gear."""
    pose, velocity = own.get_transform(), own.get_velocity()
    yaw_rad = math.radians(pose.rotation.yaw)
    speed_mps = velocity.x * math.cos(yaw_rad) + velocity.y * math.sin(yaw_rad)
    return Ego(snapshot.timestamp.elapsed_seconds, pose.location.x, pose.location.y, yaw_rad, speed_mps, gear)


class Lights:
    """The traffic lights on the way, by the id of their OpenDRIVE signal."""

    def __init__(self, world: carla.World, landmark_ids: Iterable[str]) -> None:
        found = {landmark_id: world.get_traffic_light_from_opendrive_id(landmark_id) for landmark_id in landmark_ids}
        self._actors = {landmark_id: actor for landmark_id, actor in found.items() if actor is not None}

    def shows(self, landmark_id: str) -> Light:
        """What a light shows; one that the server does not have is dark."""
        actor = self._actors.get(landmark_id)
        return Light.DARK if actor is None else _LIGHT_OF_NAME.get(str(actor.get_state()), Light.DARK)


_LIGHT_OF_NAME = {"Green": Light.GREEN, "Yellow": Light.YELLOW, "Red": Light.RED}
