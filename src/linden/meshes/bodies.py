"""The meshes of actors: which parts an actor of a blueprint has, and what each part follows."""

from typing import NamedTuple

from linden.meshes.actors.people import in_wheelchair, walker
from linden.meshes.actors.shape import Shape
from linden.meshes.actors.two_wheelers import wheelchair
from linden.meshes.actors.vehicles import vehicle
from linden.meshes.mesh import Mesh
from linden.meshes.props.fitted import prop
from linden.values.actors import ActorDescription
from linden.world.blueprints import Blueprint, BlueprintLibrary, Kind

SCALED = "static.prop.mesh"
"""The one blueprint whose actors are as large as whoever spawns them says."""


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
    if blueprint.kind is Kind.WALKER:
        can_sit = any(
            "true" in a.recommended_values for a in blueprint.definition.attributes if a.id == "use_wheelchair"
        )
        seated = {"true": in_wheelchair(blueprint, wheelchair())} if can_sit else {}
        return {"": walker(blueprint), **seated}
    return {"": prop(blueprint)} if blueprint.kind is Kind.PROP else {}
