"""Props as bodies: how large and heavy one is that somebody spawns, and whether it lies loose.

What CARLA tags as dynamic lies loose (cones, bins, boxes, barriers), and so do warning signs on stands: a car that hits
one pushes it away. The rest stands fast until ``set_simulate_physics(True)`` lets it go, as scripts for CARLA do with
containers; from then on its mass decides. ``static.prop.mesh`` is loose if its ``mass`` is above 0, as in CARLA; its
mesh is Unreal's and nobody has it here, so it is a cube of 1 m times its ``scale``.
"""

from typing import NamedTuple

from linden.errors import Refusal
from linden.values.actors import ActorDescription
from linden.values.enums import SemanticTag
from linden.values.space import BoundingBox, Vector3D
from linden.world.blueprints import Blueprint

MESH = "static.prop.mesh"
LOOSE_SIGNS = ("static.prop.warningaccident", "static.prop.warningconstruction")
MESH_DENSITY_KGPM3 = 60.0
"""Of a mesh whose mass nobody says, once it is let go; as ``world.blueprints`` estimates other props."""


class Solid(NamedTuple):
    """A prop's box in its own frame, its mass, and whether it moves when it is hit."""

    box: BoundingBox
    mass_kg: float
    loose: bool


def solid(blueprint: Blueprint, description: ActorDescription) -> Solid:
    """Return what is put into the world for a checked description of a prop.

    Raises:
        Refusal: the scale of a mesh is 0.
    """
    if description.id != MESH:
        loose = bytes([SemanticTag.DYNAMIC]) == blueprint.semantic_tags or description.id in LOOSE_SIGNS
        return Solid(blueprint.box, blueprint.mass_kg, loose)
    mass_kg, scale = float(description.attribute("mass")), float(description.attribute("scale"))
    if scale == 0.0:
        raise Refusal(f"Spawn failed because of invalid actor description: {MESH} needs a scale above 0")
    centre, half = (Vector3D(*(scale * value for value in vector)) for vector in blueprint.box[:2])
    weight_kg = mass_kg or MESH_DENSITY_KGPM3 * scale**3
    return Solid(BoundingBox(centre, half), weight_kg, mass_kg > 0.0)
