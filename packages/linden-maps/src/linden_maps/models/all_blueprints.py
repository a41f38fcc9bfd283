"""Makes the meshes of all blueprints: the content of the server's asset ``actor_meshes.xz``."""

import lzma
from collections.abc import Callable
from pathlib import Path

from linden.blueprints.library import ANIMALS, Blueprint, BlueprintKind, BlueprintLibrary
from linden.scenery.actors.actor_meshes import BlueprintMeshes, Part, encoded
from linden.scenery.mesh import Mesh
from linden_maps.models.animals import animal
from linden_maps.models.cars import car, shuttle
from linden_maps.models.heavy import ambulance, bus, firetruck, freight_truck
from linden_maps.models.people import in_wheelchair, walker
from linden_maps.models.props.models import prop
from linden_maps.models.solids import Shape
from linden_maps.models.two_wheelers import two_wheeler, wheelchair

_OF_ITS_OWN: dict[str, Callable[[Blueprint], list[Shape]]] = {
    "vehicle.carlamotors.carlacola": freight_truck,
    "vehicle.carlamotors.european_hgv": freight_truck,
    "vehicle.carlamotors.firetruck": firetruck,
    "vehicle.easymile.ez10": shuttle,
    "vehicle.ford.ambulance": ambulance,
    "vehicle.mitsubishi.fusorosa": bus,
}


def made(library: BlueprintLibrary) -> BlueprintMeshes:
    """Return the meshes of a library's actors, which takes a second; equal libraries give equal bytes."""
    meshes: list[Mesh] = []
    row_of: dict[int, int] = {}  # by the mesh's own identity, so that nothing is compared

    def part(shape: Shape) -> Part:
        row = row_of.setdefault(id(shape.mesh), len(meshes))
        if row == len(meshes):
            meshes.append(shape.mesh)
        return Part(row, shape.frame, shape.colour)

    all_parts = {
        (blueprint.definition.id, choice): tuple(map(part, shapes))
        for blueprint in library
        for choice, shapes in _shapes(blueprint).items()
    }
    return BlueprintMeshes(meshes, all_parts)


def write_asset(path: Path) -> None:
    """Write the compressed meshes of the package's blueprints."""
    path.write_bytes(lzma.compress(encoded(made(BlueprintLibrary.load())), preset=9))


def _shapes(blueprint: Blueprint) -> dict[str, list[Shape]]:
    """Return the parts of a blueprint's actors by the attribute value that changes their look, "" for the plain one."""
    if blueprint.kind is BlueprintKind.VEHICLE:
        return _vehicle(blueprint)
    if blueprint.definition.id.startswith(ANIMALS):
        return {"": animal(blueprint)}
    if blueprint.kind is BlueprintKind.WALKER:
        can_sit = any(
            "true" in a.recommended_values for a in blueprint.definition.attributes if a.id == "use_wheelchair"
        )
        seated = {"true": in_wheelchair(blueprint, wheelchair())} if can_sit else {}
        return {"": walker(blueprint), **seated}
    return {"": prop(blueprint)} if blueprint.kind is BlueprintKind.PROP else {}


def _vehicle(blueprint: Blueprint) -> dict[str, list[Shape]]:
    """Return the parts of a vehicle: by ``driver_id`` where there is a visible rider, otherwise under ""."""
    assert blueprint.vehicle is not None
    if len(blueprint.vehicle.wheel_offsets_m) == 2:
        return two_wheeler(blueprint)
    return {"": _OF_ITS_OWN.get(blueprint.definition.id, car)(blueprint)}
