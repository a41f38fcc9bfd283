"""Meshes of cars, vans and the EasyMile EZ10 shuttle.

A car is a hull with mounted parts and four wheels. The EZ10 is a box on small wheels, alike in front and behind, with a
double glass door on either side.
"""

from linden.blueprints.library import Blueprint
from linden.scenery.mesh import Material, Mesh, join
from linden_maps.models.fittings import (
    cockpit,
    front,
    handles,
    mirrors,
    on_the_roof,
    pair,
    plaque,
    rear,
    underside,
    wheel,
)
from linden_maps.models.hull import PROUD_M, BodyFrame, Silhouette, half_width, hull, silhouettes, top
from linden_maps.models.solids import (
    BLACK,
    BLINKER_LEFT,
    BLINKER_RIGHT,
    BRAKE,
    HEAD,
    PLATE,
    REVERSE,
    STEEL,
    TAIL,
    TRIM,
    FaceLook,
    Shape,
    both_sides,
    box,
    lathe,
    moved,
    tagged,
)

_BAR_M = 0.13
"""Height of the bar of lights on a roof."""


def frame_of(blueprint: Blueprint, *, roof_m: float, mirrors_m: float) -> BodyFrame:
    """Return the frame of a body with a roof at ``roof_m`` and mirrors that reach ``mirrors_m`` beyond it."""
    assert blueprint.vehicle is not None
    hubs, (middle, half, *_) = blueprint.vehicle.wheel_offsets_m, blueprint.box
    axles = tuple(sorted({hub.x for hub in hubs}))
    rear, front = middle.x - half.x + PROUD_M, middle.x + half.x - PROUD_M
    return BodyFrame(rear, front, half.y - mirrors_m, roof_m, axles, hubs[0].z)


def car(blueprint: Blueprint) -> list[Shape]:
    """Return the parts of a car or van that has a silhouette."""
    shape, box = silhouettes()[blueprint.definition.id], blueprint.box
    special = next(attribute.value for attribute in blueprint.definition.attributes if attribute.id == "special_type")
    carries = special in ("emergency", "taxi")
    roof_m = box.location.z + box.extent.z - (_BAR_M if carries else 0.0)
    mirrors_m = min(max(box.extent.y - 0.93, 0.03), 0.16)
    frame = frame_of(blueprint, roof_m=roof_m, mirrors_m=mirrors_m)
    parts = [hull(shape, frame), underside(frame), *front(shape, frame), *rear(shape, frame)]
    parts += [*mirrors(shape, frame, box.extent.y), *handles(shape, frame), *cockpit(shape, frame)]
    if carries:
        parts += on_the_roof(shape, frame, _BAR_M, taxi=special == "taxi")
    return [Shape(tagged(join(parts), blueprint.semantic_tags[0]), 0), *wheels(blueprint, frame.half_width)]


def wheels(blueprint: Blueprint, half_width_m: float) -> list[Shape]:
    """Return the wheels of a vehicle, their outer sides just within its flanks."""
    assert blueprint.vehicle is not None
    made, tag = [], blueprint.semantic_tags[0]
    for number, hub in enumerate(blueprint.vehicle.wheel_offsets_m):
        side = 1.0 if hub.y > 0.0 else -1.0
        outer_m = side * (0.975 * half_width_m) - hub.y
        wide_m = 0.62 * hub.z
        mesh = wheel(round(hub.z, 4), round(outer_m - side * wide_m, 4), round(outer_m, 4), tag)
        made.append(Shape(mesh, 1 + number))
    return made


_AMBER = FaceLook(Material.PLAIN, (230, 150, 30))


def shuttle(blueprint: Blueprint) -> list[Shape]:
    """Return the parts of the shuttle."""
    shape = silhouettes()[blueprint.definition.id]
    frame = frame_of(blueprint, roof_m=blueprint.box.location.z + blueprint.box.extent.z, mirrors_m=0.012)
    parts = [hull(shape, frame), underside(frame), *_doors(shape, frame), *_ends(shape, frame), *_sensors(shape, frame)]
    return [
        Shape(tagged(join(parts), blueprint.semantic_tags[0]), 0),
        *wheels(blueprint, 0.96 * frame.half_width),
    ]


def _doors(shape: Silhouette, frame: BodyFrame) -> list[Mesh]:
    """Return the frames of the doors' leaves, the rail that they slide on, and a step below them."""
    made: list[Mesh] = []
    wide = frame.half_width
    low, high = 0.1 * frame.roof, 0.93 * frame.roof
    for start, end in shape.glass_doors:
        for edge in (start, end):
            x = float(frame.x(edge))
            made += both_sides(box((x - 0.025, wide - 0.06, low), (x + 0.025, wide + 0.008, 0.9 * frame.roof), BLACK))
    first, last = float(frame.x(shape.glass_doors[0][0])), float(frame.x(shape.glass_doors[-1][1]))
    made += both_sides(box((first - 0.55, wide - 0.12, high - 0.05), (last + 0.55, wide - 0.02, high - 0.01), TRIM))
    made += both_sides(box((first, wide - 0.2, low - 0.02), (last, wide + 0.012, low + 0.03), STEEL))
    for side_glass in (shape.side_glass[0], shape.side_glass[-1]):  # where the leaves slide to
        x0, x1 = (float(frame.x(share)) for share in side_glass)
        z = 0.36 * frame.roof
        made += both_sides(box((x0 + 0.1, wide - 0.05, z - 0.02), (x1 - 0.05, wide + 0.004, z + 0.01), TRIM))
    return made


def _ends(shape: Silhouette, frame: BodyFrame) -> list[Mesh]:
    """Return lamps, plate and destination of either end."""
    made: list[Mesh] = []
    wide = float(half_width(shape, frame, frame.front))
    z = 0.255 * frame.roof
    for x in (frame.front, frame.rear):
        ahead = x > 0.0
        made.append(plaque(x, (-0.24, 0.24), (z - 0.2, z - 0.09), PLATE))
        made += pair(x, (0.42 * wide, 0.94 * wide), (z - 0.01, z + 0.05), *((HEAD, HEAD) if ahead else (TAIL, TAIL)))
        made += pair(x, (0.8 * wide, 0.94 * wide), (z - 0.07, z - 0.02), BLINKER_LEFT, BLINKER_RIGHT)
        if not ahead:
            made += pair(x, (0.6 * wide, 0.76 * wide), (z - 0.07, z - 0.02), REVERSE, REVERSE)
        out = 1.0 if ahead else -1.0
        sign_x = x - out * 0.155
        high = float(top(shape, frame, sign_x))
        panel = box((sign_x - 0.06, -0.55, high - 0.12), (sign_x + 0.06, 0.55, high - 0.005), BLACK)
        text = box(
            (sign_x + out * 0.055 - 0.01, -0.42, high - 0.09), (sign_x + out * 0.055 + 0.01, 0.42, high - 0.035), _AMBER
        )
        made += [panel, text]
    over = frame.rear + 0.32
    high = float(top(shape, frame, over))
    made.append(box((over - 0.04, -0.25, high - 0.04), (over + 0.02, 0.25, high + 0.004), BRAKE))
    return made


def _sensors(shape: Silhouette, frame: BodyFrame) -> list[Mesh]:
    """Return the laser scanners at the corners and the antenna's dome on the roof."""
    puck = lathe([-0.05, 0.05], [0.055, 0.055], 10, BLACK)
    made = []
    for out, end in ((1.0, frame.front), (-1.0, frame.rear)):
        x = end - out * 0.12
        wide = float(half_width(shape, frame, x))
        made += [moved(puck, (x, side * (wide - 0.03), 0.17 * frame.roof)) for side in (-1.0, 1.0)]
    roof_m = float(top(shape, frame, -0.6))
    made.append(moved(lathe([-0.05, 0.0], [0.14, 0.1], 10, TRIM), (-0.6, 0.0, roof_m + 0.005)))
    return made
