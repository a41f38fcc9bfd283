"""Buses, trucks and ambulances: a cab or a whole hull, with what they carry behind it."""

from linden.blueprints.library import Blueprint
from linden.scenery.mesh import Material, Mesh, join
from linden_maps.models.cars import frame_of, wheels
from linden_maps.models.fittings import beacons, front, mirrors, pair, plaque, rear, underside
from linden_maps.models.hull import PROUD_M, BodyFrame, Silhouette, hull, ring_heights, silhouettes
from linden_maps.models.solids import (
    BLACK,
    BLINKER_LEFT,
    BLINKER_RIGHT,
    CHROME,
    PAINT,
    PLATE,
    REVERSE,
    STEEL,
    TAIL,
    TRIM,
    FaceLook,
    Shape,
    both_sides,
    box,
    rod,
    tagged,
)

_MIRRORS_M = 0.2
"""How far the mirrors of trucks and buses stand off their flanks."""

_WHITE = FaceLook(Material.PLAIN, (236, 236, 234))
_STRIPE = FaceLook(Material.PLAIN, (190, 40, 30))
_SHUTTER = FaceLook(Material.METAL, (170, 172, 174))


def bus(blueprint: Blueprint) -> list[Shape]:
    """Return the parts of a bus."""
    half = blueprint.box.extent
    frame = frame_of(blueprint, roof_m=blueprint.box.location.z + half.z, mirrors_m=1.5 * _MIRRORS_M)
    shape = silhouettes()[blueprint.definition.id]
    sign = plaque(frame.front - 0.05, (-0.9, 0.9), (0.9 * frame.roof, 0.955 * frame.roof), BLACK)
    parts = [hull(shape, frame), underside(frame), *front(shape, frame), *rear(shape, frame), sign]
    parts += mirrors(shape, frame, half.y)
    return [Shape(tagged(join(parts), blueprint.semantic_tags[0]), 0), *wheels(blueprint, frame.half_width)]


def _cab(whole: BodyFrame, length_m: float, roof_m: float) -> BodyFrame:
    """Return the frame of a cab of so much length at the front of a vehicle."""
    return whole._replace(rear=whole.front - length_m, roof=roof_m)


def _truck(blueprint: Blueprint, shape: Silhouette, cab: BodyFrame, whole: BodyFrame, load: list[Mesh]) -> list[Shape]:
    """Return the parts of a truck: cab, chassis, load, wheels with mudguards, lamps."""
    half_y, hub_m = blueprint.box.extent.y, whole.wheel_radius
    chassis = box((whole.rear + 0.1, -0.45, 0.8 * hub_m), (cab.rear + 0.2, 0.45, 1.9 * hub_m), BLACK)
    parts = [
        hull(shape, cab, is_cab=True),
        underside(cab),
        *front(shape, cab),
        *mirrors(shape, cab, half_y),
        chassis,
        *load,
    ]
    parts += _tail(whole)
    return [Shape(tagged(join(parts), blueprint.semantic_tags[0]), 0), *wheels(blueprint, whole.half_width)]


def _tail(frame: BodyFrame) -> list[Mesh]:
    """Return the bumper at the rear end of a truck, with lamps and plate."""
    x, wide, z = frame.rear, 0.92 * frame.half_width, 1.1 * frame.wheel_radius
    beam = box((x, -wide, z - 0.1), (x + 0.12, wide, z + 0.1), TRIM)
    made = [beam, plaque(x, (-0.26, 0.26), (z - 0.06, z + 0.06), PLATE)]
    for inner, outer, left, right in (
        (0.66, 0.8, TAIL, TAIL),
        (0.8, 0.95, BLINKER_LEFT, BLINKER_RIGHT),
        (0.54, 0.64, REVERSE, REVERSE),
    ):
        made += pair(x, (inner * wide, outer * wide), (z - 0.07, z + 0.07), left, right)
    return made


def _skirt(frame: BodyFrame, high_m: float, look: FaceLook) -> Mesh:
    """Return what closes a body's rear below its floor, behind the bumper."""
    return box(
        (frame.rear + 0.13, -frame.half_width + 0.26, 0.45), (frame.rear + 0.2, frame.half_width - 0.26, high_m), look
    )


def _over_axle(whole: BodyFrame, look: FaceLook) -> list[Mesh]:
    """Return mudguards over the rear wheels."""
    x, r = whole.axles[0], whole.wheel_radius
    return both_sides(
        box((x - 1.15 * r, whole.half_width - 0.32, 2.06 * r), (x + 1.15 * r, whole.half_width, 2.12 * r), look)
    )


def freight_truck(blueprint: Blueprint) -> list[Shape]:
    """Return the parts of a truck with a closed box behind a cab over its engine."""
    shape, top_m = silhouettes()[blueprint.definition.id], blueprint.box.location.z + blueprint.box.extent.z
    whole = frame_of(blueprint, roof_m=top_m, mirrors_m=_MIRRORS_M)
    cab = _cab(whole, 0.26 * (whole.front - whole.rear) + 0.1, 0.9 * top_m)
    wide, floor = whole.half_width, 2.12 * whole.wheel_radius
    is_cola = top_m < 3.0
    cargo = box((whole.rear - PROUD_M, -wide, floor), (cab.rear - 0.08, wide, top_m), PAINT if is_cola else _WHITE)
    doors = [
        box((whole.rear - PROUD_M, y - 0.015, floor + 0.05), (whole.rear - 0.0, y + 0.015, top_m - 0.1), STEEL)
        for y in (-0.5 * wide, 0.0, 0.5 * wide)
    ]
    stripe_m = (floor + 0.3 * (top_m - floor), floor + 0.55 * (top_m - floor))
    stripe = box(
        (whole.rear + 0.4, -wide - 0.006, stripe_m[0]),
        (cab.rear - 0.5, wide + 0.006, stripe_m[1]),
        _WHITE if is_cola else PAINT,
    )
    spoiler = box((cab.rear + 0.1, -0.8 * wide, cab.roof - 0.05), (cab.rear + 0.9, 0.8 * wide, top_m - 0.1), PAINT)
    guards = both_sides(
        box((whole.axles[0] + 0.7, wide - 0.05, 0.45), (whole.axles[1] - 0.75, wide, 0.95 * floor), TRIM)
    )
    load = [cargo, *doors, stripe, spoiler, *guards, *_over_axle(whole, BLACK)]
    return _truck(blueprint, shape, cab, whole, load)


def firetruck(blueprint: Blueprint) -> list[Shape]:
    """Return the parts of a fire truck: a double cab, shutters, and a ladder above."""
    shape, top_m = silhouettes()[blueprint.definition.id], blueprint.box.location.z + blueprint.box.extent.z
    whole = frame_of(blueprint, roof_m=top_m, mirrors_m=_MIRRORS_M)
    roof_m, wide = 0.78 * top_m, whole.half_width
    cab = _cab(whole, 3.0, roof_m)
    floor, back = 2.1 * whole.wheel_radius, whole.rear
    load = [box((back, -wide, floor), (cab.rear - 0.03, wide, roof_m), PAINT), *_over_axle(whole, BLACK)]
    load += both_sides(box((back + 0.02, wide - 0.25, 0.55), (whole.axles[0] - 0.6, wide, floor), PAINT))
    load += both_sides(box((whole.axles[0] + 0.6, wide - 0.25, 0.55), (cab.rear - 0.03, wide, floor), PAINT))
    load += [
        _skirt(whole, floor, PAINT),
        plaque(back, (-0.55 * wide, 0.55 * wide), (floor + 0.08, roof_m - 0.25), _SHUTTER),
    ]
    span_m = (cab.rear - 0.1 - back) / 4.0
    for n in range(4):
        start = back + 0.08 + n * span_m
        low = floor + 0.06 if abs(start + 0.5 * span_m - whole.axles[0]) < 0.9 else 0.65
        load += both_sides(
            box((start, wide - 0.02, low), (start + span_m - 0.12, wide + PROUD_M, roof_m - 0.25), _SHUTTER)
        )
    load.append(box((back + 0.3, -wide - 0.008, roof_m - 0.2), (cab.rear - 0.1, wide + 0.008, roof_m - 0.1), _WHITE))
    load += both_sides(box((cab.rear + 0.1, wide - 0.05, 1.02), (cab.front - 1.0, wide + 0.008, 1.14), _WHITE))
    load += _ladder(back + 0.1, cab.front - 1.2, roof_m + 0.25, top_m)
    load += beacons(cab.front - 0.9, 0.85 * wide, roof_m - 0.01, roof_m + 0.2)
    return _truck(blueprint, shape, cab, whole, load)


def _ladder(rear_m: float, front_m: float, low_m: float, top_m: float) -> list[Mesh]:
    """Return a ladder that lies along the roof, on its turntable."""
    made = [box((rear_m + 0.4, -0.6, low_m - 0.3), (rear_m + 1.8, 0.6, low_m), STEEL)]
    for y in (-0.42, 0.42):
        made.append(rod((rear_m, y, low_m + 0.08), (front_m, y, low_m + 0.08), 0.05, CHROME, sides=4))
        made.append(rod((rear_m, y, top_m - 0.05), (front_m, y, top_m - 0.05), 0.05, CHROME, sides=4))
    count = 14
    for n in range(count):
        x = rear_m + 0.1 + n * (front_m - rear_m - 0.2) / (count - 1)
        made.append(box((x - 0.02, -0.42, low_m + 0.06), (x + 0.02, 0.42, low_m + 0.1), CHROME))
        made += both_sides(box((x - 0.02, 0.4, low_m + 0.08), (x + 0.02, 0.44, top_m - 0.05), CHROME))
    made.append(box((rear_m, -0.47, low_m + 0.03), (rear_m + 0.06, 0.47, top_m), CHROME))
    return made


def ambulance(blueprint: Blueprint) -> list[Shape]:
    """Return the parts of an ambulance: a van's cab and a box with stripes and beacons."""
    shape, top_m = silhouettes()[blueprint.definition.id], blueprint.box.location.z + blueprint.box.extent.z
    whole = frame_of(blueprint, roof_m=top_m, mirrors_m=0.14)
    cab = _cab(whole, 2.75, 0.82 * top_m)
    wide, roof_m, floor = whole.half_width, top_m - 0.12, 1.0
    body = (whole.rear, cab.rear + 0.25)
    waist = ring_heights(shape, cab, cab.rear + 0.3)[2]
    load = [box((body[0], -wide, floor), (body[1], wide, roof_m), _WHITE), *_over_axle(whole, BLACK)]
    x, r = whole.axles[0], whole.wheel_radius
    load += both_sides(box((body[0], wide - 0.3, 0.4), (x - 1.2 * r, wide, floor), _WHITE))
    load += both_sides(box((x + 1.2 * r, wide - 0.3, 0.4), (body[1], wide, floor), _WHITE))
    load.append(_skirt(whole, floor, _WHITE))
    load.append(
        box((body[0] + 0.05, -wide - 0.008, waist - 0.25), (body[1] - 0.02, wide + 0.008, waist - 0.02), _STRIPE)
    )
    load += both_sides(box((body[1] - 0.9, wide - 0.1, 1.35), (body[1] - 0.25, wide + 0.008, 1.95), BLACK))
    load += [plaque(whole.rear, (low, low + 0.5), (1.35, 1.95), BLACK) for low in (-0.6, 0.1)]
    load += _cross(0.5 * (body[0] + body[1]) - 0.5, wide, 0.5 * (waist + roof_m))
    load += beacons(body[1] - 0.15, 0.85 * wide, roof_m - 0.01, top_m)
    load += beacons(body[0] + 0.15, 0.85 * wide, roof_m - 0.01, top_m)
    return _truck(blueprint, shape, cab, whole, load)


def _cross(x_m: float, y_m: float, z_m: float) -> list[Mesh]:
    """Return a blue cross on either side, as ambulances show the star of life."""
    blue = FaceLook(Material.PLAIN, (30, 70, 170))
    upright = box((x_m - 0.07, y_m - 0.02, z_m - 0.22), (x_m + 0.07, y_m + 0.01, z_m + 0.22), blue)
    across = box((x_m - 0.22, y_m - 0.02, z_m - 0.07), (x_m + 0.22, y_m + 0.011, z_m + 0.07), blue)
    return [*both_sides(upright), *both_sides(across)]
