"""Meshes of bicycles, motorcycles and scooters with their riders, and of the wheelchair."""

from collections.abc import Sequence
from typing import NamedTuple

from linden.blueprints.library import Blueprint
from linden.protocol.values.enums import SemanticTag
from linden.protocol.values.space import Vector3D
from linden.scenery.actors.posing import FORK
from linden.scenery.mesh import Mesh, join
from linden_maps.models.fittings import hoop, spoked_wheel
from linden_maps.models.people import figure, outfit
from linden_maps.models.solids import (
    BLACK,
    BLINKER_LEFT,
    BLINKER_RIGHT,
    CHROME,
    HEAD,
    PAINT,
    PLATE,
    RUBBER,
    STEEL,
    TAIL,
    FaceLook,
    Point,
    Shape,
    ball,
    both_sides,
    box,
    moved,
    rod,
    tagged,
    tube,
    wedge,
)

_RIDER_M = 1.66
"""The stature of a rider."""

_CRANK_M = 0.17
_RIDERS = {"1": (4, False), "2": (11, True), "3": (25, False)}
"""Number and sex of the outfit of each ``driver_id``."""


def two_wheeler(blueprint: Blueprint) -> dict[str, list[Shape]]:
    """Return the parts of a vehicle on two wheels with each of its riders, by ``driver_id``."""
    base = next(attribute.value for attribute in blueprint.definition.attributes if attribute.id == "base_type")
    if base == "bicycle":
        return _bicycle(blueprint)
    return _scooter(blueprint) if blueprint.definition.id == "vehicle.vespa.zx125" else _motorcycle(blueprint)


def _hubs(blueprint: Blueprint) -> tuple[Vector3D, Vector3D]:
    assert blueprint.vehicle is not None
    front, rear = blueprint.vehicle.wheel_offsets_m
    return front, rear


def _line(points: Sequence[Point], radius_m: float, look: FaceLook) -> Mesh:
    return tube(points, [radius_m] * len(points), 6, look)


def _bars(blueprint: Blueprint, hub: Vector3D, head: tuple[float, float], look: FaceLook, fork_m: float) -> list[Mesh]:
    """Return fork, stem and handlebar in the fork's frame (origin: the hub); ``head`` is the place of the grips."""
    half_y, (x, z) = blueprint.box.extent.y, (head[0] - hub.x, head[1] - hub.z)
    top = (0.82 * x, 0.0, 0.82 * z)
    legs = both_sides(_line([(0.0, fork_m, 0.0), (0.45 * x, fork_m, 0.45 * z), top], 0.016, look))
    stem = _line([top, (x + 0.03, 0.0, z)], 0.02, look)
    bar = _line([(x + 0.03, 0.0, z), (x + 0.02, 0.4 * half_y, z + 0.01), (x - 0.03, half_y, z)], 0.013, STEEL)
    grip = rod((x + 0.005, 0.6 * half_y, z + 0.005), (x - 0.028, half_y - 0.002, z), 0.019, BLACK)
    return [*legs, stem, *both_sides(bar), *both_sides(grip)]


class _Riders(NamedTuple):
    """The riders of a two-wheeler, by ``driver_id``, and the height of the saddle."""

    meshes: dict[str, Mesh]
    saddle_m: float


def _riders(
    blueprint: Blueprint,
    *,
    hips_x_m: float,
    lean_deg: float,
    hand_m: tuple[float, float],
    feet_m: tuple[tuple[float, float], tuple[float, float]],
) -> _Riders:
    """Return riders with helmets as high as the box; the rest is as in ``people.figure``."""
    top_m, hips_z = blueprint.box.location.z + blueprint.box.extent.z, 0.0
    meshes: dict[str, Mesh] = {}
    for driver_id, (number, female) in _RIDERS.items():
        clothes = outfit(number, _RIDER_M, female=female, helmet=(228, 228, 224))
        if not meshes:  # all are of one size
            trial = figure(
                clothes, hips_m=(0.0, 0.0), lean_deg=lean_deg, hand_m=(0.0, 0.0), feet_m=((0.0, -0.5), (0.0, -0.5))
            )
            hips_z = top_m - float(trial.vertices_m[:, 2].max())
        made = figure(
            clothes,
            hips_m=(hips_x_m, hips_z),
            lean_deg=lean_deg,
            hand_m=hand_m,
            feet_m=feet_m,
            hands_apart_m=1.55 * blueprint.box.extent.y,
        )
        meshes[driver_id] = tagged(made, SemanticTag.RIDER)
    return _Riders(meshes, hips_z - 0.05 * _RIDER_M)


def _assembled(
    blueprint: Blueprint, body: list[Mesh], fork: list[Mesh], riders: _Riders, tyres_m: tuple[float, float], spokes: int
) -> dict[str, list[Shape]]:
    """Return the parts with each rider; ``tyres_m`` are the widths of the front and the rear one."""
    tag, radius_m = blueprint.semantic_tags[0], _hubs(blueprint)[0].z
    shapes = [Shape(tagged(join(body), tag), 0), Shape(tagged(join(fork), tag), FORK)]
    shapes += [Shape(spoked_wheel(radius_m, tyre_m, spokes, tag), 1 + n) for n, tyre_m in enumerate(tyres_m)]
    return {driver_id: [*shapes, Shape(mesh, 0)] for driver_id, mesh in riders.meshes.items()}


def _bicycle(blueprint: Blueprint) -> dict[str, list[Shape]]:
    front, rear = _hubs(blueprint)
    upright = blueprint.definition.id == "vehicle.gazelle.omafiets"
    pedals = (0.5 * (front.x + rear.x) - 0.06, front.z - 0.06)
    hips_x = pedals[0] - 0.2
    grips = (front.x - (0.32 if upright else 0.12), 0.98)
    riders = _riders(
        blueprint,
        hips_x_m=hips_x,
        lean_deg=12.0 if upright else 38.0,
        hand_m=(grips[0] - 0.03, grips[1] + 0.03),
        feet_m=((pedals[0] - 0.04, pedals[1] - _CRANK_M + 0.09), (pedals[0] + 0.06, pedals[1] + _CRANK_M + 0.07)),
    )
    seat = (hips_x + 0.02, 0.0, riders.saddle_m - 0.05)
    bottom, axle = (pedals[0], 0.0, pedals[1]), (rear.x, 0.0, rear.z)
    head_top, head_low = (grips[0] + 0.08, 0.0, grips[1] - 0.14), (grips[0] + 0.12, 0.0, grips[1] - 0.27)
    joint = (seat[0] + 0.06, 0.0, seat[2] - 0.16)
    body = [_line([bottom, seat], 0.018, PAINT), _line([bottom, head_low], 0.022, PAINT)]
    body += [_line([head_low if upright else joint, joint if upright else head_top], 0.018, PAINT)]
    body += [_line([head_low, head_top], 0.022, PAINT)]
    for end, start in ((bottom, axle), (joint, axle)):
        body += both_sides(_line([(end[0], 0.03, end[2]), (start[0], 0.055, start[2])], 0.011, PAINT))
    body.append(
        wedge(
            (seat[0] - 0.13, -0.06, seat[2]),
            (seat[0] + 0.13, 0.06, seat[2] + 0.06),
            BLACK,
            top_x=(seat[0] - 0.12, seat[0] + 0.1),
        )
    )
    body += [moved(hoop(0.095, 0.008, STEEL), (bottom[0], 0.06, bottom[2]))]
    for y, up in ((-0.1, -1.0), (0.1, 1.0)):
        end = (pedals[0] + 0.05 * up, y, pedals[1] + up * _CRANK_M)
        body.append(rod((pedals[0], 0.7 * y, pedals[1]), end, 0.012, STEEL))
        body.append(
            box((end[0] - 0.05, end[1] - 0.05, end[2] - 0.012), (end[0] + 0.05, end[1] + 0.05, end[2] + 0.012), BLACK)
        )
    body.append(box((rear.x - 0.02, -0.03, seat[2] - 0.22), (rear.x + 0.02, 0.03, seat[2] - 0.17), TAIL))
    if upright:
        body.append(box((rear.x - 0.2, -0.07, 2.1 * rear.z), (seat[0] - 0.08, 0.07, 2.1 * rear.z + 0.03), STEEL))
    fork = _bars(blueprint, front, grips, PAINT, 0.05)
    fork.append(
        box((0.55 * (grips[0] - front.x), -0.035, 0.42), (0.55 * (grips[0] - front.x) + 0.05, 0.035, 0.49), HEAD)
    )
    return _assembled(blueprint, body, fork, riders, (0.045, 0.045), 12)


def _motorcycle(blueprint: Blueprint) -> dict[str, list[Shape]]:
    front, rear = _hubs(blueprint)
    half, r = blueprint.box.extent, front.z
    tail, ahead = blueprint.box.location.x - half.x, blueprint.box.location.x + half.x - front.x
    low_rider = "harley" in blueprint.definition.id
    hips_x, pegs = (-0.32, (0.3, 0.38)) if low_rider else (-0.25, (-0.22, 0.42))
    grips = (front.x - (0.62 if low_rider else 0.42), 1.02 if low_rider else 0.9)
    riders = _riders(
        blueprint,
        hips_x_m=hips_x,
        lean_deg=4.0 if low_rider else 38.0,
        hand_m=(grips[0] - 0.03, grips[1] + 0.03),
        feet_m=(pegs, pegs),
    )
    seat = riders.saddle_m
    body = [
        ball((0.1, 0.0, seat + 0.02), (0.3, 0.17, 0.15), PAINT, sides=10),
        wedge((hips_x - 0.42, -0.13, seat - 0.12), (0.0, 0.13, seat + 0.01), BLACK, top_x=(hips_x - 0.45, -0.05)),
        box((-0.22, -0.16, 0.24), (0.26, 0.16, seat - 0.2), STEEL),
        *both_sides(rod((-0.05, 0.1, 0.3), (rear.x, 0.09, r), 0.03, BLACK)),
        *both_sides(
            tube([(0.1, 0.18, 0.3), (-0.2, 0.2, 0.26), (rear.x - 0.2, 0.2, 0.36)], [0.035, 0.04, 0.055], 8, CHROME)
        ),
        wedge((tail + 0.01, -0.1, 2.1 * r), (hips_x - 0.1, 0.1, seat - 0.05), PAINT, top_x=(tail + 0.02, hips_x - 0.1)),
        box((tail, -0.07, 2.2 * r), (tail + 0.05, 0.07, 2.2 * r + 0.07), TAIL),
        box((tail, -0.1, 1.75 * r), (tail + 0.015, 0.1, 2.1 * r), PLATE),
        *_blinkers(tail + 0.06, 0.16, 2.15 * r),
    ]
    fork = _bars(blueprint, front, grips, CHROME, 0.09)
    at = 0.6 * (grips[0] - front.x)
    lamp_z = 0.62 * (grips[1] - r) + 0.02
    fork.append(moved(ball((0.0, 0.0, 0.0), (0.06, 0.09, 0.09), HEAD), (at + 0.09, 0.0, lamp_z)))
    fork.append(wedge((-0.28, -0.07, r + 0.02), (ahead, 0.07, r + 0.06), PAINT, top_x=(-0.18, ahead - 0.08)))
    fork += _blinkers(at + 0.06, 0.18, lamp_z)
    if not low_rider:
        fork.append(
            wedge(
                (at - 0.12, -0.17, lamp_z - 0.16), (at + 0.16, 0.17, lamp_z + 0.22), PAINT, top_x=(at - 0.16, at - 0.02)
            )
        )
        body += both_sides(wedge((-0.2, 0.12, 0.28), (0.4, 0.2, seat - 0.02), PAINT, top_x=(0.0, 0.36)))
    return _assembled(blueprint, body, fork, riders, (0.13, 0.16), 7)


def _blinkers(x_m: float, y_m: float, z_m: float) -> list[Mesh]:
    """Return two blinkers on stalks."""
    stalk = rod((x_m, -y_m, z_m), (x_m, y_m, z_m), 0.008, BLACK, sides=4)
    left = ball((x_m, -y_m, z_m), (0.03, 0.03, 0.025), BLINKER_LEFT, sides=6, bands=4)
    right = ball((x_m, y_m, z_m), (0.03, 0.03, 0.025), BLINKER_RIGHT, sides=6, bands=4)
    return [stalk, left, right]


def _scooter(blueprint: Blueprint) -> dict[str, list[Shape]]:
    front, _ = _hubs(blueprint)
    half, r = blueprint.box.extent, front.z
    grips = (front.x - 0.22, 0.98)
    riders = _riders(
        blueprint,
        hips_x_m=-0.3,
        lean_deg=3.0,
        hand_m=(grips[0] - 0.03, grips[1] + 0.02),
        feet_m=((0.18, 0.37), (0.22, 0.37)),
    )
    seat = riders.saddle_m
    body = [
        box((-0.2, -0.2, 0.24), (0.4, 0.2, 0.3), PAINT),
        ball((-0.48, 0.0, 0.48), (0.42, 0.22, 0.26), PAINT, sides=10),
        wedge((-0.6, -0.14, seat - 0.13), (-0.08, 0.14, seat), BLACK, top_x=(-0.62, -0.12)),
        wedge((0.32, -0.24, 0.27), (0.42, 0.24, 0.9), PAINT, top_x=(0.28, 0.33)),
        box((-half.x + 0.01, -0.06, 0.52), (-half.x + 0.06, 0.06, 0.6), TAIL),
        box((-half.x + 0.002, -0.1, 0.34), (-half.x + 0.02, 0.1, 0.5), PLATE),
        rod((-half.x + 0.05, 0.0, 0.5), (-0.7, 0.0, 0.55), 0.05, PAINT),
        *_blinkers(-half.x + 0.1, 0.18, 0.52),
    ]
    fork = _bars(blueprint, front, grips, STEEL, 0.06)
    at, lamp_z = grips[0] - front.x, grips[1] - front.z
    fork.append(moved(ball((0.0, 0.0, 0.0), (0.09, 0.12, 0.08), PAINT), (at + 0.04, 0.0, lamp_z)))
    fork.append(moved(ball((0.0, 0.0, 0.0), (0.04, 0.06, 0.06), HEAD), (at + 0.11, 0.0, lamp_z)))
    fork.append(wedge((-0.24, -0.1, 0.3 * r), (half.x - front.x, 0.1, r + 0.06), PAINT, top_x=(-0.16, 0.12)))
    fork += _blinkers(at + 0.08, 0.2, lamp_z - 0.14)
    return _assembled(blueprint, body, fork, riders, (0.1, 0.1), 5)


def wheelchair() -> Mesh:
    """Return a wheelchair that stands on the ground around the origin and looks along x."""
    wheel = moved(spoked_wheel(0.3, 0.035, 10, SemanticTag.PEDESTRIANS), (-0.08, 0.29, 0.3))
    caster = moved(hoop(0.07, 0.02, RUBBER), (0.3, 0.24, 0.09))
    sides = [
        wheel,
        caster,
        _line([(-0.28, 0.23, 0.92), (-0.22, 0.23, 0.45), (0.26, 0.23, 0.45), (0.36, 0.23, 0.18)], 0.014, STEEL),
        _line([(0.26, 0.23, 0.45), (0.3, 0.24, 0.12)], 0.012, STEEL),
        box((-0.16, 0.22, 0.64), (0.2, 0.28, 0.68), BLACK),
        box((0.36, 0.05, 0.14), (0.54, 0.21, 0.16), BLACK),
    ]
    seat = box((-0.2, -0.23, 0.43), (0.26, 0.23, 0.48), BLACK)
    back = wedge((-0.26, -0.23, 0.46), (-0.22, 0.23, 0.88), BLACK, top_x=(-0.31, -0.27))
    return join([seat, back, *(mesh for part in sides for mesh in both_sides(part))])
