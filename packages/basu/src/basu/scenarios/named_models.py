"""The models that a file's ``<other_actor>`` elements name for the actors of a scenario of BASU.

A class of BASU places its actors relative to the ego's route. So of an ``<other_actor>`` it takes the model and the
colour. An element belongs to the actor of its ``rolename``; one without a ``rolename`` belongs to the next actor of the
class that no element names. Its place and speed are not read.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.errors import ScenarioError
from basu.scenarios.xml_elements import NO_ROLE, OTHER_MODEL

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.scenarios.stage import ActorSpec
    from basu.scenarios.xml_elements import GivenActor


def with_named_models(specs: Sequence[ActorSpec], named: Sequence[GivenActor], scenario: str) -> list[ActorSpec]:
    """Return the actors of a class with the models and colours that the elements of a file name.

    Raises:
        ScenarioError: an element belongs to no actor of the class, or names a model of another kind.
    """
    found = {spec.name: spec for spec in specs}
    roles = {given.role for given in named}
    unnamed = [name for name in found if name not in roles]
    for given in named:
        if given.role == NO_ROLE and not unnamed:
            raise ScenarioError(
                f"{given.source}: <other_actor> belongs to no actor, since {scenario} has {_count(found)}; remove it"
            )
        name = unnamed.pop(0) if given.role == NO_ROLE else given.role
        if name not in found:
            raise ScenarioError(
                f"{given.source}: <other_actor> has rolename='{name}', and {scenario} has {_count(found)}; "
                "name one of them, or leave the rolename out"
            )
        found[name] = _named(found[name], given, scenario)
    return list(found.values())


def _named(spec: ActorSpec, given: GivenActor, scenario: str) -> ActorSpec:
    """Return an actor with the model and colour of its element."""
    if given.model == OTHER_MODEL:  # it names none
        return spec._replace(attributes=_coloured(spec, given))
    kind, wanted = given.model.split(".", 1)[0], spec.blueprint.split(".", 1)[0]
    if kind != wanted:
        raise ScenarioError(
            f"{given.source}: <other_actor> has model='{given.model}', and '{spec.name}' of {scenario} is a {wanted}; "
            f"name a model that begins with '{wanted}.'"
        )
    return spec._replace(blueprint=given.model, attributes=_coloured(spec, given), stand_in="")


def _coloured(spec: ActorSpec, given: GivenActor) -> tuple[tuple[str, str], ...]:
    """Return an actor's attributes with those of its element, which replace attributes of the same name."""
    return tuple({**dict(spec.attributes), **dict(given.attributes)}.items())


def _count(found: dict[str, ActorSpec]) -> str:
    """Return the actors of a class, for a sentence."""
    return f"only the actors {', '.join(found)}" if found else "no actors"
