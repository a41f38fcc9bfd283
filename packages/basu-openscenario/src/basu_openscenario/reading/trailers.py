"""All entities of a scenario with their selections, and the trailers of its vehicles."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.errors import ScenarioError
from basu_openscenario.reading.catalogs import resolved
from basu_openscenario.reading.entities import read_entity

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from basu_openscenario.reading.catalogs import Catalogs
    from basu_openscenario.reading.entities import Entity
    from basu_openscenario.reading.xml_node import Node

MOST_TRAILERS = 8
"""Trailers behind each other: road trains have up to six."""


def read_entities(root: Node, catalogs: Catalogs) -> tuple[dict[str, Entity], dict[str, tuple[str, ...]]]:
    """Return the entities by name, and the members of each selection of entities by its name.

    Raises:
        ScenarioError: two have one name, or one cannot be read.
    """
    found: dict[str, Entity] = {}
    block = root.child("Entities")
    for node in block.children("ScenarioObject"):
        for entity in read_combination(node, catalogs):
            if entity.name in found:
                raise node.fault(f"two entities are called '{entity.name}'; name one otherwise")
            found[entity.name] = entity
    check_trailers(found)
    selections: dict[str, tuple[str, ...]] = {}
    for node in block.children("EntitySelection"):
        members = node.child("Members")
        names = [one.text("entityRef") for one in members.children("EntityRef")]
        kinds = {one.text("type") for one in members.children("ByType")}
        names += [entity.name for entity in found.values() if entity.kind in kinds]
        for name in names:
            if name not in found:
                raise node.fault(f"the selection names the entity '{name}', which does not exist; correct the name")
        selections[node.text("name")] = tuple(names)
    return found, selections


def read_combination(node: Node, catalogs: Catalogs) -> Iterator[Entity]:
    """Yield the entity of a ``ScenarioObject``, and the trailers that are described inside of it.

    Such a trailer is called as its vehicle with a ``+`` behind, as in esmini: a catalog's entry may stand behind
    several vehicles.

    Raises:
        ScenarioError: one cannot be read, or there are too many.
    """
    name = node.text("name")
    for _ in range(MOST_TRAILERS + 1):
        entity = read_entity(node, name, catalogs)
        yield entity
        block = resolved(node.only("ObjectController", "MonitorDeclarations"), catalogs).find("Trailer")
        inside = None if block is None else block.find("Trailer")
        if inside is None:
            return
        node, name = inside, entity.trailer
    raise node.fault(f"more than {MOST_TRAILERS} trailers stand behind each other; remove some")


def check_trailers(entities: Mapping[str, Entity]) -> None:
    """Check the trailers of all vehicles.

    Raises:
        ScenarioError: a trailer does not exist, lacks its coupler, or is towed twice or in a circle.
    """
    tows: dict[str, str] = {}
    for entity in entities.values():
        if not entity.trailer:
            continue
        check_coupling(entity, entities.get(entity.trailer), entity.trailer, entity.line)
        if entity.trailer in tows:
            raise ScenarioError(
                f"{entity.line}: '{tows[entity.trailer]}' and '{entity.name}' tow the same trailer "
                f"'{entity.trailer}'; let one of them tow another one"
            )
        tows[entity.trailer] = entity.name
    for entity in entities.values():
        seen = [entity.name]
        while following := entities[seen[-1]].trailer:
            if following in seen:
                raise ScenarioError(f"{entity.line}: '{entity.name}' is among its own trailers; remove one of them")
            seen.append(following)
            if len(seen) > MOST_TRAILERS + 1:
                raise ScenarioError(
                    f"{entity.line}: '{entity.name}' has more than {MOST_TRAILERS} trailers; remove some"
                )


def check_coupling(tow: Entity, trailer: Entity | None, name: str, line: str) -> None:
    """Refuse a vehicle without a hitch, and a trailer without a coupler.

    Raises:
        ScenarioError: one of them lacks its part, or there is no such trailer.
    """
    if trailer is None:
        raise ScenarioError(f"{line}: the trailer '{name}' does not exist; add an entity of this name")
    if tow.kind != "vehicle" or tow.hitch_m is None:
        raise ScenarioError(f"{line}: '{tow.name}' has no hitch for a trailer; add <TrailerHitch dx=\"...\"/> to it")
    if trailer.kind != "vehicle" or trailer.coupler_m is None or trailer.coupler_m <= 0.0:
        raise ScenarioError(
            f"{line}: '{trailer.name}' has no coupler ahead of its axle; add <TrailerCoupler dx=\"...\"/> with a "
            "number above 0 to it"
        )
