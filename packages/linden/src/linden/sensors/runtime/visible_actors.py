"""The actors that can be seen, as bodies for a caster: every part of each of them in its place, in a few operations."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.blueprints.library import BlueprintKind
from linden.compiled import fingerprint, kept_part
from linden.protocol.values.actors import ActorDescription
from linden.scenery.actors.posing import (
    SOURCE,
    VEHICLE_FRAMES,
    WALKER_FRAMES,
    matrices,
    posed_frames,
    put_part,
    vehicle_frames,
    walker_frames,
)
from linden.scenery.mesh import LampOf
from linden.sensors.casting.caster import Instances
from linden.simulation.actor_table import NO_BODY, ActorRecord
from linden.simulation.bones import bones_of
from linden.structured import StructuredArray

if TYPE_CHECKING:
    from linden.scenery.actors.actor_meshes import BlueprintMeshes
    from linden.simulation.episode import Episode

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

_UNPAINTED = "128,128,128"
_VISIBLE = (BlueprintKind.VEHICLE, BlueprintKind.WALKER, BlueprintKind.PROP)
_BLINKS_HZ = 1.5
"""In the middle of what UN ECE regulation 48 allows, 60 to 120 a minute."""

_LAMPS_OF_BIT = {
    0x001: (LampOf.TAIL,),  # position
    0x002: (LampOf.HEAD, LampOf.TAIL),  # low beam
    0x004: (LampOf.HEAD, LampOf.TAIL),  # high beam
    0x008: (LampOf.TAIL, LampOf.BRAKE),
    0x010: (LampOf.BLINKER_RIGHT,),
    0x020: (LampOf.BLINKER_LEFT,),
    0x040: (LampOf.REVERSE,),
    0x200: (LampOf.BEACON,),  # special 1
}
"""What shines for each bit of CARLA's VehicleLightState."""

_BLINKING = np.uint32(1 << LampOf.BLINKER_LEFT | 1 << LampOf.BLINKER_RIGHT)


class PartRows(NamedTuple):
    """The parts (K,) of actors, all parts of an actor side by side."""

    actor: NDArray[np.intp]  # its number, ascending
    mesh: I32
    frame: NDArray[np.intp]
    paint: NDArray[np.uint8]  # (K, 3) the part's own colour, or the actor's
    scale: F64

    @classmethod
    def of(cls, descriptions: Sequence[ActorDescription], bodies: "BlueprintMeshes") -> "PartRows":
        """Return the parts of one actor of each description."""
        parts = [(index, part) for index, made in enumerate(descriptions) for part in bodies.parts(made)]
        colours = [_colour(made) for made in descriptions]
        return cls(
            actor=np.array([index for index, _ in parts], np.intp),
            mesh=np.array([part.mesh for _, part in parts], np.int32),
            frame=np.array([part.frame for _, part in parts], np.intp),
            paint=np.array([part.colour or colours[index] for index, part in parts], np.uint8).reshape(-1, 3),
            scale=np.array([part.scale for _, part in parts], np.float64),
        )


class _ActorRows(NamedTuple):
    """The visible actors (A,), made anew with each new set."""

    records: list[ActorRecord]
    row: I32  # in the actor table
    slot: I32  # of the body that moves it: its own, or that of what it is attached to; NO_BODY where nothing does
    vehicles: NDArray[np.intp]
    walkers: NDArray[np.intp]
    parts: PartRows


class Motion(NamedTuple):
    """Where actors (A,) are and how they move."""

    place: F64  # (A, 3, 4) matrices
    velocity_mps: F64  # (A, 3)
    turning_radps: F64  # (A, 3)
    actor_id: NDArray[np.uint32]
    lights: NDArray[np.uint32]


def instances_of(parts: PartRows, motion: Motion, frames: F64) -> Instances:
    """Return the parts in their places; ``frames`` (A, 14, 3, 4) are those of the parts in their actors'."""
    actor = parts.actor
    pose, arm_m = poses_of_parts(parts, motion.place, frames)
    turning = motion.turning_radps[actor]
    return Instances(
        mesh=parts.mesh,
        pose=pose,
        before=pose,
        actor_id=motion.actor_id[actor],
        colour=parts.paint,
        lights=motion.lights[actor],
        velocity_mps=(motion.velocity_mps[actor] + np.cross(turning, arm_m)).astype(np.float32),
        turning_radps=turning.astype(np.float32),
    )


@kept_part(fingerprint(Path(__file__), SOURCE))
def _put_parts(
    actor: NDArray[np.intp], frame: NDArray[np.intp], scale: F64, place: F64, frames: F64, pose: F32, arm_m: F64
) -> None:  # pragma: no cover - compiled
    for row in range(len(actor)):
        own = actor[row]
        arm_m[row, 0], arm_m[row, 1], arm_m[row, 2] = put_part(
            place[own], frames[own, frame[row]], scale[row], pose[row]
        )


def poses_of_parts(parts: PartRows, place: F64, frames: F64) -> tuple[F32, F64]:
    """Return the poses (P, 3, 4) of parts, and how far (P, 3) in m they are from their actors' origins.

    ``place`` (A, 3, 4) are the poses of actors, and ``frames`` (A, 14, 3, 4) those of the parts in them.
    """
    pose, arm_m = np.empty((len(parts.actor), 3, 4), np.float32), np.empty((len(parts.actor), 3))
    _put_parts(parts.actor, parts.frame, parts.scale, place, frames, pose, arm_m)
    return pose, arm_m


def rigid_frames(count: int) -> F64:
    """Return the frames (A, 14, 3, 4) of parts that do not move in their actors."""
    frames = np.zeros((count, len(WALKER_FRAMES), 3, 4))
    frames[:, 0, :, :3] = np.eye(3)
    return frames


def put_vehicles(frames: F64, rows: NDArray[np.intp], specs: StructuredArray, steer_rad: F64, turned_rad: F64) -> None:
    """Write the frames of the wheels of vehicles in ``rows`` (V,); ``specs`` are of VEHICLE_SPEC (V,)."""
    hubs = np.stack([specs[name] for name in ("wheel_x_m", "wheel_y_m", "wheel_radius_m")], -1)
    frames[rows, : len(VEHICLE_FRAMES)] = vehicle_frames(hubs, steer_rad, turned_rad)


class VisibleActors:
    """Gathers bodies frame by frame."""

    def __init__(self, bodies: "BlueprintMeshes") -> None:
        self._bodies = bodies
        self._rows: _ActorRows | None = None
        self._version = -1
        self._poses: dict[int, NDArray[np.float32]] = {}

    def gather(self, episode: "Episode", *, goes_on: bool) -> Instances:
        """Return all bodies as they are now; ``goes_on`` where the last gathering was in the frame before this one."""
        rows = self._rows_of(episode)
        velocity, turning = _motion(episode, rows.slot)
        motion = Motion(
            matrices(episode.actors.pose[rows.row]),
            velocity,
            turning,
            np.array([record.id for record in rows.records], np.uint32),
            _lights(rows.records, episode.elapsed_s),
        )
        found = instances_of(rows.parts, motion, self._frames(episode, rows))
        return found._replace(before=self._before(rows, found.pose, goes_on=goes_on))

    def _rows_of(self, episode: "Episode") -> _ActorRows:
        if self._rows is None or self._version != episode.actors.version:
            self._rows, self._version = _survey(episode, self._bodies), episode.actors.version
        return self._rows

    def _frames(self, episode: "Episode", rows: _ActorRows) -> F64:
        """Return the frames (A, 14, 3, 4) of the parts in those of the actors."""
        frames, bodies = rigid_frames(len(rows.records)), episode.bodies
        if len(rows.vehicles):
            slots = rows.slot[rows.vehicles]
            rolling = (bodies.wheel_steer[slots], bodies.wheel_turned[slots])
            put_vehicles(frames, rows.vehicles, bodies.spec(slots), *rolling)
        if len(rows.walkers):
            walking = [rows.records[index] for index in rows.walkers.tolist()]
            velocity = bodies.velocity[rows.slot[rows.walkers]]
            alive = np.array([not episode.walkers.is_dead(record.id) for record in walking])
            frames[rows.walkers] = walker_frames(
                np.array([2.0 * record.box.extent.z for record in walking]),
                np.array([episode.walkers.walked_m(record.id) for record in walking]),
                alive * np.hypot(velocity[:, 0], velocity[:, 1]),
            )
            for index, record in zip(rows.walkers.tolist(), walking, strict=True):
                if episode.poses.is_posed(record.id):
                    frames[index] = posed_frames(bones_of(episode, record.id).in_actor)
        return frames

    def _before(self, rows: _ActorRows, pose: NDArray[np.float32], *, goes_on: bool) -> NDArray[np.float32]:
        """Return the previous poses of the parts; new actors have their present pose."""
        first = np.searchsorted(rows.parts.actor, np.arange(len(rows.records) + 1))
        known = self._poses if goes_on else {}
        self._poses = {record.id: pose[first[index] : first[index + 1]] for index, record in enumerate(rows.records)}
        if not known or not len(pose):
            return pose
        return np.concatenate([known.get(actor_id, now) for actor_id, now in self._poses.items()])


def _survey(episode: "Episode", bodies: "BlueprintMeshes") -> _ActorRows:
    actors = episode.actors
    records = [record for record in actors if record.kind in _VISIBLE and bodies.parts(record.description)]
    embodied = [record.slot != NO_BODY for record in records]
    kinds = np.array(
        [record.kind if own else BlueprintKind.PROP for record, own in zip(records, embodied, strict=True)], int
    )
    return _ActorRows(
        records=records,
        row=np.array([actors.row(record.id) for record in records], np.int32),
        slot=np.array([_carrying_slot(episode, record) for record in records], np.int32),
        vehicles=np.flatnonzero(kinds == BlueprintKind.VEHICLE),
        walkers=np.flatnonzero(kinds == BlueprintKind.WALKER),
        parts=PartRows.of([record.description for record in records], bodies),
    )


def _carrying_slot(episode: "Episode", record: ActorRecord) -> int:
    bearer: ActorRecord | None = record
    while bearer is not None and bearer.slot == NO_BODY:
        bearer = episode.actors.find(bearer.parent_id)
    return NO_BODY if bearer is None else bearer.slot


def _colour(description: ActorDescription) -> tuple[int, ...]:
    return tuple(int(part) for part in description.attribute("color", _UNPAINTED).split(","))


def _motion(episode: "Episode", slot: I32) -> tuple[F64, F64]:
    """Return velocity and angular velocity (A, 3) of actors; zeros where nothing moves them."""
    moved = (slot != NO_BODY)[:, None]
    bodies = episode.bodies
    return np.where(moved, bodies.velocity[slot], 0.0), np.where(moved, bodies.angular_velocity[slot], 0.0)


def _lights(records: list[ActorRecord], now_s: float) -> NDArray[np.uint32]:
    shining = np.zeros(len(records), np.uint32)
    state = np.array([record.light_state for record in records], np.int64)
    for bit, lamps in _LAMPS_OF_BIT.items():
        shining |= np.where(state & bit, np.uint32(sum(1 << lamp for lamp in lamps)), np.uint32(0))
    if int(now_s * 2.0 * _BLINKS_HZ) % 2:
        shining &= ~_BLINKING
    return shining
