"""A .glb file says what the mesh is, read by an obvious reader of the specification."""

import json
import struct

import numpy as np
import pytest

from linden.protocol.values.enums import SemanticTag
from linden.scenery.gltf import glb
from linden.scenery.mesh import Material, Mesh, join
from linden.scenery.patches import ALL_SIDES, PatchFrames, PatchLook, boxes

FRAMES = PatchFrames(np.array([[1000.0, -2000.0, 250.0]]), np.array([0.4]))
SIZES = {5126: np.float32, 5125: np.uint32, 5123: np.uint16}
WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}


@pytest.fixture
def mesh() -> Mesh:
    tag = SemanticTag.STATIC
    red = boxes(FRAMES, (0.0, 0.0, 1.0), (2.0, 1.0, 1.0), PatchLook(Material.BRICK, tag, (255, 0, 0)), ALL_SIDES)
    grey = boxes(FRAMES, (9.0, 0.0, 1.0), (1.0, 1.0, 1.0), PatchLook(Material.METAL, tag, (188, 188, 188)), ALL_SIDES)
    return join([red, grey])


def read(content: bytes) -> tuple[dict, list[dict[str, np.ndarray]]]:
    magic, version, length = struct.unpack_from("<III", content)
    assert (magic, version, length) == (0x46546C67, 2, len(content))
    size, kind = struct.unpack_from("<II", content, 12)
    assert kind == 0x4E4F534A
    document = json.loads(content[20 : 20 + size])
    binary_size, kind = struct.unpack_from("<II", content, 20 + size)
    assert (kind, binary_size, document["buffers"][0]["byteLength"]) == (
        0x004E4942,
        len(content) - 28 - size,
        binary_size,
    )
    binary = content[28 + size :]

    def values(number: int) -> np.ndarray:
        accessor = document["accessors"][number]
        view = document["bufferViews"][accessor["bufferView"]]
        wide = WIDTHS[accessor["type"]]
        found = np.frombuffer(
            binary, SIZES[accessor["componentType"]], accessor["count"] * wide, view["byteOffset"]
        ).reshape(-1, wide)
        if "min" in accessor:
            assert found.min(axis=0).tolist() == accessor["min"]
            assert found.max(axis=0).tolist() == accessor["max"]
        return found

    parts = [
        {name: values(number) for name, number in {**part["attributes"], "indices": part["indices"]}.items()}
        for part in document["meshes"][0]["primitives"]
    ]
    return document, parts


def test_a_part_for_each_material_with_all_its_triangles(mesh: Mesh) -> None:
    document, parts = read(glb(mesh, "two boxes"))
    assert [material["name"] for material in document["materials"]] == ["brick", "metal"]
    assert [len(part["indices"]) for part in parts] == [36, 36]
    assert document["scenes"][0]["name"] == document["nodes"][0]["name"] == "two boxes"


def test_places_are_east_up_south_and_triangles_still_look_outwards(mesh: Mesh) -> None:
    document, parts = read(glb(mesh, "two boxes"))
    origin = document["nodes"][0]["translation"]
    for part, (low, high) in zip(parts, ((250.0, 252.0), (250.0, 252.0)), strict=True):
        places = part["POSITION"].astype(np.float64) + origin
        assert (places[:, 1].min(), places[:, 1].max()) == pytest.approx((low, high))
        assert np.abs(places[:, 2] + 2000.0).max() < 12.0
        a, b, c = (part["POSITION"].astype(np.float64)[part["indices"].reshape(-1, 3)[:, k]] for k in range(3))
        assert np.einsum("ij,ij->i", a, np.cross(b, c)).sum() > 0.0


def test_colours_are_linear(mesh: Mesh) -> None:
    _, (brick, metal) = read(glb(mesh, "two boxes"))
    assert (brick["COLOR_0"] == (65535, 0, 0, 65535)).all()
    assert metal["COLOR_0"][0, 0] / 65535 == pytest.approx(0.5029, abs=1e-3)  # of 188 of 255
