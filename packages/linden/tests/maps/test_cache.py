"""What is kept of maps: as good as derived anew, and never a reason not to start."""

import logging
import os
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from linden.maps import cache as map_cache
from linden.maps.archive import pack, unpack
from linden.maps.cache import MapCache
from linden.maps.facts import MapFacts, derive
from linden.maps.library import HOME_MAP, LoadedMap, MapLibrary
from linden.maps.opendrive.limits import MapError
from linden.maps.reading import MapReading, read
from linden.protocol.values.actors import ActorDescription
from linden.world import World
from opendrive_texts import signal, street_through_junction

LIGHT, LIMIT = signal("7", s=30.0, t=-5.0, kind="1000001"), signal("8", s=10.0, t=-5.0, kind="274")
CONTROLLER = '<controller id="5" name="both" sequence="1"><control signalId="7" type=""/></controller>'
STREET = street_through_junction(signals=LIGHT + LIMIT, controllers=CONTROLLER)


def keep(folder: Path, text: str = STREET) -> Path:
    """Fill a cache with a map; return the file that holds it."""
    MapCache(folder).facts_of(text)
    (file,) = folder.iterdir()
    return file


def refuse_to_read(_text: str, _walls_beyond_m: float | None, _facts: MapFacts | None) -> MapReading:
    raise AssertionError("the map was read although it was kept")


@pytest.fixture
def nothing_is_read(monkeypatch: pytest.MonkeyPatch) -> Callable[[], None]:
    return lambda: monkeypatch.setattr(map_cache, "read_text", refuse_to_read)


def assert_same(first: MapFacts, second: MapFacts) -> None:
    """Compare to the last bit and to the types of every number."""
    for one, other in zip(pack(first).items(), pack(second).items(), strict=True):
        (name, a), (other_name, b) = one, other
        assert (name, a.dtype, a.shape, a.tobytes()) == (other_name, b.dtype, b.shape, b.tobytes())
    for a, b in zip(first.ground, second.ground, strict=True):
        assert type(a) is type(b)
        assert a.flags == b.flags or (a.flags.c_contiguous and b.flags.c_contiguous and a.flags.writeable)
    records = ("spawn_points", "signals", "controllers", "geo_origin_deg")
    assert repr([getattr(first, name) for name in records]) == repr([getattr(second, name) for name in records])


@pytest.mark.unmeasured
def test_what_is_kept_of_linden_is_what_would_be_derived(tmp_path: Path, nothing_is_read: Callable[[], None]) -> None:
    text = (Path(map_cache.__file__).parent.parent / "data" / f"{HOME_MAP}.xodr").read_text("utf-8")
    derived = MapCache(tmp_path).facts_of(text)
    nothing_is_read()
    kept = MapCache(tmp_path).facts_of(text)
    assert len(kept.signals) > 100
    assert len(kept.controllers) > 0
    assert_same(derived, kept)


def snapshots(facts: MapFacts) -> list[bytes]:
    """Drive every kind of body about a map and return every frame's rows."""
    simulation = World(LoadedMap(name="street", text=STREET, **vars(facts)))
    for number, model in enumerate(("vehicle.tesla.model3", "walker.pedestrian.0001", "vehicle.kawasaki.ninja")):
        simulation.spawn(ActorDescription(0, model), facts.spawn_points[number])
    frames = []
    for _ in range(60):
        simulation.step(0.05)
        frames.append(simulation.episode.actors.rows.tobytes())
    return frames


def test_a_world_on_a_kept_map_is_byte_for_byte_that_on_a_derived_one(tmp_path: Path) -> None:
    keep(tmp_path)
    assert snapshots(MapCache(tmp_path).facts_of(STREET)) == snapshots(derive(STREET))


def test_another_text_is_another_map(tmp_path: Path) -> None:
    keep(tmp_path)
    other = STREET.replace('s="30.0"', 's="29.0"')
    assert_same(MapCache(tmp_path).facts_of(other), derive(other))
    assert len(list(tmp_path.iterdir())) == 2


@pytest.mark.parametrize("what", ["fingerprint", "machine"])
def test_other_sources_or_another_machine_derive_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, what: str
) -> None:
    keep(tmp_path)
    monkeypatch.setattr(map_cache, what, lambda *_: "other")
    MapCache(tmp_path).facts_of(STREET)
    assert len(list(tmp_path.iterdir())) == 2


def test_the_named_sources_derive_the_facts() -> None:
    package = Path(map_cache.__file__).parent.parent
    named = {file for pattern in map_cache._DERIVING for file in package.glob(pattern)}
    for module in (
        "opendrive/mesh.py",
        "opendrive/evaluate/tables.py",
        "opendrive/reading/roads.py",
        "ground.py",
        "archive.py",
    ):
        assert package / "maps" / module in named
    assert package / "geometry.py" in named


def cut(data: bytes) -> bytes:
    return data[: len(data) // 2]


def flip(data: bytes) -> bytes:
    middle = len(data) // 2
    return data[:middle] + bytes([data[middle] ^ 1]) + data[middle + 1 :]


@pytest.mark.parametrize(
    "damage", [cut, flip, lambda _: b"", lambda _: b"no archive", lambda _: pickle.dumps({"planes": 1})]
)
def test_a_broken_file_is_made_anew(
    tmp_path: Path,
    nothing_is_read: Callable[[], None],
    caplog: pytest.LogCaptureFixture,
    damage: Callable[[bytes], bytes],
) -> None:
    file = keep(tmp_path)
    good = file.read_bytes()
    file.write_bytes(damage(good))
    with caplog.at_level(logging.INFO, "linden"):
        assert_same(MapCache(tmp_path).facts_of(STREET), derive(STREET))
    assert "is made anew" in caplog.text
    nothing_is_read()
    MapCache(tmp_path).facts_of(STREET)


@pytest.mark.parametrize("seed", range(40))
def test_a_file_damaged_anywhere_gives_the_same_map(tmp_path: Path, seed: int) -> None:
    random = np.random.default_rng(seed)
    file = keep(tmp_path)
    data = bytearray(file.read_bytes())
    for at in random.integers(len(data), size=3):
        data[at] = random.integers(256)
    file.write_bytes(bytes(data))
    assert_same(MapCache(tmp_path).facts_of(STREET), derive(STREET))


def with_(arrays: dict[str, Any], name: str, change: Callable[[Any], Any]) -> dict[str, Any]:
    return {**arrays, name: change(arrays[name].copy())}


def put(index: Any, value: float) -> Callable[[Any], Any]:
    def change(array: Any) -> Any:
        array[index] = value
        return array

    return change


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("bin_items", put(0, 10**6)),
        ("bin_items", put(0, -1)),
        ("bin_start", put(0, 1)),
        ("bin_start", put(-1, 10**6)),
        ("bin_start", put(1, -5)),
        ("bin_start", lambda array: array[:-1]),
        ("bin_frame", put(3, 1e9)),
        ("bin_frame", put(2, np.nan)),
        ("bin_frame", put(2, -1.0)),
        ("terrain", put((0, 0), np.inf)),
        ("terrain", lambda array: array[:1]),
        ("terrain_frame", put(2, 0.0)),
        ("planes", lambda array: array[:-1]),
        ("planes", lambda array: array.astype(np.float32)),
        ("planes", np.asfortranarray),
        ("lane_of_triangle", put(0, 10**6)),
        ("lane_of_triangle", lambda array: array.astype(np.int64)),
        ("lanes", lambda array: array[:0]),
        ("spawn_points", lambda array: array[:, :5]),
        ("records", lambda array: array[:-1]),
        ("records", lambda _: np.frombuffer(b"{}", np.uint8)),
        ("records", lambda _: np.frombuffer(b"[]", np.uint8)),
    ],
)
def test_arrays_that_a_kernel_could_get_lost_in_are_refused(name: str, change: Callable[[Any], Any]) -> None:
    arrays = pack(derive(STREET))
    unpack(arrays)
    with pytest.raises((ValueError, TypeError)):
        unpack(with_(arrays, name, change))


@pytest.mark.parametrize(
    ("old", "new"),
    [('"7"', "7"), ("true", "1"), ("1.5, 1.0]", "1.5]"), ('[["5"', '[["5", 1'), ('"both"', '["both"]')],
)
def test_records_of_other_types_are_refused(old: str, new: str) -> None:
    arrays = pack(derive(STREET))
    text = arrays["records"].tobytes().decode()
    assert old in text
    with pytest.raises((ValueError, TypeError)):
        unpack({**arrays, "records": np.frombuffer(text.replace(old, new, 1).encode(), np.uint8)})


def test_a_folder_that_cannot_be_written_costs_time_only(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    in_the_way = tmp_path / "cache"
    in_the_way.write_text("a file where the folder should be")
    with caplog.at_level(logging.INFO, "linden"):
        assert_same(MapCache(in_the_way / "maps").facts_of(STREET), derive(STREET))
    assert "cannot be kept" in caplog.text


def test_a_text_that_is_no_map_is_refused_and_not_kept(tmp_path: Path) -> None:
    with pytest.raises(MapError):
        MapCache(tmp_path).facts_of("<OpenDRIVE>")
    assert list(tmp_path.iterdir()) == []


def test_the_maps_used_longest_ago_make_room(tmp_path: Path) -> None:
    first = keep(tmp_path)
    cache = MapCache(tmp_path, most_bytes=int(2.5 * first.stat().st_size))
    second_text, third_text = (STREET.replace('s="30.0"', f's="{s}"') for s in ("29.0", "28.0"))
    cache.facts_of(second_text)
    (second,) = set(tmp_path.iterdir()) - {first}
    os.utime(first, (100.0, 100.0))
    os.utime(second, (200.0, 200.0))
    (tmp_path / "killed.1.part").write_bytes(b"half" * first.stat().st_size)
    os.utime(tmp_path / "killed.1.part", (50.0, 50.0))
    cache.facts_of(STREET)  # so that the first was used after the second
    cache.facts_of(third_text)
    assert first.exists()
    assert not second.exists()
    assert len(list(tmp_path.iterdir())) == 2


def test_the_folder_is_the_one_the_specification_names(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    for setting, folder in (
        (str(tmp_path / "xdg"), tmp_path / "xdg"),
        ("relative/is/ignored", tmp_path / "home" / ".cache"),
        ("", tmp_path / "home" / ".cache"),
    ):
        monkeypatch.setenv("XDG_CACHE_HOME", setting)
        MapCache.of_user().facts_of(STREET)
        assert len(list((folder / "linden" / "maps").glob("*.npz"))) == 1


def test_a_user_without_a_home_gets_a_map_all_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    def nowhere() -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(Path, "home", nowhere)
    assert_same(MapCache.of_user().facts_of(STREET), derive(STREET))


def test_a_library_takes_its_maps_from_the_cache(tmp_path: Path, nothing_is_read: Callable[[], None]) -> None:
    maps, cache = tmp_path / "maps", tmp_path / "cache"
    maps.mkdir()
    (maps / "Street.xodr").write_text(STREET)
    keep(cache)
    nothing_is_read()
    loaded = MapLibrary([maps], MapCache(cache).read).load("Street")
    assert loaded.text == STREET
    assert [signal.signal_id for signal in loaded.signals] == ["7", "8"]


def test_walls_are_kept_by_their_distance(tmp_path: Path, nothing_is_read: Callable[[], None]) -> None:
    cache, road = MapCache(tmp_path), STREET.replace('type="sidewalk"', 'type="driving"')
    first, second = cache.read(road, 1.0), cache.read(road, 2.0)
    assert len(first.wall_feet_m) > 0
    assert first.wall_feet_m.tobytes() != second.wall_feet_m.tobytes()
    assert len(list(tmp_path.iterdir())) == 3  # one file of facts
    nothing_is_read()
    for kept, walls_beyond_m in ((first, 1.0), (second, 2.0)):
        again = cache.read(road, walls_beyond_m)
        assert_same(again.facts, kept.facts)
        assert again.wall_feet_m.tobytes() == read(road, walls_beyond_m).wall_feet_m.tobytes()


def test_walls_at_another_distance_need_no_other_facts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cache, road = MapCache(tmp_path), STREET.replace('type="sidewalk"', 'type="driving"')
    cache.read(road, 1.0)
    expected_m = read(road, 2.0).wall_feet_m
    monkeypatch.setattr("linden.maps.reading.derive", lambda _text: pytest.fail("the facts are derived again"))
    assert cache.read(road, 2.0).wall_feet_m.tobytes() == expected_m.tobytes()


def test_a_file_with_a_good_digest_and_bad_content_is_made_anew(tmp_path: Path) -> None:
    cache = MapCache(tmp_path)
    cache.replace("number", b"not a number")
    assert cache.kept("number", lambda: b"7", int) == 7
    assert cache.kept("number", lambda: b"8", int) == 7


def test_a_folder_that_cannot_be_written_is_spoken_of_once(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    (tmp_path / "file").touch()
    cache = MapCache(tmp_path / "file" / "maps")
    for number in range(3):
        assert cache.kept(f"{number}", lambda: b"7", int) == 7
    assert caplog.text.count("set XDG_CACHE_HOME to a folder that can be written") == 1
