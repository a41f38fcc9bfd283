"""Blueprints of CARLA for entities, and poses between OpenDRIVE's axes and CARLA's.

OpenDRIVE: x east, y north, heading to the left. CARLA: x east, y south, yaw to the right. The reference point of an
entity is where its file puts it, such as the middle of the rear axle; BASU's bodies are boxes about their middle.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from basu.scenarios.stage import Pose

if TYPE_CHECKING:
    from basu_openscenario.playing.mover import Mover
    from basu_openscenario.reading.entities import Entity

VEHICLES = {
    "car": "vehicle.nissan.micra",
    "van": "vehicle.mercedes.sprinter",
    "truck": "vehicle.carlamotors.carlacola",
    "semitrailer": "vehicle.carlamotors.carlacola",
    "trailer": "vehicle.carlamotors.carlacola",
    "bus": "vehicle.mitsubishi.fusorosa",
    "tram": "vehicle.mitsubishi.fusorosa",
    "train": "vehicle.mitsubishi.fusorosa",
    "motorbike": "vehicle.yamaha.yzf",
    "bicycle": "vehicle.gazelle.omafiets",
}
"""The blueprint of each category of vehicles."""
ROLES = {
    "ambulance": "vehicle.ford.ambulance",
    "fire": "vehicle.carlamotors.firetruck",
    "police": "vehicle.dodge.charger_police",
}
"""The blueprint of vehicles with a role; other roles are not shown."""
ROLE_CATEGORIES = ("car", "van", "truck")
"""The categories of which a role changes the blueprint."""
ADULT, CHILD = "walker.pedestrian.0001", "walker.pedestrian.0009"
GROWN_M = 1.4
"""A pedestrian with a lower box is a child."""
THINGS = {
    "barrier": "static.prop.streetbarrier",
    "railing": "static.prop.streetbarrier",
    "pole": "static.prop.trafficcone01",
    "tree": "static.prop.trafficcone01",
}
THING = "static.prop.streetbarrier"
"""The blueprint of objects of other categories."""


class Heading(NamedTuple):
    """A point and a direction in OpenDRIVE's axes: m and rad, to the left."""

    x_m: float
    y_m: float
    h_rad: float


def blueprint_of(entity: Entity) -> str:
    """Return the blueprint of an entity: its model if that is one of CARLA's, otherwise by its role or category."""
    if entity.model.startswith(("vehicle.", "walker.", "static.")):
        return entity.model
    if entity.role in ROLES and entity.category in ROLE_CATEGORIES:
        return ROLES[entity.role]
    if entity.kind == "vehicle":
        return VEHICLES.get(entity.category, VEHICLES["car"])
    if entity.kind == "pedestrian":
        return CHILD if 0.0 < entity.box.height_m < GROWN_M else ADULT
    return THINGS.get(entity.category, THING)


def middle_of(mover: Mover) -> Pose:
    """Return the middle of an entity's box, on the ground, in CARLA's axes."""
    place, centre = mover.place, mover.entity.box.centre_m
    cos, sin = math.cos(place.h_rad), math.sin(place.h_rad)
    x_m = place.x_m + centre[0] * cos - centre[1] * sin
    y_m = place.y_m + centre[0] * sin + centre[1] * cos
    return Pose(x_m, -y_m, place.z_m, math.remainder(-place.h_rad, math.tau))


def reference_of(x_m: float, y_m: float, yaw_rad: float, entity: Entity) -> Heading:
    """Return the reference point of an entity from the middle of its box in CARLA's axes."""
    h_rad, centre = -yaw_rad, entity.box.centre_m
    cos, sin = math.cos(h_rad), math.sin(h_rad)
    return Heading(
        x_m - centre[0] * cos + centre[1] * sin,
        -y_m - centre[0] * sin - centre[1] * cos,
        h_rad,
    )
