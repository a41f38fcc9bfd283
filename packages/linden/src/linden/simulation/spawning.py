"""Spawning and destroying actors: checks, free room, bodies; the size and mass of props.

What CARLA tags as dynamic lies loose (cones, bins, boxes, barriers), and so do warning signs on stands: a car that hits
one pushes it away. The rest stands fast until ``set_simulate_physics(True)`` lets it go, as scripts for CARLA do with
containers; from then on its mass decides. ``static.prop.mesh`` is loose if its ``mass`` is above 0, as in CARLA; its
mesh is Unreal's and not available here, so it is a cube of 1 m times its ``scale``.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.blueprints.library import Blueprint, BlueprintKind
from linden.errors import Refusal
from linden.geometry import compose
from linden.physics.bodies import Bodies
from linden.physics.contact.statics import Statics, scenery_type
from linden.physics.state import Rows
from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.enums import SemanticTag
from linden.protocol.values.space import BoundingBox, Transform, Vector3D
from linden.simulation.actor_table import NO_BODY, ActorRecord
from linden.simulation.episode import Episode
from linden.simulation.friction import FRICTION_TRIGGER, trigger
from linden.simulation.overlap import touching, world_centres

MESH = "static.prop.mesh"
LOOSE_SIGNS = ("static.prop.warningaccident", "static.prop.warningconstruction")
MESH_DENSITY_KGPM3 = 60.0
"""Of a mesh without a given mass, once its physics is on; as ``blueprints.library`` estimates other props."""


class Solid(NamedTuple):
    """A prop's box in its own frame, its mass, and whether it moves when it is hit."""

    box: BoundingBox
    mass_kg: float
    loose: bool


def solid(blueprint: Blueprint, description: ActorDescription) -> Solid:
    """Return what is put into the world for a checked description of a prop.

    Raises:
        Refusal: the scale of a mesh is 0.
    """
    if description.id != MESH:
        loose = bytes([SemanticTag.DYNAMIC]) == blueprint.semantic_tags or description.id in LOOSE_SIGNS
        return Solid(blueprint.box, blueprint.mass_kg, loose)
    mass_kg, scale = description.number("mass"), description.number("scale")
    if scale == 0.0:
        raise Refusal(f"Spawn failed because of invalid actor description: {MESH} needs a scale above 0")
    centre, half = (Vector3D(*(scale * value for value in vector)) for vector in blueprint.box[:2])
    weight_kg = mass_kg or MESH_DENSITY_KGPM3 * scale**3
    return Solid(BoundingBox(centre, half), weight_kg, mass_kg > 0.0)


NEEDS_ROOM = (BlueprintKind.VEHICLE, BlueprintKind.WALKER)
"""Props are put where the caller says, as CARLA does; vehicles and walkers only where nothing stands."""

_REACH_M = 8.0
"""No corner of a vehicle or walker lies further from its origin; the longest, a bus, has 5.5 m."""

_OF_THE_MAP = (BlueprintKind.TRAFFIC_LIGHT, BlueprintKind.TRAFFIC_SIGN)


def spawn(
    episode: Episode, blueprint: Blueprint, description: ActorDescription, pose: Transform, parent_id: int
) -> ActorRecord:
    """Put an actor into the episode; ``pose`` is relative to the parent where ``parent_id`` is not 0.

    Raises:
        Refusal: no such parent, or something stands there; begins with CARLA's own words.
    """
    if parent_id and parent_id not in episode.actors:
        raise Refusal(f"unable to attach actor: parent actor not found (no actor has id {parent_id})")
    world_pose = compose(episode.transform(parent_id), pose) if parent_id else pose
    made_trigger = trigger(description) if description.id == FRICTION_TRIGGER else None
    box = made_trigger.box if made_trigger else blueprint.box
    if blueprint.kind is BlueprintKind.PROP:
        box = solid(blueprint, description).box
    if blueprint.kind in NEEDS_ROOM:
        _refuse_without_room(episode, blueprint, world_pose)
    record = ActorRecord(
        id=episode.actors.next_id(),
        description=description,
        kind=blueprint.kind,
        box=box,
        semantic_tags=blueprint.semantic_tags,
        parent_id=parent_id,
        slot=NO_BODY if parent_id else embody(episode.bodies, blueprint, description, world_pose),
    )
    episode.actors.add(record, world_pose, pose if parent_id else None)
    if record.slot != NO_BODY:
        episode.below_ground.arrive(record.slot)
    if made_trigger is not None:
        episode.friction.add(record.id, made_trigger)
    return record


def embody(bodies: Bodies, blueprint: Blueprint, description: ActorDescription, pose: Transform) -> int:
    """Add the body of a checked description and return its slot, ``NO_BODY`` where the actor occupies no space."""
    if blueprint.vehicle is not None:
        model = blueprint.vehicle
        slot = bodies.add_vehicle(model.physics, pose, blueprint.box, model.wheel_offsets_m, model.undercarriage)
        bodies.set_sticky(slot, sticky=description.flag("sticky_control"))
        return slot
    if blueprint.kind is BlueprintKind.WALKER:
        return bodies.add_walker(pose, blueprint.box, blueprint.mass_kg)
    if blueprint.kind is BlueprintKind.PROP:
        made = solid(blueprint, description)
        slot = bodies.add_prop(pose, made.box, made.mass_kg)
        bodies.set_simulate(slot, simulate=made.loose)
        return slot
    return NO_BODY


def _refuse_without_room(episode: Episode, blueprint: Blueprint, pose: Transform) -> None:
    other = _first_touching(episode, blueprint.box, pose)
    if other is None:
        return
    free = next(
        (point for point in _by_distance(episode, pose) if _first_touching(episode, blueprint.box, point) is None), None
    )
    at = ", ".join(f"{value:.2f}" for value in pose.location)
    advice = "no recommended spawn point is free" if free is None else f"the nearest free spawn point is {_place(free)}"
    raise Refusal(f"Spawn failed because of collision at spawn position ({at}): {other} stands there; {advice}")


def _place(pose: Transform) -> str:
    return f"({pose.location.x:.2f}, {pose.location.y:.2f}, {pose.location.z:.2f}), yaw {pose.rotation.yaw:.0f}"


def _by_distance(episode: Episode, pose: Transform) -> list[Transform]:
    def distance_m(point: Transform) -> float:
        return abs(point.location.x - pose.location.x) + abs(point.location.y - pose.location.y)

    return sorted(episode.map.spawn_points, key=distance_m)[:20]


def _first_touching(episode: Episode, box: BoundingBox, pose: Transform) -> str | None:
    """Return the name of what stands where a box would be: a body first, then the scenery."""
    bodies, statics = episode.bodies, episode.statics
    found = bodies_at(bodies.state, box, pose)
    if found.size:
        record = episode.actors.of_slot(int(found[0]))
        return f"{record.description.id} (actor {record.id})"
    return scenery_at(statics, box, pose)


def bodies_at(state: Rows, box: BoundingBox, pose: Transform) -> NDArray[np.intp]:
    """Return the rows of BODY (N,) with solid bodies that a box at ``pose`` would touch, ascending."""
    solid = np.flatnonzero(state["alive"] & state["collides"])
    return touching(box, pose, world_centres(state), state["half_extent"], state["rotation"][:, 1], solid)


def scenery_at(statics: Statics, box: BoundingBox, pose: Transform) -> str | None:
    """Return the type of the first piece of scenery that a box at ``pose`` would touch; None if there is none."""
    near = statics.near(pose.location.x, pose.location.y, _REACH_M)
    found = touching(box, pose, statics.centre, statics.half, statics.yaw_rad, near)
    return scenery_type(int(statics.tag[found[0]])) if found.size else None


def destroy(episode: Episode, actor_id: int, *, announce: bool = False) -> None:
    """Take an actor out of the episode; ``announce`` where no client asked for it.

    What is attached to it stays where it is, attached to nothing: ``UActorDispatcher::DestroyActor`` of CARLA destroys
    an actor and its controller, and Unreal detaches the rest. Programs destroy their sensors themselves.

    Raises:
        Refusal: there is none of that id, or it belongs to the map.
    """
    record = episode.actors.find(actor_id)
    if record is None:
        raise Refusal(f"unable to destroy actor: not found (no actor has id {actor_id})")
    if record.kind in _OF_THE_MAP or actor_id == episode.spectator_id:
        raise Refusal(f"unable to destroy actor: {record.description.id} (actor {actor_id}) belongs to the map")
    for child in episode.actors.children(actor_id):
        episode.actors.detach(child.id)
    record = episode.actors.remove(actor_id, announce=announce)
    if record.slot != NO_BODY:
        episode.bodies.remove(record.slot)
        episode.forget_contacts(record.slot)
    episode.doors.forget(actor_id)
    episode.friction.forget(actor_id)
    episode.poses.forget(actor_id)
