"""The walking meshes of the maps that come with the package: made when the maps are, and read at a start.

A mesh of Linden takes six seconds of a first start, half of them for the compilation of its kernels.
"""

import hashlib
import lzma
from pathlib import Path

from linden.maps.library import HOME_MAPS, LoadedMap

_FOLDER = Path(__file__).parents[2] / "data"


def shipped_mesh(world_map: LoadedMap) -> bytes | None:
    """Return the file of a map's mesh; None where the package has none that can be read, or one of another map."""
    if world_map.name not in HOME_MAPS:
        return None
    try:
        content = lzma.decompress(_file_of(world_map.name).read_bytes())
    except (OSError, lzma.LZMAError):
        return None
    digest = _digest(world_map)
    return content[len(digest) :] if content.startswith(digest) else None


def write_mesh(world_map: LoadedMap, content: bytes) -> Path:
    """Write the file of a map's mesh among the data of the package, and return its place."""
    file = _file_of(world_map.name)
    file.write_bytes(lzma.compress(_digest(world_map) + content, preset=9))
    return file


def _file_of(name: str) -> Path:
    return _FOLDER / f"{name}.nav.xz"


def _digest(world_map: LoadedMap) -> bytes:
    return hashlib.sha256(world_map.text.encode()).digest()
