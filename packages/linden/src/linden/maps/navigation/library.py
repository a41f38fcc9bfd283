"""The walking meshes of maps as the files that clients fetch: shipped, or made once and cached with the map's facts."""

import hashlib
import logging
import time
from pathlib import Path
from typing import NamedTuple
from weakref import WeakKeyDictionary

from linden.background import OneAtATime
from linden.compiled import fingerprint, machine
from linden.maps.cache import MapCache
from linden.maps.library import LoadedMap
from linden.maps.navigation.detour import Obstacles, write
from linden.maps.navigation.shipped import shipped_mesh

log = logging.getLogger("linden")

_FOLDER = "Carla/Maps/Nav"
_PACKAGE = Path(__file__).parents[2]
_DERIVING = ("maps/opendrive/**/*.py", "maps/navigation/*.py", "maps/ground.py", "geometry.py", "compiled.py")


class MeshFile(NamedTuple):
    """A file and the name under which clients keep it for ever; so the name tells the content."""

    name: str
    content: bytes


class MeshLibrary:
    """The meshes of the maps that were asked for."""

    def __init__(self, cache: MapCache | None = None) -> None:
        """Keep meshes in ``cache`` too, where there is one."""
        self._cache = cache
        self._known: WeakKeyDictionary[LoadedMap, MeshFile | None] = WeakKeyDictionary()
        self._making = OneAtATime()

    def knows(self, world_map: LoadedMap) -> bool:
        """Return whether the mesh of a map is made, so that :meth:`file_of` takes no time."""
        return world_map in self._known

    def file_of(self, world_map: LoadedMap, obstacles: Obstacles) -> MeshFile | None:
        """Return the mesh of a map, None where it has no pavements. ``obstacles`` are always those of the map.

        Any thread may call it. One thread at a time makes a mesh. A mesh that is made is returned at once.
        """
        if world_map not in self._known:
            with self._making:
                if world_map not in self._known:
                    self._known[world_map] = self._found(world_map, obstacles)
        return self._known[world_map]

    def _found(self, world_map: LoadedMap, obstacles: Obstacles) -> MeshFile | None:
        content = shipped_mesh(world_map)
        if content is None:
            content = self._kept(world_map, obstacles) if self._cache else made(world_map, obstacles)
        digest = hashlib.sha256(content).hexdigest()[:16]
        return MeshFile(f"{_FOLDER}/{world_map.name}_{digest}.bin", content) if content else None

    def _kept(self, world_map: LoadedMap, obstacles: Obstacles) -> bytes:
        assert self._cache is not None
        sources = fingerprint(*(file for pattern in _DERIVING for file in _PACKAGE.glob(pattern)))
        key = hashlib.sha256(f"{sources} {machine()}\n".encode())
        key.update(world_map.text.encode())
        for column in obstacles:
            key.update(column.tobytes())
        return self._cache.kept(f"{key.hexdigest()[:32]}.nav", lambda: made(world_map, obstacles), bytes)


def made(world_map: LoadedMap, obstacles: Obstacles) -> bytes:
    """Return the file of a map's mesh; empty where there is no place to walk."""
    from linden.maps.navigation.map_mesh import mesh_of  # noqa: PLC0415 - a start with a cached mesh does without

    begin_s = time.perf_counter()
    mesh = mesh_of(world_map, world_map.text, obstacles)
    log.info("walking mesh of %s: %d tiles, %.1f s", world_map.name, len(mesh.tiles), time.perf_counter() - begin_s)
    return write(mesh) if mesh.tiles else b""
