"""Any actor: blueprints, spawning, destroying, moving and pushing. Source of names: LibCarla 0.9.16."""

import math

from linden.protocol.values.actors import Actor, ActorDefinition, ActorDescription
from linden.protocol.values.space import BoundingBox, Transform, Vector3D
from linden.protocol.wire.decode import U8, U32
from linden.server.rpc.context import Context
from linden.server.rpc.registry import method
from linden.simulation.actor_table import ActorRecord
from linden.simulation.attachments import hung, in_parent

_M2_PER_CM2 = 1e-4


def message(context: Context, record: ActorRecord) -> Actor:
    """Return an actor as the client learns of it."""
    token = context.streams.token(record.stream_id).data if record.stream_id else b""
    return Actor(record.id, record.parent_id, record.description, record.box, record.semantic_tags, token)


@method("get_actor_definitions")
def get_actor_definitions(context: Context) -> tuple[ActorDefinition, ...]:
    """Return the blueprint library."""
    return context.world.library.definitions


@method("get_actors_by_id")
def get_actors_by_id(context: Context, actor_ids: list[U32]) -> list[Actor]:
    """Return the actors of these ids; unknown ids are left out."""
    found = map(context.world.episode.actors.find, actor_ids)
    return [message(context, record) for record in found if record is not None]


@method("get_spectator")
def get_spectator(context: Context) -> Actor:
    """Return the spectator, which every episode has."""
    episode = context.world.episode
    return message(context, episode.actors.get(episode.spectator_id))


@method("spawn_actor")
def spawn_actor(context: Context, description: ActorDescription, pose: Transform) -> Actor:
    """Put an actor into the world, or refuse where something stands there already."""
    return message(context, attach(context, description, pose, 0, ""))


@method("spawn_actor_with_parent")
def spawn_actor_with_parent(
    context: Context, description: ActorDescription, pose: Transform, parent_id: U32, attachment: U8, socket: str
) -> Actor:
    """Attach an actor to another, rigidly or at the end of a spring arm."""
    return message(context, attach(context, description, hung(pose, attachment), parent_id, socket))


def attach(
    context: Context, description: ActorDescription, pose: Transform, parent_id: int, socket: str
) -> ActorRecord:
    """Spawn an actor, which follows its parent, or one of its bones, where ``parent_id`` and ``socket`` name them.

    In asynchronous mode a frame shows it at once. CARLA makes frames as fast as it can, and programs count on theirs:
    draw_skeleton.py sends a walker on its way in the very next call, and crashes where no snapshot has it yet.

    Raises:
        Refusal: no such parent or bone, or the actor cannot be spawned.
    """
    context.frame_is_due = True
    if not socket:
        return context.world.spawn(description, pose, parent_id=parent_id)
    episode = context.world.episode
    at = in_parent(episode, parent_id, socket, pose)
    record = context.world.spawn(description, at, parent_id=parent_id)
    episode.sockets.attach(episode, record.id, socket, pose)
    return record


@method("destroy_actor")
def destroy_actor(context: Context, actor_id: U32) -> bool:
    """Take an actor out of the world; what is attached to it stays where it is, attached to nothing."""
    context.world.destroy(actor_id)
    return True


@method("get_actor_bounding_box")
def get_actor_bounding_box(context: Context, actor_id: U32) -> BoundingBox:
    """Return the box in the actor's frame; the empty box for an unknown id.

    The client then takes the box it knows. Its Traffic Manager asks for vehicles that another client may have destroyed
    since the last snapshot, in a thread where an error would end the whole program.
    """
    record = context.world.episode.actors.find(actor_id)
    return BoundingBox() if record is None else record.box._replace(actor_id=actor_id)


@method("set_actor_transform")
def set_actor_transform(context: Context, actor_id: U32, pose: Transform) -> None:
    """Put an actor somewhere."""
    context.world.episode.place(actor_id, pose)


@method("set_actor_location")
def set_actor_location(context: Context, actor_id: U32, location: Vector3D) -> None:
    """Put an actor somewhere and keep its rotation."""
    episode = context.world.episode
    episode.place(actor_id, episode.own_transform(actor_id)._replace(location=location))


@method("set_actor_target_velocity")
def set_actor_target_velocity(context: Context, actor_id: U32, velocity: Vector3D) -> None:
    """Give an actor a velocity in m/s, in the world."""
    episode = context.world.episode
    episode.bodies.set_target_velocity(episode.body(actor_id), velocity)


@method("set_actor_target_angular_velocity")
def set_actor_target_angular_velocity(context: Context, actor_id: U32, angular_velocity: Vector3D) -> None:
    """Give an actor an angular velocity in degrees/s, about the world's axes."""
    episode = context.world.episode
    radians = Vector3D(*map(math.radians, angular_velocity))
    episode.bodies.set_target_angular_velocity(episode.body(actor_id), radians)


@method("enable_actor_constant_velocity")
def enable_actor_constant_velocity(context: Context, actor_id: U32, velocity: Vector3D) -> None:
    """Hold a velocity in m/s in the actor's own frame until it is disabled."""
    episode = context.world.episode
    episode.bodies.enable_constant_velocity(episode.body(actor_id), velocity)


@method("disable_actor_constant_velocity")
def disable_actor_constant_velocity(context: Context, actor_id: U32) -> None:
    """Let forces rule the actor's velocity again."""
    episode = context.world.episode
    episode.bodies.disable_constant_velocity(episode.body(actor_id))


@method("add_actor_impulse")
def add_actor_impulse(context: Context, actor_id: U32, impulse: Vector3D) -> None:
    """Push an actor at its centre of mass, N·s in the world."""
    episode = context.world.episode
    episode.bodies.add_impulse(episode.body(actor_id), impulse)


@method("add_actor_force")
def add_actor_force(context: Context, actor_id: U32, force: Vector3D) -> None:
    """Push an actor at its centre of mass during the next frame, N in the world."""
    episode = context.world.episode
    episode.bodies.add_force(episode.body(actor_id), force)


@method("add_actor_impulse_at_location")
def add_actor_impulse_at_location(context: Context, actor_id: U32, impulse: Vector3D, location: Vector3D) -> None:
    """Push an actor at a point of the world, N·s."""
    episode = context.world.episode
    episode.bodies.add_impulse(episode.body(actor_id), impulse, location)


@method("add_actor_force_at_location")
def add_actor_force_at_location(context: Context, actor_id: U32, force: Vector3D, location: Vector3D) -> None:
    """Push an actor at a point of the world during the next frame, N."""
    episode = context.world.episode
    episode.bodies.add_force(episode.body(actor_id), force, location)


@method("add_actor_angular_impulse")
def add_actor_angular_impulse(context: Context, actor_id: U32, impulse: Vector3D) -> None:
    """Turn an actor once, kg·cm²·degrees/s about the world's axes; the client's ``add_torque`` calls this too."""
    episode = context.world.episode
    episode.bodies.add_angular_impulse(episode.body(actor_id), _from_unreal(impulse))


@method("add_actor_torque")
def add_actor_torque(context: Context, actor_id: U32, torque: Vector3D) -> None:
    """Turn an actor during the next frame, kg·cm²·degrees/s² about the world's axes."""
    episode = context.world.episode
    episode.bodies.add_torque(episode.body(actor_id), _from_unreal(torque))


def _from_unreal(moment: Vector3D) -> Vector3D:
    """Return a torque or angular impulse in N·m or N·m·s.

    CARLA hands the client's numbers to Unreal as they are (``AddTorqueInDegrees``), which counts in cm and degrees: so
    1e6 of them are a little under 2 N·m.
    """
    return Vector3D(*(math.radians(value) * _M2_PER_CM2 for value in moment))


@method("set_actor_simulate_physics")
def set_actor_simulate_physics(context: Context, actor_id: U32, enabled: bool) -> None:  # noqa: FBT001 - the wire's order
    """Let forces move an actor, or hold it where it is put."""
    episode = context.world.episode
    episode.below_ground.simulate(episode.body(actor_id), wanted=enabled)


@method("set_actor_enable_gravity")
def set_actor_enable_gravity(context: Context, actor_id: U32, enabled: bool) -> None:  # noqa: FBT001 - the wire's order
    """Let an actor fall, or float."""
    episode = context.world.episode
    episode.bodies.set_gravity(episode.body(actor_id), falls=enabled)


@method("set_actor_collisions")
def set_actor_collisions(context: Context, actor_id: U32, enabled: bool) -> None:  # noqa: FBT001 - the wire's order
    """Let an actor stand in the way of others, or be passed through."""
    episode = context.world.episode
    episode.bodies.collides[episode.body(actor_id)] = enabled
