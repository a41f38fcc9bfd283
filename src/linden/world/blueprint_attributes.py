"""Attributes of blueprints: how the facts in blueprints.json become CARLA's text values and types."""

from collections.abc import Mapping
from typing import TypeAlias

from linden.values.actors import ActorAttribute
from linden.values.enums import AttributeType

Value: TypeAlias = bool | int | float | str
"""A value as JSON has it: its Python type gives the attribute's."""

Fact: TypeAlias = Value | list[str]
"""A default as JSON has it; a list is a choice that allows nothing else."""

DEFAULT_ROLE = ("default",)


def text(value: Value) -> str:
    """Return a value as CARLA writes it: ``true`` and ``false`` in small letters, 90.0 as ``90.0``."""
    return str(value).lower() if isinstance(value, bool) else str(value)


def variation(name: str, kind: AttributeType, *choices: str, restricted: bool = False) -> ActorAttribute:
    """Return an attribute that whoever spawns may set; the first of the choices is its default."""
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
    """Return what every blueprint carries: ``role_name``, whose default is the first of the roles, and ``ros_name``."""
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
