"""Names and topics of actors on ROS 2, as in CARLA's own publisher, and which actors take commands from ROS 2."""

from typing import TYPE_CHECKING

from linden_ros2.topic import NAME

if TYPE_CHECKING:
    from linden.simulation.actor_table import ActorRecord, ActorTable

DRIVEN_ROLES = ("hero", "ego")
"""Roles of the vehicles that CARLA lets ROS 2 drive: ActorDispatcher.cpp."""


def ros_name(actor: "ActorRecord") -> str:
    """Return the name of an actor.

    It is the attribute ``ros_name`` that a client has set; CARLA's default of it, the blueprint's id, counts as none.
    Without one a hero or ego vehicle has its role. Other actors have the end of the blueprint's id with a number: a
    sensor its stream, others their id. CARLA calls such a hero ``vehicle`` with its id.
    """
    given = given_name(actor)
    if given:
        return given
    last = actor.description.id.rpartition(".")[2]
    if actor.stream_id:
        return f"{last}{actor.stream_id}"
    if actor.description.id.startswith("vehicle."):
        role = actor.description.attribute("role_name")
        return role if role in DRIVEN_ROLES else f"vehicle{actor.id}"
    return f"{last}{actor.id}"


def given_name(actor: "ActorRecord") -> str:
    """Return the name that a client gave an actor, "" if it gave none."""
    given = actor.description.attribute("ros_name")
    return "" if given == actor.description.id else given


def is_driven(actor: "ActorRecord") -> bool:
    """Return whether commands of ROS 2 drive an actor: a hero or ego vehicle, or one with a name of its own."""
    if not actor.description.id.startswith("vehicle."):
        return False
    return bool(given_name(actor)) or actor.description.attribute("role_name") in DRIVEN_ROLES


def path_of(actor: "ActorRecord", actors: "ActorTable") -> str:
    """Return the names of an actor's parents and its own, with slashes: what follows ``/carla/`` in its topics."""
    names = [ros_name(actor)]
    parent = actors.find(actor.parent_id)
    while parent is not None:
        names.append(ros_name(parent))
        parent = actors.find(parent.parent_id)
    return "/".join(reversed(names))


def is_usable(path: str) -> bool:
    """Return whether ROS 2 takes such names in a topic."""
    return all(NAME.fullmatch(part) for part in path.split("/"))
