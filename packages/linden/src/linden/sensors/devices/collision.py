"""The collision sensor: contacts of the body that carries the sensor.

Source of meaning: CARLA 0.9.16, CollisionSensor.cpp: an event in every frame of contact, one a pair.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.physics.contact.statics import scenery_type
from linden.protocol.values.space import Vector3D
from linden.structured import StructuredArray

SCENERY = -1
"""Slot of what is no body but part of the scenery."""


class Collision(NamedTuple):
    """One event of one sensor.

    ``other_slot`` is ``SCENERY`` where the sensor's carrier hit no body; ``scenery_type`` then names what it hit, as
    the client will see it. ``impulse_ns`` is what the carrier took, world, N·s; ``point_m`` where, world.
    """

    sensor_id: int
    slot: int
    other_slot: int
    scenery_type: str
    impulse_ns: Vector3D
    point_m: Vector3D


def collisions(contacts: StructuredArray, carriers: Mapping[int, Sequence[int]]) -> Iterable[Collision]:
    """Yield what the sensors notice of a frame's contacts, in the order of the contacts; a's sensors before b's.

    Args:
        contacts: rows with slots ``a`` and ``b`` (``SCENERY`` where a hit the scenery), ``static_id``, ``tag`` of the
            scenery, ``impulse`` (3,) on a and ``point`` (3,). A pair may have several rows, one for each part of the
            frame's time: their impulses add up, the place is that of the first.
        carriers: ids of the sensors attached to the body in a slot.
    """
    for row, impulse in _pairs(contacts):
        first, second = int(row["a"]), int(row["b"])
        kind = "" if second != SCENERY else scenery_type(int(row["tag"]))
        point = Vector3D(*map(float, row["point"]))
        for slot, other, sign in ((first, second, 1.0), (second, first, -1.0)):
            taken = Vector3D(*(sign * float(part) for part in impulse))
            for sensor_id in carriers.get(slot, ()):
                yield Collision(sensor_id, slot, other, kind, taken, point)


def _pairs(contacts: StructuredArray) -> list[tuple[np.void, NDArray[np.float64]]]:
    """Return the first row of each pair and the sum of the impulses of all its rows.

    Two pieces of scenery of one kind count as one, as they reach the client under one name.
    """
    found: dict[tuple[int, int, int], tuple[np.void, NDArray[np.float64]]] = {}
    for row in contacts:
        pair = (int(row["a"]), int(row["b"]), int(row["tag"]) if row["b"] == SCENERY else 0)
        if pair in found:
            found[pair][1][:] += row["impulse"]
        else:
            found[pair] = (row, np.array(row["impulse"], np.float64))
    return list(found.values())
