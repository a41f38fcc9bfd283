"""Open doors of vehicles.

CARLA swings a collider of its own out for each open door. Here an open door takes no space: the body is one box, and
widened over its whole length it would hit what no door reaches. What can be told is kept: which doors are open.
"""

from collections.abc import Mapping
from enum import IntEnum
from types import MappingProxyType

from linden.errors import Refusal
from linden.simulation.actor_table import ActorRecord


class Door(IntEnum):
    """CARLA's ``EVehicleDoor``; the official client has names for the first four and for all."""

    FRONT_LEFT = 0
    FRONT_RIGHT = 1
    REAR_LEFT = 2
    REAR_RIGHT = 3
    HOOD = 4
    TRUNK = 5
    ALL = 6


SIDE_DOORS = (Door.FRONT_LEFT, Door.FRONT_RIGHT, Door.REAR_LEFT, Door.REAR_RIGHT)
"""The doors of every blueprint with dynamic doors; CARLA's models name no others."""


class Doors:
    """The doors of an episode. A door is closed until a client opens it."""

    def __init__(self) -> None:
        self._open: dict[int, frozenset[Door]] = {}

    @property
    def open(self) -> Mapping[int, frozenset[Door]]:
        """Open doors by actor id, of vehicles with open doors."""
        return MappingProxyType(self._open)

    def swing(self, vehicle: ActorRecord, door: int, *, opens: bool) -> None:
        """Open or close one door, or all.

        Raises:
            Refusal: the vehicle has no such door, or none that move.
        """
        chosen = _chosen(vehicle, door)
        before = self._open.get(vehicle.id, frozenset())
        after = before | chosen if opens else before - chosen
        if after:
            self._open[vehicle.id] = after
        else:
            self._open.pop(vehicle.id, None)

    def forget(self, actor_id: int) -> None:
        """Drop what is known of an actor that has gone."""
        self._open.pop(actor_id, None)


def _chosen(vehicle: ActorRecord, door: int) -> frozenset[Door]:
    """Return the doors that a number of the wire means, on a vehicle that has them."""
    name = vehicle.description.id
    if not vehicle.description.flag("has_dynamic_doors"):
        raise Refusal(f"{name} (actor {vehicle.id}) has no doors that move: its attribute has_dynamic_doors is false")
    if door == Door.ALL:
        return frozenset(SIDE_DOORS)
    if door not in SIDE_DOORS:
        raise Refusal(f"{name} (actor {vehicle.id}) has no door {door}; it has 0 to 3 (FL, FR, RL, RR), and 6 is all")
    return frozenset({Door(door)})
