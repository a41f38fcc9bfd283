"""The meshes of all blueprints, kept in the user's cache like what stands on a map: made once, read after."""

import hashlib
import json
from functools import cache as once
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from linden.blueprints.library import BlueprintLibrary
from linden.compiled import fingerprint, machine
from linden.maps.cache import MapCache
from linden.scenery.mesh import FACE, Mesh

if TYPE_CHECKING:
    from linden.scenery.actors.actor_meshes import Bodies

_PACKAGE = Path(__file__).parents[2]
_MAKING = (
    "scenery/*.py", "scenery/actors/*.py", "scenery/props/*.py", "blueprints/*.py", "data/blueprints.json",
    "protocol/values/*.py", "geometry.py",
)  # fmt: skip
_HEAD = 16
"""Digits of how long the text is that says what lies behind it."""


def bodies_of(library: BlueprintLibrary, cache: MapCache) -> "Bodies":
    """Return the meshes of a library's actors, out of the cache or made, which takes a second.

    Their arrays may be read-only.
    """
    return cache.kept(_name(), lambda: _made(library), _read)


def keep_bodies(library: BlueprintLibrary, cache: MapCache) -> None:
    """Have the meshes in the cache."""
    cache.keep(_name(), lambda: _made(library))


def has_bodies(cache: MapCache) -> bool:
    """Return whether the meshes are in the cache."""
    return cache.has(_name())


@once
def _name() -> str:
    sources = fingerprint(*(file for pattern in _MAKING for file in _PACKAGE.glob(pattern)))
    return f"{hashlib.sha256(f'{sources} {machine()}'.encode()).hexdigest()[:32]}.bodies"


def _made(library: BlueprintLibrary) -> bytes:
    from linden.scenery.actors.actor_meshes import Bodies  # noqa: PLC0415 - a start that finds them kept does without

    return _written(Bodies(library))


def _written(bodies: "Bodies") -> bytes:
    """Return how many vertices and triangles each mesh has and which parts an actor has, as JSON, and all arrays."""
    counts = [(len(mesh.vertices_m), len(mesh.triangles)) for mesh in bodies.meshes]
    parts = [(*named, chosen) for named, chosen in bodies.all_parts.items()]
    text = json.dumps([counts, parts]).encode()
    text += b" " * (-len(text) % _HEAD)  # so that the arrays begin where Embree, which reads them in place, wants them
    columns = zip(zip(*bodies.meshes, strict=True), (np.float32, np.uint32, FACE), strict=True)
    arrays = [np.concatenate(column).astype(kind) for column, kind in columns]
    return b"".join([f"{len(text):{_HEAD}}".encode(), text, *(array.tobytes() for array in arrays)])


def _read(content: bytes) -> "Bodies":
    from linden.scenery.actors.actor_meshes import Bodies, Part  # noqa: PLC0415 - as in _made

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
    return Bodies.kept(meshes, all_parts)
