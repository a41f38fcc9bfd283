"""Actors as entities of OpenSCENARIO. The reference point of each is the middle of its box, as in CARLA."""

from __future__ import annotations

from scenariogeneration import xosc

from basu.testing.offline_stage import half_sizes_m

CATEGORIES = (
    ("vehicle.easymile", "bus"),
    ("vehicle.mitsubishi.fusorosa", "bus"),
    ("vehicle.mercedes.sprinter", "van"),
    ("vehicle.carlamotors", "truck"),
    ("vehicle.bh", "bicycle"),
    ("vehicle.diamondback", "bicycle"),
    ("vehicle.gazelle", "bicycle"),
    ("vehicle.kawasaki", "motorbike"),
    ("vehicle.yamaha", "motorbike"),
    ("vehicle.harley", "motorbike"),
    ("vehicle.vespa", "motorbike"),
    ("", "car"),
)
"""The category of vehicles by the begin of their blueprint's id; the first that fits."""
HEIGHTS_M = {"bicycle": 1.7, "motorbike": 1.6, "bus": 2.8, "van": 2.5, "truck": 2.5, "car": 1.5}
MASSES_KG = {"bicycle": 90.0, "motorbike": 250.0, "bus": 3500.0, "van": 2500.0, "truck": 5000.0, "car": 1500.0}
MOST_MPS, MOST_MPS2 = 40.0, 10.0
"""Of all vehicles: their trajectories say how they move."""
AXLES = 0.6
"""The distance of the axles, as a share of the length."""
WHEEL_M, WHEEL_RAD = 0.6, 0.6
"""The diameter of wheels, and how far they turn."""
WALKER_M, CHILD_M = 1.75, 1.2
WALKER_KG, THING_KG = 75.0, 50.0
CHILDREN = tuple(f"walker.pedestrian.00{number:02d}" for number in (9, 10, 11, 12, 13, 14, 48, 49))
"""CARLA's pedestrians of the age "child"."""


def entity_of(blueprint: str, *, by_agent: bool) -> xosc.Vehicle | xosc.Pedestrian | xosc.MiscObject:
    """Return the entity of a blueprint, which has the blueprint's id as its name.

    Args:
        blueprint: an id, or a pattern.
        by_agent: whether an agent drives it; ScenarioRunner asks for that.
    """
    half_length_m, half_width_m = half_sizes_m(blueprint)
    length_m, width_m = 2.0 * half_length_m, 2.0 * half_width_m

    def box(height_m: float) -> xosc.BoundingBox:
        return xosc.BoundingBox(width_m, length_m, height_m, 0.0, 0.0, height_m / 2.0)

    if blueprint.startswith("walker."):
        animal = blueprint.startswith("walker.animal.")
        category = xosc.PedestrianCategory.animal if animal else xosc.PedestrianCategory.pedestrian
        height_m = CHILD_M if animal or blueprint in CHILDREN else WALKER_M
        return xosc.Pedestrian(blueprint, WALKER_KG, category, box(height_m), blueprint)
    if blueprint.startswith("static."):
        return xosc.MiscObject(blueprint, THING_KG, xosc.MiscObjectCategory.obstacle, box(1.0))
    category = next(name for begin, name in CATEGORIES if blueprint.startswith(begin))
    axle_m, track_m = AXLES * half_length_m, 0.8 * width_m
    front = xosc.Axle(WHEEL_RAD, WHEEL_M, track_m, axle_m, WHEEL_M / 2.0)
    rear = xosc.Axle(0.0, WHEEL_M, track_m, -axle_m, WHEEL_M / 2.0)
    vehicle = xosc.Vehicle(
        blueprint,
        getattr(xosc.VehicleCategory, category),
        box(HEIGHTS_M[category]),
        front,
        rear,
        MOST_MPS,
        MOST_MPS2,
        MOST_MPS2,
        MASSES_KG[category],
    )
    vehicle.add_property("type", "ego_vehicle" if by_agent else "simulation")
    return vehicle
