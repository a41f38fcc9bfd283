"""Vehicles."""

import numpy as np

from linden.meshes.actors.shape import Shape
from linden.meshes.actors.solids import Look, box, lathe, stretched, tagged, turned, wedge
from linden.meshes.mesh import Material, join
from linden.world.blueprints import Blueprint

PAINT = Look(Material.CAR_PAINT, (180, 180, 180), painted=True)
GLASS = Look(Material.GLASS, (35, 40, 45))
RUBBER = Look(Material.RUBBER, (25, 25, 25))


def vehicle(blueprint: Blueprint) -> list[Shape]:
    """Return the parts of a vehicle."""
    (x, _, z), (a, b, c) = blueprint.box.location, blueprint.box.extent
    top, waist = z + c, 0.35 + 0.5 * (z + c - 0.35)
    body = [
        box((x - a, -b, 0.25), (x + a, b, waist), PAINT),
        wedge(
            (x - 0.7 * a, -0.9 * b, waist), (x + 0.5 * a, 0.9 * b, top - 0.03), GLASS, top_x=(x - 0.5 * a, x + 0.1 * a)
        ),
        box((x - 0.5 * a, -0.9 * b, top - 0.03), (x + 0.1 * a, 0.9 * b, top), PAINT),
    ]
    tag = blueprint.semantic_tags[0]
    shapes = [Shape(tagged(join(body), tag), 0)]
    assert blueprint.vehicle is not None
    axle = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
    for number, hub in enumerate(blueprint.vehicle.wheel_offsets_m):
        wheel = stretched(turned(lathe([-1.0, 1.0], [1.0, 1.0], 16, RUBBER), axle), (hub.z, 0.1, hub.z))
        shapes.append(Shape(tagged(wheel, tag), 1 + number))
    return shapes
