"""Maps by their names: which there are, which name finds which, and what is said where there is none."""

import gc
import weakref
from pathlib import Path

import pytest

from linden.errors import Refusal, UserError
from linden.maps.library import MOST_KEPT, MapLibrary
from linden.maps.opendrive import parse
from linden.maps.reading import MapReading, read
from opendrive_texts import street_through_junction

STREET = street_through_junction()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "Street.xodr").write_text(STREET)
    return tmp_path


def test_names_are_those_of_the_packaged_maps_and_the_users(folder: Path) -> None:
    assert MapLibrary([folder]).names() == [
        f"/Game/Carla/Maps/{name}" for name in ("Linden", "Linden_thesis", "Street")
    ]


@pytest.mark.parametrize("name", ["Street", "Carla/Maps/Street", "/Game/Carla/Maps/Street", "Street.xodr"])
def test_a_map_is_found_by_each_of_its_names(folder: Path, name: str) -> None:
    loaded = MapLibrary([folder]).load(name)
    assert (loaded.name, loaded.full_name, loaded.text) == ("Street", "Carla/Maps/Street", STREET)


def test_a_map_is_made_ready_once(folder: Path) -> None:
    made = []

    def noted(text: str, _walls_beyond_m: float | None = None) -> MapReading:
        made.append(text)
        return read(text)

    library = MapLibrary([folder], noted)
    assert made == []
    assert library.load("Street") is library.load("Carla/Maps/Street")
    assert made == [STREET]


def test_a_sent_map_is_kept_under_carlas_name_until_another_is_sent(folder: Path) -> None:
    library = MapLibrary([folder])
    first = library.from_opendrive(STREET)
    library.keep(first)
    assert library.load("OpenDriveMap") is first
    assert library.from_opendrive(STREET) is not first
    assert library.names() == [f"/Game/Carla/Maps/{name}" for name in ("Linden", "Linden_thesis", "Street")]


def test_a_missing_map_is_refused_with_the_maps_that_exist(folder: Path) -> None:
    with pytest.raises(Refusal, match=r"Map 'Town10' not found; this server has: Linden, Linden_thesis, Street"):
        MapLibrary([folder]).load("Town10")


@pytest.mark.parametrize("content", [b"", b"<OpenDRIVE>", b"\xff\xfe\x00"])
def test_a_file_that_is_no_map_is_refused(folder: Path, content: bytes) -> None:
    (folder / "Street.xodr").write_bytes(content)
    with pytest.raises(Refusal, match="Map 'Street' cannot be read: "):
        MapLibrary([folder]).load("Street")


def test_a_sent_text_that_is_no_map_is_refused(folder: Path) -> None:
    with pytest.raises(Refusal, match="the OpenDRIVE text cannot be used: "):
        MapLibrary([folder]).from_opendrive("no map")


def test_a_folder_without_maps_is_an_error_of_the_user(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"holds no \.xodr file"):
        MapLibrary([tmp_path])
    with pytest.raises(UserError, match="is not a folder"):
        MapLibrary([tmp_path / "nowhere"])


def test_a_library_lets_go_of_maps_that_were_loaded_long_ago(tmp_path: Path) -> None:
    for number in range(MOST_KEPT + 3):
        (tmp_path / f"Street{number}.xodr").write_text(STREET.replace('name="Test"', f'name="{number}"'), "utf-8")
    library = MapLibrary([tmp_path])
    sent = library.from_opendrive(STREET)
    library.keep(sent)
    loaded = [weakref.ref(library.load(f"Street{number}")) for number in range(MOST_KEPT + 3)]
    gc.collect()
    assert [found() is not None for found in loaded] == [False] * 3 + [True] * MOST_KEPT
    again = library.load("OpenDriveMap")
    assert again is not sent  # what was read of it has gone
    assert (again.text, again.walls) == (sent.text, sent.walls)
    assert again.ground.planes.tobytes() == sent.ground.planes.tobytes()


def test_a_text_is_parsed_once_for_its_facts_and_its_walls(monkeypatch: pytest.MonkeyPatch) -> None:
    parsed = []
    read = parse._root
    monkeypatch.setattr(parse, "_root", lambda text: (parsed.append(len(text)), read(text))[1])
    assert len(MapLibrary().from_opendrive(STREET + "<!-- -->", wall_height_m=1.0).walls.feet_m)
    assert parsed == [len(STREET) + 8]
