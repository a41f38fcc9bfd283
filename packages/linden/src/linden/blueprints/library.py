"""The blueprint library: every kind of actor that can be spawned, with CARLA 0.9.16's ids, attributes and sizes.

Composed from the facts in data/blueprints.json; traffic lights and signs are no blueprints, they come with the map.
"""

import json
from collections.abc import Iterator
from enum import IntEnum
from functools import cache
from importlib import resources
from typing import Any, NamedTuple

from linden.blueprints import vehicles
from linden.blueprints.attributes import complete, constant, from_facts, names, refuse_unknown, variation
from linden.blueprints.vehicles import VehicleModel
from linden.protocol.values.actors import ActorAttribute, ActorDefinition, ActorDescription
from linden.protocol.values.enums import AttributeType, SemanticTag
from linden.protocol.values.space import BoundingBox, Vector3D

SENSOR_ROLES = ("front", "back", "left", "right", "front_left", "front_right", "back_left", "back_right")
DOT = BoundingBox(Vector3D(), Vector3D(0.05, 0.05, 0.05))
"""Box of what has no size: the official client distrusts a box of zeros."""

ANIMALS = "walker.animal."
"""What the ids of animals begin with: they move as walkers do, and have none of a walker's bones."""

PROP_DENSITY_KG_M3 = 60.0
"""Estimated: what a hollow prop weighs for the volume of its box."""

SIZES = (("tiny", 0.3), ("small", 0.8), ("medium", 2.5), ("big", 5.0))
"""Greatest dimension in m up to which CARLA's word for a prop's size is taken; beyond the last it is huge."""


class BlueprintKind(IntEnum):
    """What an actor is to the server; 0 to 5 are the type bytes of CARLA's recorder."""

    OTHER = 0
    VEHICLE = 1
    WALKER = 2
    TRAFFIC_LIGHT = 3
    TRAFFIC_SIGN = 4
    SENSOR = 5
    PROP = 6
    CONTROLLER = 7
    TRIGGER = 8


class Blueprint(NamedTuple):
    """A kind of actor that can be spawned.

    ``box`` is local: a vehicle's and a prop's origin lies on the ground, a walker's in the middle of the body.
    ``mass_kg`` is 0 where nothing has a body.
    """

    definition: ActorDefinition
    kind: BlueprintKind
    box: BoundingBox
    semantic_tags: bytes = b""
    mass_kg: float = 0.0
    vehicle: VehicleModel | None = None

    @property
    def has_stream(self) -> bool:
        """Whether its actors send measurements; lane invasion is found by the client itself."""
        return self.kind is BlueprintKind.SENSOR and self.definition.id != "sensor.other.lane_invasion"


class BlueprintLibrary:
    """All blueprints, found by id."""

    def __init__(self, blueprints: tuple[Blueprint, ...]) -> None:
        self._by_id = {blueprint.definition.id: blueprint for blueprint in blueprints}
        self.definitions = tuple(blueprint.definition for blueprint in blueprints)

    @classmethod
    def load(cls) -> "BlueprintLibrary":
        """Read the packaged facts; takes a few milliseconds."""
        facts = json.loads(resources.files("linden").joinpath("data/blueprints.json").read_text("utf-8"))
        unnumbered = (
            *_sensors(facts),
            *_statics(facts),
            *_vehicles(facts),
            *_walkers(facts),
            *_others(),
            *_animals(facts),
        )
        return cls(
            tuple(
                blueprint._replace(definition=blueprint.definition._replace(uid=number))
                for number, blueprint in enumerate(unnumbered, start=1)
            )
        )

    def __iter__(self) -> Iterator[Blueprint]:
        return iter(self._by_id.values())

    def find(self, blueprint_id: str) -> Blueprint:
        """Return a blueprint.

        Raises:
            Refusal: there is none of that id; begins with CARLA's words for a spawn refused.
        """
        blueprint = self._by_id.get(blueprint_id)
        if blueprint is None:
            refuse_unknown(blueprint_id, self.definitions)
        return blueprint

    def validate(self, description: ActorDescription) -> ActorDescription:
        """Return a description complete and in the blueprint's order, ready to spawn.

        Raises:
            Refusal: unknown id or attribute, or a value that its attribute cannot take.
        """
        return complete(self.find(description.id).definition, description)


@cache
def packaged() -> BlueprintLibrary:
    """Return the library of the packaged facts, read once in a process; nothing changes it."""
    return BlueprintLibrary.load()


def _definition(blueprint_id: str, attributes: tuple[ActorAttribute, ...]) -> ActorDefinition:
    return ActorDefinition(0, blueprint_id, blueprint_id.replace(".", ","), attributes)


def _sensors(facts: dict[str, Any]) -> Iterator[Blueprint]:
    for name, groups in facts["sensors"].items():
        roles = () if name in facts["sensors_without_place"] else SENSOR_ROLES
        own = [from_facts(facts["sensor_attributes"][group]) for group in groups]
        yield Blueprint(_definition(f"sensor.{name}", sum(own, names(*roles))), BlueprintKind.SENSOR, DOT)


def _statics(facts: dict[str, Any]) -> Iterator[Blueprint]:
    extent = {f"extent_{axis}": 1.0 for axis in "xyz"}
    trigger = (*names(), *from_facts({"friction": 3.5, **extent}))
    yield Blueprint(
        _definition("static.trigger.friction", trigger),
        BlueprintKind.TRIGGER,
        BoundingBox(Vector3D(), Vector3D(1.0, 1.0, 1.0)),
    )
    mesh = (*names("prop"), *from_facts({"mesh_path": "", "mass": 0.0, "scale": 1.0}))
    half_m = Vector3D(0.5, 0.5, 0.5)  # CARLA's size is that of a mesh of Unreal's, which is not available here
    yield Blueprint(
        _definition("static.prop.mesh", mesh), BlueprintKind.PROP, BoundingBox(Vector3D(0.0, 0.0, 0.5), half_m)
    )
    for name, (length_m, width_m, height_m, tag) in facts["props"].items():
        size = next((word for word, limit_m in SIZES if max(length_m, width_m, height_m) <= limit_m), "huge")
        half_m = Vector3D(0.5 * length_m, 0.5 * width_m, 0.5 * height_m)
        yield Blueprint(
            _definition(f"static.prop.{name}", (*names("prop"), constant("size", size))),
            BlueprintKind.PROP,
            BoundingBox(Vector3D(0.0, 0.0, half_m.z), half_m),
            bytes([SemanticTag[tag.upper()]]),
            facts["prop_masses_kg"].get(name, PROP_DENSITY_KG_M3 * length_m * width_m * height_m),
        )


def _vehicles(facts: dict[str, Any]) -> Iterator[Blueprint]:
    kinds = {name: vehicles.chassis(facts["chassis"], name) for name in facts["chassis"]}
    for name, own in facts["vehicles"].items():
        yield Blueprint(
            _definition(f"vehicle.{name}", vehicles.attributes(own, facts["colours"])),
            BlueprintKind.VEHICLE,
            vehicles.box(own),
            vehicles.TAGS_OF_BASE_TYPE[own["base_type"]],
            float(own["mass_kg"]),
            vehicles.model(own, kinds[own["chassis"]]),
        )


def _walkers(facts: dict[str, Any]) -> Iterator[Blueprint]:
    groups = [(number, group) for group in facts["walkers"] for number in _numbers(group["ids"])]
    for number, group in sorted(groups, key=lambda pair: pair[0]):
        half_width_m, half_height_m = group["half_m"]
        yield Blueprint(
            _definition(f"walker.pedestrian.{number:04}", _walker_attributes(group)),
            BlueprintKind.WALKER,
            BoundingBox(Vector3D(), Vector3D(half_width_m, half_width_m, half_height_m)),
            bytes([SemanticTag.PEDESTRIANS]),
            float(group["mass_kg"]),
        )


def _animals(facts: dict[str, Any]) -> Iterator[Blueprint]:
    """Yield Linden's animals, last so that the numbers of CARLA's blueprints stay. Their sources are in the facts."""
    for name, own in facts["animals"].items():
        length_m, width_m, height_m = own["size_m"]
        group = {"gender": "other", "generation": 0, "age": "adult", **own}
        yield Blueprint(
            _definition(
                f"{ANIMALS}{name}", (*_walker_attributes(group, "animal"), constant("height", float(height_m)))
            ),
            BlueprintKind.WALKER,
            BoundingBox(Vector3D(), Vector3D(0.5 * length_m, 0.5 * width_m, 0.5 * height_m)),
            bytes([SemanticTag.DYNAMIC]),
            float(own["mass_kg"]),
        )


def _walker_attributes(group: dict[str, Any], role: str = "pedestrian") -> tuple[ActorAttribute, ...]:
    with_wheelchair = group.get("wheelchair", False)
    choices = ("false", "true") if with_wheelchair else ("false",)
    return (
        *names(role),
        variation("speed", AttributeType.FLOAT, *map(str, group["speeds_mps"])),  # standing, walking, running
        variation("is_invincible", AttributeType.BOOL, "true"),
        variation("use_wheelchair", AttributeType.BOOL, *choices, restricted=True),
        constant("gender", group["gender"]),
        constant("generation", group["generation"]),
        constant("age", group["age"]),
        constant("can_use_wheelchair", with_wheelchair),
    )


def _numbers(ranges: list[str]) -> Iterator[int]:
    """Yield the numbers of ranges such as "0005-0008"."""
    for span in ranges:
        first, _, last = span.partition("-")
        yield from range(int(first), int(last or first) + 1)


def _others() -> Iterator[Blueprint]:
    yield Blueprint(_definition("controller.ai.walker", names()), BlueprintKind.CONTROLLER, DOT)
    yield Blueprint(_definition("util.actor.empty", names()), BlueprintKind.OTHER, DOT)
