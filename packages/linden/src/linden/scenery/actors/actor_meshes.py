"""Meshes of all actors, read from the asset that the package holds, and the bone or wheel that each part follows.

``linden_maps.models`` makes the asset, ``data/actor_meshes.xz``. It holds, compressed, the number of vertices and
triangles of each mesh and the parts of each actor as JSON, and then all arrays.
"""

import json
import lzma
from functools import cache
from importlib import resources
from typing import NamedTuple

import numpy as np

from linden.protocol.values.actors import ActorDescription
from linden.scenery.mesh import FACE, Mesh

ASSET = "data/actor_meshes.xz"
SCALED = "static.prop.mesh"
"""The one blueprint with a size that the client chooses at the spawn."""
_HEAD = 16
"""Digits of the length of the JSON text."""


class Part(NamedTuple):
    """A mesh of an actor, the frame that it stands in, and its own colour where it has one."""

    mesh: int  # row of BlueprintMeshes.meshes
    frame: int  # of posing.VEHICLE_FRAMES or WALKER_FRAMES; 0 is the actor's own
    colour: tuple[int, int, int] | None = None  # of painted faces; None where they have the actor's
    scale: float = 1.0  # how many times larger it is seen


class BlueprintMeshes(NamedTuple):
    """The meshes of all blueprints. Parts that have the same mesh name the same row."""

    meshes: list[Mesh]
    all_parts: dict[tuple[str, str], tuple[Part, ...]]
    """The parts by blueprint and by the attribute value that changes the actor's look; "" for the plain look."""

    def parts(self, description: ActorDescription) -> tuple[Part, ...]:
        """Return the parts of an actor with this description; none for invisible actors (sensors, controllers)."""
        chosen = description.attribute("driver_id") or description.attribute("use_wheelchair")
        plain = self.all_parts.get((description.id, ""), ())
        parts = self.all_parts.get((description.id, chosen), plain)
        if description.id != SCALED:
            return parts
        scale = description.number("scale")
        return tuple(part._replace(scale=scale) for part in parts)


@cache
def actor_meshes() -> BlueprintMeshes:
    """Return the meshes of the package's blueprints; their arrays are read-only."""
    return decoded(lzma.decompress(resources.files("linden").joinpath(ASSET).read_bytes()))


def encoded(bodies: BlueprintMeshes) -> bytes:
    """Return the content of the asset, before its compression."""
    counts = [(len(mesh.vertices_m), len(mesh.triangles)) for mesh in bodies.meshes]
    parts = [(*named, chosen) for named, chosen in bodies.all_parts.items()]
    text = json.dumps([counts, parts]).encode()
    text += b" " * (-len(text) % _HEAD)  # Embree reads the arrays in place and requires that they are aligned
    columns = zip(zip(*bodies.meshes, strict=True), (np.float32, np.uint32, FACE), strict=True)
    arrays = [np.concatenate(column).astype(kind) for column, kind in columns]
    return b"".join([f"{len(text):{_HEAD}}".encode(), text, *(array.tobytes() for array in arrays)])


def decoded(content: bytes) -> BlueprintMeshes:
    """Return the meshes that ``encoded`` wrote."""
    start = _HEAD + int(content[:_HEAD])
    counts, parts = json.loads(content[_HEAD:start])
    corners, triangles = map(sum, zip(*counts, strict=True))
    vertices_m = np.frombuffer(content, np.float32, 3 * corners, start).reshape(-1, 3)
    rows = np.frombuffer(content, np.uint32, 3 * triangles, start + vertices_m.nbytes).reshape(-1, 3)
    faces = np.frombuffer(content, FACE, triangles, start + vertices_m.nbytes + rows.nbytes)
    meshes, at, face = list[Mesh](), 0, 0
    for many, count in counts:
        meshes.append(Mesh(vertices_m[at : at + many], rows[face : face + count], faces[face : face + count]))
        at, face = at + many, face + count
    all_parts = {
        (blueprint, choice): tuple(
            Part(mesh, frame, colour and tuple(colour), scale) for mesh, frame, colour, scale in found
        )
        for blueprint, choice, found in parts
    }
    return BlueprintMeshes(meshes, all_parts)
