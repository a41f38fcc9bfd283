"""Four-legged animals as one figure each, drawn into the box of their blueprint: a deer, a dog.

The box ends at the shoulder, as the sources of sizes measure it; so the neck is stretched out as in a run.
"""

from linden.blueprints.library import Blueprint
from linden.protocol.values.enums import SemanticTag
from linden.scenery.mesh import Material, Mesh, join
from linden_maps.models.solids import FaceLook, Shape, ball, both_sides, rod, tagged, tube

_COATS = {"deer": (134, 98, 66), "dog": (196, 160, 104)}
_COAT = (120, 96, 72)


def animal(blueprint: Blueprint) -> list[Shape]:
    """Return an animal as one part; the origin is the middle of its box, the nose ahead."""
    coat = _COATS.get(blueprint.definition.id.rsplit(".", maxsplit=1)[1], _COAT)
    half_m = blueprint.box.extent
    figure = _figure(half_m.x, half_m.y, half_m.z, FaceLook(Material.PLAIN, coat))
    return [Shape(tagged(figure, SemanticTag.DYNAMIC), 0)]


def _figure(x: float, y: float, z: float, look: FaceLook) -> Mesh:
    """Return trunk, neck, head, ears, tail and legs in a box of these half sizes."""
    head_m = (0.8 * x, 0.0, 0.7 * z)
    parts = [
        ball((-0.15 * x, 0.0, 0.5 * z), (0.72 * x, y, 0.5 * z), look),
        tube([(0.3 * x, 0.0, 0.5 * z), head_m], [0.45 * y, 0.32 * y], 6, look),
        ball(head_m, (0.2 * x, 0.4 * y, 0.2 * z), look),
        rod((-0.8 * x, 0.0, 0.7 * z), (-x, 0.0, 0.5 * z), 0.12 * y, look),
    ]
    for limb in (
        rod((0.72 * x, 0.3 * y, 0.8 * z), (0.64 * x, 0.45 * y, 0.95 * z), 0.1 * y, look),
        rod((0.35 * x, 0.5 * y, 0.4 * z), (0.35 * x, 0.5 * y, -z), 0.14 * y, look),
        rod((-0.65 * x, 0.5 * y, 0.4 * z), (-0.65 * x, 0.5 * y, -z), 0.14 * y, look),
    ):
        parts += both_sides(limb)
    return join(parts)
