"""The meshes of actors: which parts an actor of a blueprint has, and what each part follows."""

from typing import NamedTuple

from linden.meshes.actors.person import person
from linden.meshes.actors.shape import Shape
from linden.meshes.actors.solids import Look, box, tagged
from linden.meshes.actors.vehicles import vehicle
from linden.meshes.mesh import Material, Mesh
from linden.values.actors import ActorDescription
from linden.values.enums import SemanticTag
from linden.world.blueprints import Blueprint, BlueprintLibrary, Kind

SCALED = "static.prop.mesh"


class Part(NamedTuple):
    """A mesh of an actor, and the frame that it stands in."""

    mesh: int  # row of Bodies.meshes
    frame: int  # of posing.VEHICLE_FRAMES or WALKER_FRAMES; 0 is the actor's own
    scale: float = 1.0  # how many times larger it is seen


class Bodies:
    """The meshes of all blueprints; what several share is there once.

    Attributes:
        meshes: one for each row that parts name.
    """

    def __init__(self, library: BlueprintLibrary) -> None:
        self.meshes: list[Mesh] = []
        self._parts: dict[str, tuple[Part, ...]] = {}
        for blueprint in library:
            if blueprint.kind in (Kind.VEHICLE, Kind.WALKER, Kind.PROP):
                self._parts[blueprint.definition.id] = tuple(map(self._add, _shapes(blueprint)))

    def _add(self, shape: Shape) -> Part:
        for row, mesh in enumerate(self.meshes):
            if mesh is shape.mesh:
                return Part(row, shape.frame)
        self.meshes.append(shape.mesh)
        return Part(len(self.meshes) - 1, shape.frame)

    def parts(self, description: ActorDescription) -> tuple[Part, ...]:
        """Return the parts of an actor that was spawned so; none for what cannot be seen (sensors, controllers)."""
        parts = self._parts.get(description.id, ())
        if description.id != SCALED:
            return parts
        scale = float(description.attribute("scale"))
        return tuple(part._replace(scale=scale) for part in parts)


def _shapes(blueprint: Blueprint) -> list[Shape]:
    if blueprint.kind is Kind.VEHICLE:
        return vehicle(blueprint)
    if blueprint.kind is Kind.WALKER:
        return person(blueprint)
    middle, half = blueprint.box.location, blueprint.box.extent
    low = (middle.x - half.x, middle.y - half.y, middle.z - half.z)
    high = (middle.x + half.x, middle.y + half.y, middle.z + half.z)
    tag = blueprint.semantic_tags[0] if blueprint.semantic_tags else SemanticTag.STATIC
    return [Shape(tagged(box(low, high, Look(Material.PLAIN, (150, 150, 150))), tag), 0)]
