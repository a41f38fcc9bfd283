"""What a driver meets on the road: the kinds of conflict partners, and the kind of a blueprint.

Scenarios state their partner by these kinds, and a driver can be made blind to one of them (`basic:no-cyclists`).
"""

from __future__ import annotations

import enum


class Partner(enum.Enum):
    """The kind of a conflict partner, an actor or a control device."""

    NONE = "none"  # the vehicle's own course is disturbed, and no other takes part
    WALKER = "walker"
    CYCLIST = "cyclist"
    VEHICLE = "vehicle"  # a motor vehicle
    ANIMAL = "animal"
    PROP = "prop"  # a thing that lies or stands about
    SIGN = "sign"  # a stop sign or a yield sign
    LIGHT = "light"  # a traffic light


ANIMALS = "walker.animal."  # Linden's; CARLA has none
BICYCLES = ("vehicle.bh.crossbike", "vehicle.diamondback.century", "vehicle.gazelle.omafiets")
UNPROTECTED = ("walker.", *BICYCLES)
"""Blueprints of people and animals, which no body shell protects: walkers and CARLA's bicycles."""

PARTNER_OF_PREFIX = {
    ANIMALS: Partner.ANIMAL,
    "walker.": Partner.WALKER,
    **dict.fromkeys(BICYCLES, Partner.CYCLIST),
    "vehicle.": Partner.VEHICLE,
    "static.prop.": Partner.PROP,
    "traffic.traffic_light": Partner.LIGHT,
    "traffic.": Partner.SIGN,
}
ACTORS = frozenset({Partner.WALKER, Partner.CYCLIST, Partner.VEHICLE, Partner.ANIMAL, Partner.PROP})


def partner_of(type_id: str) -> Partner:
    """Return the kind of an actor by its blueprint's id; `NONE` for sensors and the like."""
    return next((kind for prefix, kind in PARTNER_OF_PREFIX.items() if type_id.startswith(prefix)), Partner.NONE)
