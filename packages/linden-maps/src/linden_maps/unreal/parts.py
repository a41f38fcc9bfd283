"""A map's mesh in parts: one for each semantic group and tile, with flat normals, texture coordinates and materials.

Frame: OpenDRIVE's (x east, y north, z up), metres. CARLA's importer moves a mesh into the folder of its semantic class
by the mesh's name (MoveAssetsCommandlet.cpp: ``Road_Road``, ``Road_Marking``, ``Road_Sidewalk``, ``Road_Curb``,
``Terrain``), which are RoadRunner's names; it leaves other groups where they are.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.protocol.values.enums import SemanticTag
from linden.scenery.mesh import Material, Mesh
from linden.scenery.scene.objects import ObjectKind, Scene
from linden.scenery.streets.road import KERB_STONE

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

TILE_M = 500.0
GROUP_OF_TAG = {
    SemanticTag.ROADS: "Road_Road",
    SemanticTag.ROAD_LINES: "Road_Marking",
    SemanticTag.SIDEWALKS: "Road_Sidewalk",
    SemanticTag.TERRAIN: "Terrain",
    SemanticTag.GROUND: "Terrain",
    SemanticTag.BUILDINGS: "Building",
    SemanticTag.WALLS: "Wall",
    SemanticTag.FENCES: "Fence",
    SemanticTag.POLES: "Pole",
    SemanticTag.TRAFFIC_SIGNS: "TrafficSign",
    SemanticTag.VEGETATION: "Vegetation",
    SemanticTag.CAR: "Car",
    SemanticTag.RAIL_TRACK: "RailTrack",
}
OTHER_GROUP = "Static"
CURB_GROUP = "Road_Curb"
FOLDER_OF_GROUP = {
    "Road_Road": "Road",
    "Road_Marking": "RoadLines",
    "Road_Sidewalk": "SideWalk",
    "Road_Curb": "SideWalk",
    "Terrain": "Terrain",
    "Building": "Building",
    "Wall": "Wall",
    "Fence": "Fence",
    "Pole": "Pole",
    "TrafficSign": "TrafficSign",
    "Vegetation": "Vegetation",
    "Car": "Car",
    "RailTrack": "RailTrack",
    "Static": "Static",
}
"""The folder ``Static/<folder>`` from which CARLA 0.9.16 takes a mesh's semantic class (Tagger.cpp)."""

BY_CARLA = frozenset({ObjectKind.TRAFFIC_LIGHT, ObjectKind.TRAFFIC_SIGN})
"""What CARLA itself puts on a map, from the signals of its OpenDRIVE; no part shows it twice."""

MOST_COLOURS = 8
"""Of one material in one group; rarer colours become the nearest of these. Each is a slot in Unreal."""


class PartMaterial(NamedTuple):
    """A material of a part: its name, its kind, and its colour in sRGB, 0 to 255."""

    name: str
    kind: Material
    colour: tuple[int, int, int]


class Part(NamedTuple):
    """The triangles of one group in one tile.

    ``normals`` (T, 3) are those of the triangles; ``uv_m`` (T, 3, 2) of their corners, in metres along the surface;
    ``surface`` (T,) are rows of ``surfaces``.
    """

    name: str
    group: str
    tile: tuple[int, int]
    vertices_m: F64
    triangles: I64
    normals: F64
    uv_m: F64
    surface: I64
    surfaces: tuple[PartMaterial, ...]


def parts_of(mesh: Mesh, scene: Scene, name: str, tile_m: float = TILE_M) -> list[Part]:
    """Return the parts of a map's mesh, groups in the order of their names, tiles from the south-west."""
    vertices = mesh.vertices_m.astype(np.float64) * (1.0, -1.0, 1.0)
    triangles = mesh.triangles.astype(np.int64)[:, [0, 2, 1]]  # one axis is mirrored, so what winds turns round
    wanted = _not_by_carla(mesh, scene)
    corners = vertices[triangles]
    doubled = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(doubled, axis=1)
    rows = np.flatnonzero(wanted & (area > 1e-9))
    tiles = np.floor(corners[rows].mean(axis=1)[:, :2] / tile_m).astype(np.int64)
    groups = _groups(mesh)[rows]
    names = np.array(sorted({*FOLDER_OF_GROUP}))
    found = []
    for group, tile, chosen in _each(groups, tiles):
        part_rows = rows[chosen]
        normals = doubled[part_rows] / area[part_rows, None]
        used, local = np.unique(triangles[part_rows], return_inverse=True)
        surfaces, surface = _surfaces(mesh, part_rows, str(names[group]))
        found.append(
            Part(
                f"{name}_{names[group]}_{_signed(tile[0])}_{_signed(tile[1])}",
                str(names[group]),
                tile,
                vertices[used],
                local.reshape(-1, 3),
                normals,
                _texture_m(corners[part_rows], normals),
                surface,
                surfaces,
            )
        )
    return found


def _signed(number: int) -> str:
    """Return a tile's number as a part of a name; Unreal allows no minus sign there."""
    return f"m{-number}" if number < 0 else str(number)


def _not_by_carla(mesh: Mesh, scene: Scene) -> NDArray[np.bool_]:
    numbers = mesh.faces["object"]
    things = scene.boxes["thing"][np.maximum(numbers, 0)] if len(scene.boxes) else np.zeros(len(numbers), np.int64)
    kinds = scene.things["kind"][things] if len(scene.things) else np.zeros(len(numbers), np.uint8)
    found: NDArray[np.bool_] = (numbers < 0) | ~np.isin(kinds, [int(kind) for kind in BY_CARLA])
    return found


def _groups(mesh: Mesh) -> I64:
    """Return for each triangle the row of its group in the sorted names of all groups."""
    names = sorted({*FOLDER_OF_GROUP})
    of_tag = np.full(256, names.index(OTHER_GROUP), np.int64)
    for tag, group in GROUP_OF_TAG.items():
        of_tag[int(tag)] = names.index(group)
    groups: I64 = of_tag[mesh.faces["tag"]]
    is_kerb = (mesh.faces["colour"] == np.array(KERB_STONE, np.uint8)).all(axis=1)
    groups[is_kerb & (mesh.faces["tag"] == int(SemanticTag.SIDEWALKS))] = names.index(CURB_GROUP)
    return groups


def _each(groups: I64, tiles: I64) -> Iterator[tuple[int, tuple[int, int], I64]]:
    """Yield group, tile and the rows of both, in order."""
    if not len(groups):
        return
    keys = np.column_stack([groups, tiles[:, 1], tiles[:, 0]])
    distinct, inverse = np.unique(keys, axis=0, return_inverse=True)
    order = np.argsort(inverse.reshape(-1), kind="stable")
    ends = np.cumsum(np.bincount(inverse.reshape(-1), minlength=len(distinct)))
    for row, (group, north, east) in enumerate(distinct.tolist()):
        begin = ends[row - 1] if row else 0
        yield group, (east, north), order[begin : ends[row]]


def _surfaces(mesh: Mesh, rows: I64, group: str) -> tuple[tuple[PartMaterial, ...], I64]:
    """Return the materials of a part, and for each triangle its row."""
    kinds = mesh.faces["material"][rows]
    colours = mesh.faces["colour"][rows].astype(np.int64)
    surface = np.zeros(len(rows), np.int64)
    surfaces: list[PartMaterial] = []
    for kind in np.unique(kinds).tolist():
        chosen = np.flatnonzero(kinds == kind)
        distinct, count = np.unique(colours[chosen], axis=0, return_counts=True)
        kept = distinct[np.lexsort((distinct[:, 2], distinct[:, 1], distinct[:, 0], -count))[:MOST_COLOURS]]
        apart = ((colours[chosen][:, None, :] - kept[None]) ** 2).sum(axis=2)
        surface[chosen] = len(surfaces) + apart.argmin(axis=1)
        for red, green, blue in kept.tolist():
            name = f"M_{group}_{Material(kind).name.title().replace('_', '')}_{red:02x}{green:02x}{blue:02x}"
            surfaces.append(PartMaterial(name, Material(kind), (red, green, blue)))
    return tuple(surfaces), surface


def _texture_m(corners: F64, normals: F64) -> F64:
    """Return texture coordinates in metres: the places of the corners along the two axes that face the viewer."""
    facing = np.abs(normals).argmax(axis=1)
    first = np.where(facing == 0, 1, 0)
    second = np.where(facing == 2, 1, 2)
    rows = np.arange(len(corners))[:, None]
    sides = np.arange(3)[None, :]
    return np.stack([corners[rows, sides, first[:, None]], corners[rows, sides, second[:, None]]], axis=2)
