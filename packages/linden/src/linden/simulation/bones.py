"""The bones, sockets and components of any actor: where they are now, and the poses that clients give walkers.

Walkers have CARLA's skeleton; a vehicle has its body and its wheels, which steer and turn. As in Unreal, every bone is
a socket too. What else there is (animals, props, sensors, signs) has one component and no bones.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.blueprints.library import ANIMALS, BlueprintKind
from linden.blueprints.skeleton import blended, frame_of, in_component, skeleton, transform_of, walking_pose
from linden.errors import Refusal
from linden.physics.columns import finite
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.simulation.actor_table import NO_BODY, ActorRecord, ActorRefusal
from linden.simulation.state import EpisodeState

F64 = NDArray[np.float64]

_WHEELS = {
    2: ("Wheel_Front", "Wheel_Rear"),
    4: ("Wheel_Front_Left", "Wheel_Front_Right", "Wheel_Rear_Left", "Wheel_Rear_Right"),
}
"""Names of CARLA's vehicle skeletons, in the order of the physics control's wheels."""

_COMPONENTS = {BlueprintKind.WALKER: ("CollisionCylinder", "CharacterMesh0"), BlueprintKind.VEHICLE: ("VehicleMesh",)}
"""Names that Unreal gives the parts of a character and of a wheeled vehicle; the first is the root."""

_ROOT = ("DefaultSceneRoot",)

_BLINKERS = {
    "front-blinker-l-1": (1.0, -1.0),
    "front-blinker-r-1": (1.0, 1.0),
    "back-blinker-l-1": (-1.0, -1.0),
    "back-blinker-r-1": (-1.0, 1.0),
}
"""Lamps of four-wheeled vehicles, and at which corner (forward, to the right) they are.

CARLA's own example asks for the second (PythonAPI/examples/get_component_test.py); the others are called by analogy,
as the content that names them is not in its sources.
"""


class Bones(NamedTuple):
    """Names and frames (N, 4, 4), in the parent bone's and in the actor's."""

    names: tuple[str, ...]
    in_parent: F64
    in_actor: F64


class Poses:
    """What clients made of walkers' poses, by actor id."""

    def __init__(self) -> None:
        self._custom: dict[int, F64] = {}
        self._blend: dict[int, float] = {}

    def set(self, episode: EpisodeState, actor_id: int, bones: dict[str, Transform]) -> None:
        """Set bones of the custom pose; the others stay, at first as the animation has them now.

        Raises:
            Refusal: no walker has a bone of one of these names.
        """
        unknown = [name for name in bones if skeleton().row(name) is None]
        if unknown:
            raise Refusal(
                f"walkers have no bone '{unknown[0]}'; get_bones lists them ({', '.join(skeleton().names[:4])} …)"
            )
        if actor_id not in self._custom:
            self.take(episode, actor_id)
        for name, transform in bones.items():
            self._custom[actor_id][skeleton().row(name)] = frame_of(transform)

    def take(self, episode: EpisodeState, actor_id: int) -> None:
        """Make the pose that the animation has now the custom pose."""
        self._custom[actor_id] = _animated(episode, actor_id)

    def blend(self, actor_id: int, share: float) -> None:
        """Show the custom pose: 0 not at all, 1 alone."""
        self._blend[actor_id] = finite(share, 0.0, 1.0)

    def is_posed(self, actor_id: int) -> bool:
        """Whether a walker shows anything of a custom pose."""
        return actor_id in self._custom and self._blend.get(actor_id, 0.0) != 0.0

    def forget(self, actor_id: int) -> None:
        """Forget a walker that is gone."""
        self._custom.pop(actor_id, None)
        self._blend.pop(actor_id, None)

    def shown(self, episode: EpisodeState, actor_id: int) -> F64:
        """Return the pose that a walker shows, (N, 4, 4) in the parents' frames."""
        animated, share = _animated(episode, actor_id), self._blend.get(actor_id, 0.0)
        custom = self._custom.get(actor_id)
        return animated if custom is None or share == 0.0 else blended(animated, custom, share)


def _animated(episode: EpisodeState, actor_id: int) -> F64:
    slot = episode.walker(actor_id)
    if not _is_person(episode.actors.get(actor_id)):
        raise ActorRefusal("animals have no bones; only walker.pedestrian.* take a pose", actor_id)
    stature_m = 2.0 * episode.actors.get(actor_id).box.extent.z
    velocity = episode.bodies.velocity[slot]
    speed_mps = 0.0 if episode.walkers.is_dead(actor_id) else float(np.hypot(velocity[0], velocity[1]))
    return walking_pose(stature_m, episode.walkers.walked_m(actor_id), speed_mps)


def _is_person(record: ActorRecord) -> bool:
    """Whether it has CARLA's skeleton: a walker that is no animal."""
    return record.kind is BlueprintKind.WALKER and not record.description.id.startswith(ANIMALS)


def bones_of(episode: EpisodeState, actor_id: int) -> Bones:
    """Return the bones of an actor as they are now.

    Raises:
        ActorRefusal: no such actor, or it has none.
    """
    record = episode.actors.get(actor_id)
    if _is_person(record) and record.slot != NO_BODY:
        pose = episode.poses.shown(episode, actor_id)
        return Bones(skeleton().names, pose, _mesh_frame(record) @ in_component(pose))
    if record.kind is BlueprintKind.VEHICLE and record.slot != NO_BODY:
        frames = np.stack([np.eye(4), *_wheels(episode, record.slot)])
        return Bones(("Vehicle_Base", *_WHEELS[len(frames) - 1]), frames, frames)
    raise ActorRefusal("Component could not be found in this actor:  Component Name: SkinnedMeshComponent", actor_id)


def in_skeleton(episode: EpisodeState, actor_id: int, bones: Bones) -> F64:
    """Return the frames of bones in that of the component they belong to."""
    frames: F64 = np.linalg.inv(component(episode, actor_id, _mesh_name(episode, actor_id))) @ bones.in_actor
    return frames


def _mesh_name(episode: EpisodeState, actor_id: int) -> str:
    """Return the component that has the bones."""
    return _COMPONENTS.get(episode.actors.get(actor_id).kind, _ROOT)[-1]


def sockets_of(episode: EpisodeState, actor_id: int) -> Bones:
    """Return what can be attached to of an actor; nothing where it has no bones.

    Raises:
        ActorRefusal: no such actor.
    """
    record = episode.actors.get(actor_id)
    if (_is_person(record) or record.kind is BlueprintKind.VEHICLE) and record.slot != NO_BODY:
        return bones_of(episode, actor_id)
    return Bones((), np.empty((0, 4, 4)), np.empty((0, 4, 4)))


def _wheels(episode: EpisodeState, slot: int) -> list[F64]:
    """Return the frame of each wheel's hub in the vehicle's."""
    bodies = episode.bodies
    spec = bodies.spec(slot)
    hubs = []
    for wheel in range(int(spec["wheel_count"])):
        place = Vector3D(*(float(spec[name][wheel]) for name in ("wheel_x_m", "wheel_y_m", "wheel_radius_m")))
        turned = Rotation(bodies.wheel_pitch_deg(slot, wheel), float(np.degrees(bodies.wheel_steer[slot, wheel])), 0.0)
        hubs.append(frame_of(Transform(place, turned)))
    return hubs


def _mesh_frame(record: ActorRecord) -> F64:
    """Return where a walker's skeleton begins: under the middle of the body, between the feet."""
    return frame_of(Transform(Vector3D(0.0, 0.0, -record.box.extent.z), Rotation(0.0, 0.0, 0.0)))


def component_names(episode: EpisodeState, actor_id: int) -> tuple[str, ...]:
    """Return the names of an actor's components.

    Raises:
        ActorRefusal: no such actor.
    """
    record = episode.actors.get(actor_id)
    names = _COMPONENTS.get(record.kind, _ROOT)
    return (*names, *_BLINKERS) if _has_blinkers(episode, record) else names


def component(episode: EpisodeState, actor_id: int, name: str) -> F64:
    """Return the frame (4, 4) of a component in the actor's.

    Raises:
        ActorRefusal: no such actor, or it has no such component.
    """
    names = component_names(episode, actor_id)
    if name not in names:
        raise ActorRefusal(f"Component could not be found in this actor:  Component Name: {name}", actor_id)
    record = episode.actors.get(actor_id)
    if name in _BLINKERS:
        return _blinker_frame(record, *_BLINKERS[name])
    return _mesh_frame(record) if record.kind is BlueprintKind.WALKER and name != names[0] else np.eye(4)


def _has_blinkers(episode: EpisodeState, record: ActorRecord) -> bool:
    """Whether this is a vehicle with four wheels; CARLA's bicycles have no lamps, and its motorcycles other ones."""
    has_body = record.kind is BlueprintKind.VEHICLE and record.slot != NO_BODY
    return has_body and int(episode.bodies.spec(record.slot)["wheel_count"]) == len(_WHEELS[4])


def _blinker_frame(record: ActorRecord, forward: float, right: float) -> F64:
    """Return where a blinker is: at its corner of the vehicle's box, half way up, looking forward or back."""
    middle, half = record.box.location, record.box.extent
    place = Vector3D(middle.x + forward * half.x, middle.y + right * half.y, middle.z)
    return frame_of(Transform(place, Rotation(0.0, 0.0 if forward > 0.0 else 180.0, 0.0)))


def in_world(episode: EpisodeState, actor_id: int, frames: F64) -> list[Transform]:
    """Return frames (N, 4, 4) of the actor's as transforms of the world's."""
    actor = frame_of(episode.transform(actor_id))
    return [transform_of(actor @ frame) for frame in frames]
