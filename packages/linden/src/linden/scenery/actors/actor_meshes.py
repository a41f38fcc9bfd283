"""Meshes of all actors of a blueprint library, and the bone or wheel that each part follows."""

from collections.abc import Callable
from typing import NamedTuple

from linden.blueprints.library import ANIMALS, Blueprint, BlueprintLibrary, Kind
from linden.protocol.values.actors import ActorDescription
from linden.scenery.actors.animals import animal
from linden.scenery.actors.cars import car, shuttle
from linden.scenery.actors.heavy import ambulance, bus, firetruck, freight_truck
from linden.scenery.actors.people import in_wheelchair, walker
from linden.scenery.actors.solids import Shape
from linden.scenery.actors.two_wheelers import two_wheeler, wheelchair
from linden.scenery.mesh import Mesh
from linden.scenery.props.models import prop

_OF_ITS_OWN: dict[str, Callable[[Blueprint], list[Shape]]] = {
    "vehicle.carlamotors.carlacola": freight_truck,
    "vehicle.carlamotors.european_hgv": freight_truck,
    "vehicle.carlamotors.firetruck": firetruck,
    "vehicle.easymile.ez10": shuttle,
    "vehicle.ford.ambulance": ambulance,
    "vehicle.mitsubishi.fusorosa": bus,
}


def vehicle(blueprint: Blueprint) -> dict[str, list[Shape]]:
    """Return the parts of a vehicle: by ``driver_id`` where there is a rider to be seen, otherwise under ""."""
    assert blueprint.vehicle is not None
    if len(blueprint.vehicle.wheel_offsets_m) == 2:
        return two_wheeler(blueprint)
    return {"": _OF_ITS_OWN.get(blueprint.definition.id, car)(blueprint)}


SCALED = "static.prop.mesh"
"""The one blueprint with a size that the client chooses at the spawn."""


class Part(NamedTuple):
    """A mesh of an actor, the frame that it stands in, and its own colour where it has one."""

    mesh: int  # row of Bodies.meshes
    frame: int  # of posing.VEHICLE_FRAMES or WALKER_FRAMES; 0 is the actor's own
    colour: tuple[int, int, int] | None = None  # of painted faces; None where they have the actor's
    scale: float = 1.0  # how many times larger it is seen


class Bodies:
    """The meshes of all blueprints; what several share is there once.

    Attributes:
        meshes: one for each row that parts name.
        all_parts: those of each blueprint and value of what tells its actors apart, "" the plain ones.
    """

    def __init__(self, library: BlueprintLibrary) -> None:
        self.meshes: list[Mesh] = []
        self._row_of: dict[int, int] = {}  # by the mesh's own identity, so that nothing is compared
        self.all_parts: dict[tuple[str, str], tuple[Part, ...]] = {}
        for blueprint in library:
            for choice, shapes in _shapes(blueprint).items():
                self.all_parts[blueprint.definition.id, choice] = tuple(map(self._part, shapes))

    @classmethod
    def kept(cls, meshes: list[Mesh], all_parts: dict[tuple[str, str], tuple[Part, ...]]) -> "Bodies":
        """Return what was made before."""
        bodies = cls.__new__(cls)
        bodies.meshes, bodies.all_parts = meshes, all_parts
        return bodies

    def _part(self, shape: Shape) -> Part:
        row = self._row_of.setdefault(id(shape.mesh), len(self.meshes))
        if row == len(self.meshes):
            self.meshes.append(shape.mesh)
        return Part(row, shape.frame, shape.colour)

    def parts(self, description: ActorDescription) -> tuple[Part, ...]:
        """Return the parts of an actor that was spawned so; none for what cannot be seen (sensors, controllers)."""
        chosen = description.attribute("driver_id") or description.attribute("use_wheelchair")
        plain = self.all_parts.get((description.id, ""), ())
        parts = self.all_parts.get((description.id, chosen), plain)
        if description.id != SCALED:
            return parts
        scale = float(description.attribute("scale"))
        return tuple(part._replace(scale=scale) for part in parts)


def _shapes(blueprint: Blueprint) -> dict[str, list[Shape]]:
    """Return the parts of a blueprint's actors by the value of what tells them apart, "" the plain ones."""
    if blueprint.kind is Kind.VEHICLE:
        return vehicle(blueprint)
    if blueprint.definition.id.startswith(ANIMALS):
        return {"": animal(blueprint)}
    if blueprint.kind is Kind.WALKER:
        can_sit = any(
            "true" in a.recommended_values for a in blueprint.definition.attributes if a.id == "use_wheelchair"
        )
        seated = {"true": in_wheelchair(blueprint, wheelchair())} if can_sit else {}
        return {"": walker(blueprint), **seated}
    return {"": prop(blueprint)} if blueprint.kind is Kind.PROP else {}
