"""Claims about the tiles of a map: what a reader of glTF finds in them is the mesh."""

import gzip
import json
import struct

import numpy as np
import pytest

from linden.scenery.mesh import LampOf, Material, Mesh, faces
from linden_window.tiles import TILE_M, linear, tiles_of

TYPES = {5123: np.uint16, 5125: np.uint32, 5126: np.float32}


def triangles_of(content: bytes) -> np.ndarray:
    """Read a file as glTF's specification says: corners (T, 3, 3) in CARLA's axes."""
    data = gzip.decompress(content)
    size = struct.unpack_from("<I", data, 12)[0]
    document, binary = json.loads(data[20 : 20 + size]), data[28 + size :]

    def column(number: int) -> np.ndarray:
        accessor = document["accessors"][number]
        view = document["bufferViews"][accessor["bufferView"]]
        kind, width = TYPES[accessor["componentType"]], {"SCALAR": 1, "VEC2": 2, "VEC3": 3}[accessor["type"]]
        stride = view.get("byteStride", width * kind().itemsize) // kind().itemsize
        values = np.frombuffer(binary, kind, accessor["count"] * stride, view["byteOffset"])
        return values.reshape(-1, stride)[:, :width]

    node = document["nodes"][0]
    found = []
    for primitive in document["meshes"][0]["primitives"]:
        places = column(primitive["attributes"]["POSITION"]) * node["scale"] + node["translation"]
        found.append(places[column(primitive["indices"])[:, 0].astype(int)].reshape(-1, 3, 3)[..., [0, 2, 1]])
    return np.concatenate(found)


@pytest.fixture
def mesh() -> Mesh:
    """Small triangles over several tiles, and one larger than a tile."""
    draw = np.random.default_rng(5)
    middle = draw.uniform(-2.0 * TILE_M, 2.0 * TILE_M, (500, 1, 3)) * (1.0, 1.0, 0.02)
    corners = np.concatenate(
        [middle + draw.uniform(-3.0, 3.0, (500, 3, 3)), [[[-900, 0, 0], [900, 0, 0], [0, 900, 0]]]]
    )
    made = faces(501, Material.GRASS, 10, (90, 120, 60))
    made["material"][::3], made["colour"][::2] = Material.GLASS, (10, 20, 30)
    return Mesh(corners.reshape(-1, 3).astype(np.float32), np.arange(1503, dtype=np.uint32).reshape(-1, 3), made)


def test_the_tiles_hold_every_triangle_once_within_their_quantisation(mesh: Mesh) -> None:
    found = np.concatenate([triangles_of(tile.content) for tile in tiles_of(mesh)])
    assert len(found) == len(mesh.triangles)
    wanted = mesh.vertices_m[mesh.triangles].mean(axis=1)
    distance = np.linalg.norm(found.mean(axis=1)[:, None] - wanted[None], axis=2)
    assert distance.min(axis=1).max() < 0.03
    assert len(np.unique(distance.argmin(axis=1))) == len(wanted)


def test_triangles_face_the_same_way_for_the_reader(mesh: Mesh) -> None:
    single = Mesh(mesh.vertices_m, mesh.triangles[:1], mesh.faces[:1])
    (found,) = triangles_of(tiles_of(single)[0].content)
    a, b, c = mesh.vertices_m[mesh.triangles[0]]
    way = np.cross(found[1] - found[0], found[2] - found[0])  # y and z have changed places and the order with them
    assert np.dot(way, np.cross(b - a, c - a)) < 0.0


def test_tiles_do_not_mix_what_lies_far_apart(mesh: Mesh) -> None:
    tiles = tiles_of(mesh)
    small = [tile for tile in tiles if tile.high_m[0] - tile.low_m[0] < 2 * TILE_M]
    assert len(tiles) - len(small) == 1
    assert len(small) >= 16


def test_equal_meshes_give_equal_bytes(mesh: Mesh) -> None:
    assert [tile.content for tile in tiles_of(mesh)] == [tile.content for tile in tiles_of(mesh)]


def test_lamps_name_their_light_and_their_box() -> None:
    made = faces(1, Material.LAMP, 7, (255, 0, 0))
    made["lamp"], made["object"] = LampOf.TRAFFIC_RED, 41
    mesh = Mesh(np.eye(3, dtype=np.float32), np.array([[0, 1, 2]], np.uint32), made)
    data = gzip.decompress(tiles_of(mesh)[0].content)
    size = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20 : 20 + size])
    accessor = document["accessors"][document["meshes"][0]["primitives"][0]["attributes"]["_LAMP"]]
    view = document["bufferViews"][accessor["bufferView"]]
    values = np.frombuffer(data[28 + size :], np.float32, 6, view["byteOffset"])
    assert values.reshape(-1, 2).tolist() == [[LampOf.TRAFFIC_RED, 42.0]] * 3


def test_colours_are_linear_light() -> None:
    assert linear(np.array([0, 255])).tolist() == [0, 65535]
    assert linear(np.array([128]))[0] / 65535.0 == pytest.approx(0.2158, abs=1e-3)
