"""The standing mesh of a map, kept in the user's cache beside what else was derived from it: made once, read after."""

import hashlib
import json
from functools import cache as once
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from linden.compiled import fingerprint, machine
from linden.maps.cache import MapCache
from linden.maps.library import LoadedMap
from linden.scenery.mesh import FACE, Mesh
from linden.scenery.scene.objects import Scene

_PACKAGE = Path(__file__).parent.parent
_MAKING = (
    "scenery/*.py", "scenery/streets/*.py", "scenery/roadside/*.py", "scenery/scene/*.py", "maps/opendrive/**/*.py",
    "maps/ground.py", "data/actor_meshes.xz", "protocol/values/enums.py", "geometry.py",
)  # fmt: skip
_DTYPES = (np.dtype(np.float32), np.dtype(np.uint32), FACE)


def standing_of(world_map: LoadedMap, scene: Scene, cache: MapCache) -> Mesh:
    """Return everything that stands on a map with this scene, out of the cache or made; seconds if it has to be made.

    Its arrays may be read-only.
    """
    return cache.kept(_name(world_map, scene), lambda: _written(_made(world_map, scene)), _read)


def keep_standing(world_map: LoadedMap, scene: Scene, cache: MapCache) -> None:
    """Put the mesh into the cache, so that the first sensor need not wait for it."""
    cache.keep(_name(world_map, scene), lambda: _written(_made(world_map, scene)))


def has_standing(world_map: LoadedMap, scene: Scene, cache: MapCache) -> bool:
    """Return whether the mesh is in the cache."""
    return cache.has(_name(world_map, scene))


def _made(world_map: LoadedMap, scene: Scene) -> Mesh:
    from linden.scenery.map_mesh import standing_on  # noqa: PLC0415 - 50 ms that a start with a cached mesh does without

    return standing_on(world_map, scene)


def _name(world_map: LoadedMap, scene: Scene) -> str:
    """Return a file's name that tells what decides the mesh: the map, what stands on it, the sources, the machine."""
    digest = hashlib.sha256(f"{_sources()} {machine()}\n".encode())
    for part in (world_map.text.encode(), scene.things.tobytes(), scene.boxes.tobytes()):
        digest.update(hashlib.sha256(part).digest())
    return f"{digest.hexdigest()[:32]}.mesh"


@once
def _sources() -> int:
    return fingerprint(*(file for pattern in _MAKING for file in _PACKAGE.glob(pattern)))


def _written(mesh: Mesh) -> bytes:
    """Return the lengths of the arrays as a line of JSON, padded to 64 bytes, and the arrays one after the other."""
    head = json.dumps([len(part) for part in mesh]).encode().ljust(64)
    return b"".join([head, *(np.ascontiguousarray(part).tobytes() for part in mesh)])


def _read(content: bytes) -> Mesh:
    counts = json.loads(content[:64])
    at, parts = 64, list[NDArray[Any]]()
    for count, dtype, width in zip(counts, _DTYPES, (3, 3, 1), strict=True):
        parts.append(np.frombuffer(content, dtype, count * width, at))
        at += count * width * dtype.itemsize
    vertices, triangles, faces = parts
    return Mesh(vertices.reshape(-1, 3), triangles.reshape(-1, 3), faces)
