"""Attributes of blueprints: CARLA's text values and types, and the check of attributes from clients.

The facts in ``blueprints.json`` become text values here. A client's description of an actor is checked against its
blueprint and completed with the defaults.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple, NoReturn, TypeAlias

from linden.errors import Refusal
from linden.protocol.values.actors import ActorAttribute, ActorDefinition, ActorDescription, AttributeValue
from linden.protocol.values.enums import AttributeType

Value: TypeAlias = bool | int | float | str
"""A value as JSON has it: its Python type gives the attribute's."""

Fact: TypeAlias = Value | list[str]
"""A default as JSON has it; a list is a choice that allows nothing else."""

DEFAULT_ROLE = ("default",)


def text(value: Value) -> str:
    """Return a value as CARLA writes it: ``true`` and ``false`` in small letters, 90.0 as ``90.0``."""
    return str(value).lower() if isinstance(value, bool) else str(value)


def variation(name: str, kind: AttributeType, *choices: str, restricted: bool = False) -> ActorAttribute:
    """Return an attribute that a client may set at the spawn; the first of the choices is its default."""
    return ActorAttribute(name, kind, choices[0], choices, is_modifiable=True, restrict_to_recommended=restricted)


def constant(name: str, value: Value) -> ActorAttribute:
    """Return an attribute that can only be read."""
    return ActorAttribute(name, _type_of(value), text(value), (), is_modifiable=False, restrict_to_recommended=False)


def from_facts(facts: Mapping[str, Fact]) -> tuple[ActorAttribute, ...]:
    """Return the variations that a group of defaults describes, in its order."""
    return tuple(
        variation(name, AttributeType.STRING, *fact, restricted=True)
        if isinstance(fact, list)
        else variation(name, _type_of(fact), text(fact))
        for name, fact in facts.items()
    )


def names(*roles: str) -> tuple[ActorAttribute, ...]:
    """Return the attributes of every blueprint: ``role_name`` (default: the first of the roles) and ``ros_name``."""
    return (
        variation("role_name", AttributeType.STRING, *(roles or DEFAULT_ROLE)),
        variation("ros_name", AttributeType.STRING, ""),
    )


def _type_of(value: Value) -> AttributeType:
    if isinstance(value, bool):
        return AttributeType.BOOL
    if isinstance(value, int):
        return AttributeType.INT
    return AttributeType.FLOAT if isinstance(value, float) else AttributeType.STRING


REFUSED = "Spawn failed because of invalid actor description"
"""CARLA's own words (ActorSpawnResult.cpp); scripts match on them."""

_QUOTED = 80  # characters of a value that a sentence quotes


class AttributeBounds(NamedTuple):
    """Least and greatest value that an attribute can take, both included."""

    least: float
    most: float


LARGEST = 1e9
"""Of a number without bounds of its own: far beyond what anything measures, and its square still fits 32 bits."""
ANY_INTEGER = AttributeBounds(-(2**31), 2**31 - 1)
ANY_NUMBER = AttributeBounds(-LARGEST, LARGEST)
ANY_DEVIATION = AttributeBounds(0.0, LARGEST)

BOUNDS = {
    "sensor_tick": AttributeBounds(0.0, 1e6),
    "image_size_x": AttributeBounds(1, 2**31 - 1),  # sensors.camera.spec says what a picture can be
    "image_size_y": AttributeBounds(1, 2**31 - 1),
    "channels": AttributeBounds(1, 4096),  # lidars that are sold have up to 300
    "points_per_second": AttributeBounds(1, 20_000_000),  # lidars that are sold fire up to 5 million
    "rotation_frequency": AttributeBounds(-10_000.0, 10_000.0),
    "horizontal_fov": AttributeBounds(-360.0, 360.0),
    "vertical_fov": AttributeBounds(-360.0, 360.0),
    "upper_fov": AttributeBounds(-360.0, 360.0),
    "lower_fov": AttributeBounds(-360.0, 360.0),
    "range": AttributeBounds(0.0, 1e6),
    "distance": AttributeBounds(0.0, 1e6),
    "hit_radius": AttributeBounds(0.0, 1e3),
    "positive_threshold": AttributeBounds(0.01, 1e6),  # an event for every step of brightness: a smaller one never ends
    "negative_threshold": AttributeBounds(0.01, 1e6),
    "transmit_power": AttributeBounds(-200.0, 200.0),  # dBm, as the sensitivity; a radio for cars has 23 to 33
    "receiver_sensitivity": AttributeBounds(-1e3, 200.0),
    "frequency_ghz": AttributeBounds(0.001, 1e3),
    "combined_antenna_gain": AttributeBounds(-200.0, 200.0),
    "path_loss_exponent": AttributeBounds(0.0, 100.0),
    "d_ref": AttributeBounds(0.001, 1e6),
    "filter_distance": AttributeBounds(0.0, 1e6),
    "gen_cam_min": AttributeBounds(0.001, 1e6),
    "gen_cam_max": AttributeBounds(0.001, 1e6),
    "scale": AttributeBounds(0.0, 1e3),
    "mass": AttributeBounds(0.0, 1e7),
    "extent_x": AttributeBounds(0.0, 1e6),
    "extent_y": AttributeBounds(0.0, 1e6),
    "extent_z": AttributeBounds(0.0, 1e6),
    "friction": AttributeBounds(0.0, 1e3),
}
"""What an attribute can take, where that is less than its type allows: what means nothing, or would take a server all
its time and memory."""


def bounds_of(attribute: ActorAttribute) -> AttributeBounds:
    """Return what a number can be."""
    if attribute.id in BOUNDS:
        return BOUNDS[attribute.id]
    if attribute.type == AttributeType.INT:
        return ANY_INTEGER
    return ANY_DEVIATION if attribute.id.endswith("_stddev") or "_stddev_" in attribute.id else ANY_NUMBER


def complete(definition: ActorDefinition, description: ActorDescription) -> ActorDescription:
    """Return the description with every attribute of its blueprint, in the blueprint's order.

    What it leaves out takes the default. The number of the blueprint is taken from the id.

    Raises:
        Refusal: an attribute unknown, a text that is no value of the attribute's type, a value out of its range, not
            among the allowed ones, or other than that of an attribute which can only be read.
    """
    given = {attribute.id: attribute.value for attribute in description.attributes}
    known = {attribute.id for attribute in definition.attributes}
    for name in given:
        if name not in known:
            _refuse(definition.id, f"it has no attribute '{name}', only {', '.join(sorted(known))}")
    chosen = []
    for attribute in definition.attributes:
        value = given.get(attribute.id, attribute.value)
        if value != attribute.value:
            _check(definition.id, attribute, value)
        if attribute.type == AttributeType.BOOL:
            value = value.strip().lower()  # Python's str(True) reaches the server as "True"
        elif attribute.type == AttributeType.INT:
            value = value.partition(".")[0]  # as CARLA's Atoi: lidar_to_camera.py asks for "64.0" channels
        chosen.append(AttributeValue(attribute.id, attribute.type, value))
    return ActorDescription(definition.uid, definition.id, tuple(chosen))


def refuse_unknown(unknown: str, definitions: tuple[ActorDefinition, ...]) -> NoReturn:
    """Refuse an id that no blueprint has, and say what there is.

    Raises:
        Refusal: always.
    """
    family = unknown.split(".", maxsplit=1)[0]
    count = sum(1 for definition in definitions if definition.id.startswith(f"{family}."))
    families = sorted({definition.id.split(".", maxsplit=1)[0] for definition in definitions})
    there_is = f"{count} begin with '{family}.'" if count else f"ids begin with one of {', '.join(families)}"
    raise Refusal(f"{REFUSED}: there is no blueprint '{unknown}'; {there_is}, see World.get_blueprint_library()")


def _refuse(blueprint_id: str, reason: str) -> NoReturn:
    raise Refusal(f"{REFUSED}: '{blueprint_id}': {reason}")


def _check(blueprint_id: str, attribute: ActorAttribute, value: str) -> None:
    quoted = f"'{value[:_QUOTED]}' as {attribute.id}"
    if not attribute.is_modifiable:
        _refuse(blueprint_id, f"{quoted}: it is '{attribute.value}' and can only be read")
    # CARLA's generate_traffic.py asks walkers that have no wheelchair to use it, and CARLA lets them go on foot
    is_bound = attribute.restrict_to_recommended and attribute.type != AttributeType.BOOL
    if is_bound and value not in attribute.recommended_values:
        _refuse(blueprint_id, f"{quoted}: allowed are {', '.join(attribute.recommended_values)}")
    wanted = _wanted(AttributeType(attribute.type), value)
    if wanted is not None:
        _refuse(blueprint_id, f"{quoted}: expected {wanted}, such as '{attribute.value}'")
    if attribute.type in (AttributeType.INT, AttributeType.FLOAT):
        bounds = bounds_of(attribute)
        if float(value) < bounds.least:
            _refuse(blueprint_id, f"{quoted}: expected at least {bounds.least:g}")
        if float(value) > bounds.most:
            _refuse(blueprint_id, f"{quoted}: expected at most {bounds.most:.10g}")


def _wanted(kind: AttributeType, value: str) -> str | None:
    """Return in words what the type asks for, None where the value is that."""
    if kind is AttributeType.BOOL:
        return None if value.strip().lower() in {"true", "false"} else "true or false"
    if kind is AttributeType.INT:
        whole, _, fraction = value.strip().partition(".")  # CARLA's Atoi reads a number up to its point
        return None if _is_integer(whole) and (not fraction or _is_integer(f"0{fraction[:9]}")) else "a whole number"
    if kind is AttributeType.FLOAT:
        return None if _is_finite(value) else "a finite number"
    if kind is AttributeType.RGB_COLOR:
        parts = value.split(",")
        fits = len(parts) == 3 and all(_is_integer(part) and 0 <= int(part) <= 255 for part in parts)
        return None if fits else "red,green,blue of 0 to 255 each"
    return None


def _is_integer(value: str) -> bool:
    stripped = value.strip()
    digits = stripped[1:] if stripped[:1] in {"-", "+"} else stripped
    return digits.isascii() and digits.isdigit() and len(digits) <= 10


def _is_finite(value: str) -> bool:
    try:
        return "_" not in value and math.isfinite(float(value))
    except ValueError:
        return False
