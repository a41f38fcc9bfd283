"""The scene of a map: its tiles, out of the user's cache or made once, and an outline of its roads for plain maps."""

import gzip
import hashlib
import json
from dataclasses import dataclass, field
from functools import cache as once
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import linden
from linden.compiled import fingerprint, machine
from linden.maps.cache import MapCache
from linden.maps.library import LoadedMap
from linden.maps.opendrive.parse import parse
from linden.scenery.map_mesh_cache import standing_of
from linden.scenery.scene.objects import ObjectKind
from linden.scenery.scene.objects import Scene as Things
from linden.scenery.streets.simplified_lanes import simplified_lanes
from linden.simulation.surroundings import scenery_of
from linden_window.tiles import GZIP_LEVEL, tiles_of

_HEAD_DIGITS = 16
"""Digits before the index that say how long it is."""
_OUTLINE_STEP_M = 0.1


class MapText(NamedTuple):
    """A map as a source of frames names it."""

    name: str
    text: str


@dataclass(frozen=True)
class Scene:
    """What the page draws of a map.

    Attributes:
        map_name: without a folder.
        tiles: files by their names.
        index: what the page reads first: boxes of tiles, lights, outline of roads.
    """

    map_name: str
    tiles: dict[str, bytes]
    index: dict[str, Any] = field(default_factory=dict)


def scene_of(world: MapText, cache: MapCache) -> Scene:
    """Return the scene of a map.

    Raises:
        UserError: the text is no OpenDRIVE that can be used.
    """
    return _read(world.name, cache.kept(_name(world), lambda: _made(world, cache), bytes))


def is_kept(world: MapText, cache: MapCache) -> bool:
    """Return whether the scene is in the cache."""
    return cache.has(_name(world))


def _name(world: MapText) -> str:
    digest = hashlib.sha256(f"{_sources()} {machine()} {world.name}\n{world.text}".encode())
    return f"{digest.hexdigest()[:32]}.window"


@once
def _sources() -> int:
    package = Path(linden.__file__).parent
    making = ("scenery/**/*.py", "maps/*.py", "maps/opendrive/**/*.py", "simulation/surroundings.py", "geometry.py")
    files = [file for pattern in making for file in package.glob(pattern)]
    return fingerprint(*files, Path(__file__), Path(__file__).with_name("tiles.py"))


def _made(world: MapText, cache: MapCache) -> bytes:
    """Return the length of the index, the index as JSON, and the files one after the other."""
    world_map = LoadedMap(name=world.name, text=world.text, **vars(cache.facts_of(world.text)))
    things = scenery_of(world_map).scene
    mesh = standing_of(world_map, things, cache)
    tiles = tiles_of(mesh)
    outline = gzip.compress(json.dumps(_outline(world.text), separators=(",", ":")).encode(), GZIP_LEVEL, mtime=0)
    index = {
        "tiles": [{"name": tile.name, "low": tile.low_m, "high": tile.high_m} for tile in tiles],
        "triangles": len(mesh.triangles),
        "spawn_points": [(*spawn.location, spawn.rotation.yaw) for spawn in world_map.spawn_points],
        "signals": [signal.signal_id for signal in world_map.signals if signal.is_light],
        **_switched(things),
    }
    files = {**{tile.name: tile.content for tile in tiles}, "outline.json": outline}
    head = json.dumps({"index": index, "sizes": {name: len(content) for name, content in files.items()}}).encode()
    return b"".join([f"{len(head):{_HEAD_DIGITS}}".encode(), head, *files.values()])


def _read(map_name: str, content: bytes) -> Scene:
    at = _HEAD_DIGITS + int(content[:_HEAD_DIGITS])
    head = json.loads(content[_HEAD_DIGITS:at])
    tiles = {}
    for name, size in head["sizes"].items():
        tiles[name] = content[at : at + size]
        at += size
    return Scene(map_name, tiles, head["index"])


def _switched(things: Things) -> dict[str, Any]:
    """Return the boxes of traffic lights and street lamps, each as (box, number of the light or lamp)."""
    kinds = things.things["kind"]
    thing = things.boxes["thing"]
    kind_of_box = kinds[thing]
    number_of = np.zeros(len(kinds), np.int64)
    for kind in (ObjectKind.TRAFFIC_LIGHT, ObjectKind.STREET_LAMP):
        number_of[kinds == kind] = np.arange((kinds == kind).sum())
    return {
        name: [(box, int(number_of[thing[box]])) for box in np.flatnonzero(kind_of_box == kind).tolist()]
        for name, kind in (("lights", ObjectKind.TRAFFIC_LIGHT), ("lamps", ObjectKind.STREET_LAMP))
    }


def _outline(text: str) -> list[list[float]]:
    """Return the outer edges of all lanes as lists of x, y, x, y ... in m, for a page that draws no triangles."""
    lanes = simplified_lanes(parse(text))
    ends = np.flatnonzero(~lanes.continues)
    edges = np.round(lanes.outer[:, :2] / _OUTLINE_STEP_M) * _OUTLINE_STEP_M
    return [
        [round(value, 1) for value in line.reshape(-1).tolist()]
        for line in np.split(edges, ends[:-1] + 1 if len(ends) else [])
        if len(line) > 1
    ]
