"""Functions of walkers, and of the bones, sockets and components of all actors.

Source of names: LibCarla 0.9.16, ``CarlaServer.cpp``.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from linden.blueprints.skeleton import transform_of
from linden.protocol.values.control import WalkerControl
from linden.protocol.values.space import Transform
from linden.protocol.wire.decode import U32
from linden.server.rpc.context import Context
from linden.server.rpc.registry import method
from linden.simulation import bones


@method("apply_control_to_walker")
def apply_control_to_walker(context: Context, actor_id: U32, control: WalkerControl) -> None:
    """Set where a walker goes; it holds until the next call."""
    episode = context.world.episode
    slot = episode.walker(actor_id)
    episode.walkers.refuse_dead(actor_id)
    episode.bodies.set_walker_control(slot, control)


def apply_walker_state(context: Context, actor_id: int, pose: Transform, speed_mps: float) -> None:
    """Put a walker onto its navigation mesh, going on at ``speed_mps``: z is that of the surface under its feet."""
    lead(context, [(actor_id, pose, speed_mps)])


def lead(context: Context, states: Sequence[tuple[int, Transform, float]]) -> None:
    """Put walkers onto the mesh: what a client that has AI controllers sends every tick.

    Raises:
        ActorRefusal: one of them is none, or dead; then none is moved.
    """
    episode = context.world.episode
    for actor_id, _, _ in states:
        episode.walker(actor_id)
        episode.walkers.refuse_dead(actor_id)
    speeds_mps = np.array([speed_mps for _, _, speed_mps in states])
    episode.walkers.lead(episode, [state[0] for state in states], [state[1] for state in states], speeds_mps)


@method("set_actor_dead")
def set_actor_dead(context: Context, actor_id: U32) -> None:
    """Let a walker fall and lie for ten seconds, then remove it. The client's crowd calls this after a collision."""
    episode = context.world.episode
    episode.walkers.die(episode, actor_id)


class BoneOut(NamedTuple):
    """A bone of a walker: in the world, in the actor, and in the parent bone's frame."""

    name: str
    world: Transform
    component: Transform
    relative: Transform


class BonesOut(NamedTuple):
    """All bones of a walker."""

    bones: list[BoneOut]


class BoneIn(NamedTuple):
    """A bone of a custom pose, in the parent bone's frame."""

    name: str
    relative: Transform


class BonesIn(NamedTuple):
    """The bones of a custom pose that are to change."""

    bones: list[BoneIn]


@method("get_bones_transform")
def get_bones_transform(context: Context, actor_id: U32) -> BonesOut:
    """Return a walker's bones as they are now."""
    episode = context.world.episode
    episode.walker(actor_id)
    found = bones.bones_of(episode, actor_id)
    world = bones.in_world(episode, actor_id, found.in_actor)
    columns = zip(
        found.names, world, map(transform_of, found.in_actor), map(transform_of, found.in_parent), strict=True
    )
    return BonesOut([BoneOut(*bone) for bone in columns])


@method("set_bones_transform")
def set_bones_transform(context: Context, actor_id: U32, pose: BonesIn) -> None:
    """Set bones of a walker's custom pose, which ``blend_pose`` shows."""
    episode = context.world.episode
    episode.walker(actor_id)
    episode.poses.set(episode, actor_id, {bone.name: bone.relative for bone in pose.bones})


@method("blend_pose")
def blend_pose(context: Context, actor_id: U32, share: float) -> None:
    """Show the walking animation (0), the custom pose (1), or what lies between."""
    episode = context.world.episode
    episode.walker(actor_id)
    episode.poses.blend(actor_id, share)


@method("get_pose_from_animation")
def get_pose_from_animation(context: Context, actor_id: U32) -> None:
    """Make what the animation shows now the custom pose."""
    episode = context.world.episode
    episode.poses.take(episode, actor_id)


@method("get_actor_bone_names")
def get_actor_bone_names(context: Context, actor_id: U32) -> list[str]:
    """Return the names of an actor's bones."""
    return list(bones.bones_of(context.world.episode, actor_id).names)


@method("get_actor_bone_world_transforms")
def get_actor_bone_world_transforms(context: Context, actor_id: U32) -> list[Transform]:
    """Return where an actor's bones are, in the order of their names."""
    episode = context.world.episode
    return bones.in_world(episode, actor_id, bones.bones_of(episode, actor_id).in_actor)


@method("get_actor_bone_relative_transforms")
def get_actor_bone_relative_transforms(context: Context, actor_id: U32) -> list[Transform]:
    """Return where an actor's bones are in the frame of its skeleton."""
    episode = context.world.episode
    found = bones.bones_of(episode, actor_id)
    return [transform_of(frame) for frame in bones.in_skeleton(episode, actor_id, found)]


@method("get_vehicle_bone_world_transforms")
def get_vehicle_bone_world_transforms(context: Context, actor_id: U32) -> list[Transform]:
    """Return where a vehicle's body and wheels are."""
    episode = context.world.episode
    episode.vehicle(actor_id)
    return bones.in_world(episode, actor_id, bones.bones_of(episode, actor_id).in_actor)


@method("get_actor_socket_names")
def get_actor_socket_names(context: Context, actor_id: U32) -> list[str]:
    """Return the names of what something can be attached to: every bone is a socket."""
    return list(bones.sockets_of(context.world.episode, actor_id).names)


@method("get_actor_socket_world_transforms")
def get_actor_socket_world_transforms(context: Context, actor_id: U32) -> list[Transform]:
    """Return where an actor's sockets are."""
    episode = context.world.episode
    return bones.in_world(episode, actor_id, bones.sockets_of(episode, actor_id).in_actor)


@method("get_actor_socket_relative_transforms")
def get_actor_socket_relative_transforms(context: Context, actor_id: U32) -> list[Transform]:
    """Return where an actor's sockets are in its own frame."""
    return [transform_of(frame) for frame in bones.sockets_of(context.world.episode, actor_id).in_actor]


@method("get_actor_component_names")
def get_actor_component_names(context: Context, actor_id: U32) -> list[str]:
    """Return the names of an actor's components."""
    return list(bones.component_names(context.world.episode, actor_id))


@method("get_actor_component_world_transform")
def get_actor_component_world_transform(context: Context, actor_id: U32, name: str) -> Transform:
    """Return where a component is."""
    episode = context.world.episode
    return bones.in_world(episode, actor_id, bones.component(episode, actor_id, name)[None])[0]


@method("get_actor_component_relative_transform")
def get_actor_component_relative_transform(context: Context, actor_id: U32, name: str) -> Transform:
    """Return where a component is in its actor's frame."""
    return transform_of(bones.component(context.world.episode, actor_id, name))
