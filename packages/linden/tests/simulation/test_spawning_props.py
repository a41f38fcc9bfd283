"""Claims about props as bodies: which lie loose, and how heavy they are."""

import pytest

from linden.blueprints.library import BlueprintKind, BlueprintLibrary
from linden.errors import Refusal
from linden.protocol.values.actors import ActorDescription, AttributeValue
from linden.protocol.values.enums import AttributeType
from linden.simulation.spawning import MESH, MESH_DENSITY_KGPM3, Solid, solid

LIBRARY = BlueprintLibrary.load()


def made(name: str, **attributes: float) -> Solid:
    given = tuple(AttributeValue(key, AttributeType.FLOAT, str(value)) for key, value in attributes.items())
    return solid(LIBRARY.find(name), LIBRARY.validate(ActorDescription(0, name, given)))


@pytest.mark.parametrize("name", ["trafficcone01", "constructioncone", "barrel", "streetbarrier", "warningaccident"])
def test_what_stands_about_on_roads_lies_loose(name: str) -> None:
    found = made(f"static.prop.{name}")
    assert found.loose
    assert 1.0 < found.mass_kg < 60.0


@pytest.mark.parametrize("name", ["container", "busstop", "cypresstree", "vendingmachine", "dirtdebris01"])
def test_what_is_heavy_or_rooted_stands_fast(name: str) -> None:
    assert not made(f"static.prop.{name}").loose


def test_every_prop_has_a_mass() -> None:
    for blueprint in LIBRARY:
        if blueprint.kind is BlueprintKind.PROP and blueprint.definition.id != MESH:
            assert made(blueprint.definition.id).mass_kg > 0.0


def test_a_mesh_is_as_heavy_and_large_as_its_attributes_say() -> None:
    heavy = made(MESH, mass=250.0, scale=2.0)
    assert (heavy.mass_kg, heavy.loose) == (250.0, True)
    assert heavy.box.extent == (1.0, 1.0, 1.0)
    assert heavy.box.location.z == 1.0
    fast = made(MESH, scale=0.5)
    assert (fast.mass_kg, fast.loose) == (pytest.approx(MESH_DENSITY_KGPM3 * 0.125), False)


def test_a_mesh_of_no_size_is_refused() -> None:
    with pytest.raises(Refusal, match="needs a scale above 0"):
        made(MESH, scale=0.0)
