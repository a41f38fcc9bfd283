"""Cars and vans: a hull, what is mounted on it, and four wheels."""

from linden.meshes.actors.fittings import cockpit, front, handles, mirrors, on_the_roof, rear, underside
from linden.meshes.actors.hull import PROUD_M, Frame, hull
from linden.meshes.actors.shape import Shape
from linden.meshes.actors.silhouettes import silhouettes
from linden.meshes.actors.solids import tagged
from linden.meshes.actors.wheels import wheel
from linden.meshes.mesh import join
from linden.world.blueprints import Blueprint

_BAR_M = 0.13
"""Height of the bar of lights on a roof."""


def frame_of(blueprint: Blueprint, *, roof_m: float, mirrors_m: float) -> Frame:
    """Return where a body lies whose mirrors reach ``mirrors_m`` beyond it and whose roof is at ``roof_m``."""
    assert blueprint.vehicle is not None
    hubs, (middle, half, *_) = blueprint.vehicle.wheel_offsets_m, blueprint.box
    axles = tuple(sorted({hub.x for hub in hubs}))
    rear, front = middle.x - half.x + PROUD_M, middle.x + half.x - PROUD_M
    return Frame(rear, front, half.y - mirrors_m, roof_m, axles, hubs[0].z)


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
