"""Things that can be spawned, each filling its blueprint's box."""

import numpy as np

from linden.meshes.actors.shape import Shape
from linden.meshes.actors.solids import bounds, stretched, tagged
from linden.meshes.mesh import Mesh, join
from linden.meshes.props.models import model
from linden.values.enums import SemanticTag
from linden.values.space import BoundingBox
from linden.world.blueprints import Blueprint


def prop(blueprint: Blueprint) -> list[Shape]:
    """Return a prop's one part."""
    tag = blueprint.semantic_tags[0] if blueprint.semantic_tags else SemanticTag.STATIC
    name = blueprint.definition.id.removeprefix("static.prop.")
    return [Shape(tagged(_fitted(join(model(name, blueprint.box)), blueprint.box), tag), 0)]


def _fitted(mesh: Mesh, to: BoundingBox) -> Mesh:
    """Return the mesh stretched and moved so that it fills a box."""
    low, high = bounds(mesh)
    centre, half = np.array(to.location), np.array(to.extent)
    factors = 2.0 * half / np.maximum(high - low, 1e-6)
    return stretched(mesh, factors.tolist(), (centre - factors * 0.5 * (low + high)).tolist())
