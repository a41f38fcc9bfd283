"""Meshes as files: named by their content, made once, kept beside the map's facts."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier
from typing import Any

import numpy as np
import pytest

from linden.background import in_background
from linden.maps.cache import MapCache
from linden.maps.facts import derive
from linden.maps.library import LoadedMap
from linden.maps.navigation import library
from linden.maps.navigation.detour import Obstacles
from linden.maps.navigation.library import MeshLibrary
from opendrive_texts import lane, line, opendrive, road, section, street_through_junction

NOTHING = Obstacles(np.empty((0, 3)), np.empty((0, 3)), np.empty(0))


def loaded(text: str) -> LoadedMap:
    return LoadedMap(name="street", text=text, **vars(derive(text)))


@pytest.fixture(scope="module")
def street() -> LoadedMap:
    return loaded(street_through_junction())


def test_the_name_tells_the_content(street: LoadedMap) -> None:
    file = MeshLibrary().file_of(street, NOTHING)
    assert file is not None
    assert file.name.startswith("Carla/Maps/Nav/street_")
    box = Obstacles(np.array([[20.0, 4.25, 1.0]]), np.array([[0.5, 0.1, 1.0]]), np.zeros(1))
    other = MeshLibrary().file_of(street, box)
    assert other is not None
    assert other.content != file.content
    assert other.name != file.name


def test_a_map_without_pavements_has_none() -> None:
    bare = loaded(opendrive(road(1, 60.0, line(0, 0, 0, 0, 60), section(right=lane(-1)))))
    assert MeshLibrary().file_of(bare, NOTHING) is None


def test_what_was_made_is_not_made_again(street: LoadedMap, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = MeshLibrary(MapCache(tmp_path)).file_of(street, NOTHING)
    monkeypatch.setattr(library, "made", lambda *_: pytest.fail("it was kept"))
    assert MeshLibrary(MapCache(tmp_path)).file_of(street, NOTHING) == first


def test_threads_that_want_a_mesh_at_once_wait_for_the_one_that_makes_it(
    street: LoadedMap, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[bytes] = []
    make, together, meshes = library.made, Barrier(4), MeshLibrary()

    def counted(*given: Any) -> bytes:
        made.append(make(*given))
        return made[-1]

    def ask(_: int) -> object:
        together.wait(60.0)
        return meshes.file_of(street, NOTHING)

    monkeypatch.setattr(library, "made", counted)
    with ThreadPoolExecutor(4) as threads:
        first, *others = threads.map(ask, range(4))
    assert first is not None
    assert all(other is first for other in others)
    assert len(made) == 1
    with meshes._making:  # as while the mesh of another map is made
        assert in_background(lambda: meshes.file_of(street, NOTHING)).result(60.0) is first


def test_a_broken_file_is_made_anew(street: LoadedMap, tmp_path: Path) -> None:
    first = MeshLibrary(MapCache(tmp_path)).file_of(street, NOTHING)
    (kept,) = tmp_path.glob("*.nav")
    kept.write_bytes(kept.read_bytes()[:-100] + bytes(100))
    assert MeshLibrary(MapCache(tmp_path)).file_of(street, NOTHING) == first
    assert MeshLibrary(MapCache(Path("/dev/null"))).file_of(street, NOTHING) == first
