"""The shipped walking meshes equal the meshes that are made from the shipped maps."""

import lzma
from pathlib import Path

import pytest

from home_map import home_map
from linden.maps.navigation import shipped
from linden.maps.navigation.library import MeshLibrary, made
from linden.maps.navigation.shipped import shipped_mesh, write_mesh
from linden.simulation.walkers import obstacles_of


@pytest.mark.unmeasured
def test_linden_s_is_what_would_be_made() -> None:
    """Else ``scripts/make_walking_meshes.py`` has to make it anew."""
    linden = home_map()
    assert shipped_mesh(linden) == made(linden, obstacles_of(linden))


def test_a_start_makes_none() -> None:
    linden = home_map()
    file = MeshLibrary().file_of(linden, obstacles_of(linden))
    assert file is not None
    assert file.content == shipped_mesh(linden)


def test_a_mesh_of_another_map_of_that_name_is_not_taken(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    linden = home_map()
    monkeypatch.setattr(shipped, "_FOLDER", tmp_path)
    assert shipped_mesh(linden) is None
    file = write_mesh(linden, b"mesh")
    assert shipped_mesh(linden) == b"mesh"
    file.write_bytes(lzma.compress(bytes(32) + b"mesh"))
    assert shipped_mesh(linden) is None
    file.write_bytes(b"no archive")
    assert shipped_mesh(linden) is None
