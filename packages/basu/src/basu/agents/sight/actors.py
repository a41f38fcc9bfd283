"""Other actors as an agent knows them, and the census that reads them out of world snapshots.

World frame: CARLA's (metres, x east, y south, z up, angles in rad clockwise from above).
"""

from __future__ import annotations

import enum
import math
from typing import TYPE_CHECKING, NamedTuple

from basu.records.partners import ANIMALS, Partner, partner_of
from basu.records.placed_motion import PlacedMotion, PlanarMotion, own_motion
from basu.thresholds import is_rolled_over

if TYPE_CHECKING:
    from collections.abc import Iterable

    import carla

LOOK_AGAIN_TICKS = 10  # an actor may come in the tick in which another goes: then the number stays
SMALLEST_M = 0.15  # half size of a body with an empty box from the server
USUAL_HALF_HEIGHT_M = 0.75  # a car's, where no height is given


class ActorKind(enum.Enum):
    """What another actor is; a prop may be anything that lies or stands about."""

    VEHICLE = "vehicle"
    WALKER = "walker"  # an animal too
    PROP = "prop"


KIND_OF_PREFIX = {
    "vehicle.": ActorKind.VEHICLE,
    "walker.pedestrian.": ActorKind.WALKER,
    ANIMALS: ActorKind.WALKER,
    "static.prop.": ActorKind.PROP,
}


class Other(NamedTuple):
    """Another actor now.

    Attributes:
        id: CARLA's actor id.
        kind: vehicle, walker or prop.
        x_m, y_m: centre of its bounding box, in CARLA's world frame.
        yaw_rad: its heading, clockwise from east, as seen from above.
        velocity_x_mps, velocity_y_mps: its velocity over ground, in the world's axes.
        yaw_rate_radps: its rate of turn, clockwise as seen from above.
        half_length_m, half_width_m, half_height_m: half the sides of its box.
        z_m: height of the box's centre in the world.
        unseen_s: 0 for a visible actor, else the time since it was last seen; the place is extrapolated since then.
    """

    id: int
    kind: ActorKind
    x_m: float
    y_m: float
    yaw_rad: float
    velocity_x_mps: float
    velocity_y_mps: float
    yaw_rate_radps: float
    half_length_m: float
    half_width_m: float
    z_m: float = 0.0
    half_height_m: float = USUAL_HALF_HEIGHT_M
    unseen_s: float = 0.0

    @property
    def speed_mps(self) -> float:
        """Speed over ground."""
        return math.hypot(self.velocity_x_mps, self.velocity_y_mps)


class _Shape(NamedTuple):
    """What stays the same about another actor."""

    kind: ActorKind
    partner: Partner
    half_length_m: float
    half_width_m: float
    half_height_m: float
    ahead_m: float  # of the box's centre before the actor's origin …
    above_m: float  # … and above it


class Census:
    """Remembers what each actor is, so that a tick asks the server only about new ones."""

    def __init__(self, world: carla.World, own_id: int, radius_m: float) -> None:
        self._world = world
        self._radius_m = radius_m
        self._motion = PlacedMotion()
        self._shapes: dict[int, _Shape | None] = {own_id: None}  # None: nothing that one could drive into
        self._solid: list[int] = []  # ids of bodies, in the order of the last snapshot that was gone through
        self._count, self._left = -1, 0  # actors in that snapshot, and ticks until the next one is gone through

    def near(self, snapshot: carla.WorldSnapshot, x_m: float, y_m: float) -> list[Other]:
        """Return all bodies within the radius of a place, in the snapshot's order."""
        if len(snapshot) != self._count or self._left == 0:
            self._go_through(snapshot)
        self._left -= 1
        shapes, radius_m, t_s = self._shapes, self._radius_m, snapshot.timestamp.elapsed_seconds
        found = []
        for actor_id in self._solid:
            shape, actor = shapes[actor_id], snapshot.find(actor_id)
            if shape is None or actor is None:
                continue
            pose = actor.get_transform()
            at = pose.location
            if abs(at.x - x_m) < radius_m and abs(at.y - y_m) < radius_m:
                is_vehicle = shape.kind is ActorKind.VEHICLE
                motion = self._motion.of(actor, pose, t_s) if is_vehicle else own_motion(actor)
                found.append(_other(actor_id, pose, shape, motion))
        return found

    def partner(self, actor_id: int) -> Partner:
        """Return the kind of a body that `near` has returned."""
        shape = self._shapes[actor_id]
        return Partner.NONE if shape is None else shape.partner

    def _go_through(self, snapshot: carla.WorldSnapshot) -> None:
        """List the bodies: a town has hundreds of lights and signs, and in most ticks no actor comes or goes."""
        ids = [actor.id for actor in snapshot]
        unknown = [actor_id for actor_id in ids if actor_id not in self._shapes]
        if unknown:
            self._learn(unknown)
        self._solid = [actor_id for actor_id in ids if self._shapes[actor_id] is not None]
        self._count, self._left = len(ids), LOOK_AGAIN_TICKS

    def _learn(self, ids: Iterable[int]) -> None:
        """Ask the server what new actors are."""
        ids = list(ids)
        self._shapes.update(dict.fromkeys(ids))
        for actor in self._world.get_actors(ids):
            kind = next((k for prefix, k in KIND_OF_PREFIX.items() if actor.type_id.startswith(prefix)), None)
            box = actor.bounding_box
            if kind is not None and not (kind is ActorKind.PROP and is_rolled_over(2.0 * box.extent.z)):
                length_m, width_m, height_m = (max(half_m, SMALLEST_M) for half_m in _vector(box.extent))
                self._shapes[actor.id] = _Shape(
                    kind, partner_of(actor.type_id), length_m, width_m, height_m, box.location.x, box.location.z
                )


def _vector(vector: carla.Vector3D) -> tuple[float, float, float]:
    return vector.x, vector.y, vector.z


def _other(actor_id: int, pose: carla.Transform, shape: _Shape, motion: PlanarMotion) -> Other:
    """Return one actor of a snapshot."""
    yaw_rad = math.radians(pose.rotation.yaw)
    return Other(
        actor_id,
        shape.kind,
        pose.location.x + shape.ahead_m * math.cos(yaw_rad),
        pose.location.y + shape.ahead_m * math.sin(yaw_rad),
        yaw_rad,
        *motion,
        shape.half_length_m,
        shape.half_width_m,
        pose.location.z + shape.above_m,
        shape.half_height_m,
    )
