"""Which vehicle is built how."""

from collections.abc import Callable

from linden.meshes.actors.cars import car
from linden.meshes.actors.heavy import ambulance, bus, firetruck, freight_truck
from linden.meshes.actors.shape import Shape
from linden.meshes.actors.shuttle import shuttle
from linden.meshes.actors.two_wheelers import two_wheeler
from linden.world.blueprints import Blueprint

_OF_ITS_OWN: dict[str, Callable[[Blueprint], list[Shape]]] = {
    "vehicle.carlamotors.carlacola": freight_truck,
    "vehicle.carlamotors.european_hgv": freight_truck,
    "vehicle.carlamotors.firetruck": firetruck,
    "vehicle.easymile.ez10": shuttle,
    "vehicle.ford.ambulance": ambulance,
    "vehicle.mitsubishi.fusorosa": bus,
}


def vehicle(blueprint: Blueprint) -> dict[str, list[Shape]]:
    """Return the parts of a vehicle: by ``driver_id`` where there is a rider to be seen, otherwise under ""."""
    assert blueprint.vehicle is not None
    if len(blueprint.vehicle.wheel_offsets_m) == 2:
        return two_wheeler(blueprint)
    return {"": _OF_ITS_OWN.get(blueprint.definition.id, car)(blueprint)}
