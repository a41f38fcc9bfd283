"""A mesh as binary glTF 2.0 (Khronos 2021), which any viewer of three-dimensional scenes opens.

Frame of the file: x east, y up, z south, metres, from an origin near the mesh's middle, so that single precision lasts.
Colours are kept at the corners, one part for each material.
"""

import json
import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from linden.scenery.mesh import Material, Mesh

_MAGIC, _VERSION, _JSON, _BIN = 0x46546C67, 2, 0x4E4F534A, 0x004E4942
FLOAT, UNSIGNED_INT, _UNSIGNED_SHORT = 5126, 5125, 5123
ARRAY, ELEMENTS = 34962, 34963
_ROUGHNESS = {Material.GLASS: 0.1, Material.CAR_PAINT: 0.3, Material.METAL: 0.4, Material.LAMP: 0.5}
_ROUGH = 0.9
_AXES = [0, 2, 1]  # of ours that are x, y, z of the file
_METALLIC = {Material.METAL: 0.8}


def glb(mesh: Mesh, name: str) -> bytes:
    """Return the bytes of a .glb file of one mesh, which has a triangle at least."""
    buffer = Buffer()
    origin = mesh.vertices_m.astype(np.float64).mean(axis=0).round()
    kinds = [Material(kind) for kind in np.unique(mesh.faces["material"]).tolist()]
    primitives = [_primitive(mesh, kind, number, origin, buffer) for number, kind in enumerate(kinds)]
    document = {
        "asset": {"version": "2.0", "generator": "linden map export"},
        "scene": 0,
        "scenes": [{"nodes": [0], "name": name}],
        "nodes": [{"mesh": 0, "name": name, "translation": [float(origin[axis]) for axis in _AXES]}],
        "meshes": [{"primitives": primitives, "name": name}],
        "materials": [material_of(kind) for kind in kinds],
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [{"byteLength": buffer.size}],
    }
    return file_of(document, b"".join(buffer.parts))


class Buffer:
    """What goes into the binary part, and how the document describes it."""

    def __init__(self) -> None:
        self.parts: list[bytes] = []
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []
        self.size = 0

    def add(self, values: NDArray[Any], component: int, kind: str, target: int, **more: Any) -> int:  # noqa: ANN401 - members of an accessor
        """Keep an array and return the number of its accessor."""
        data = np.ascontiguousarray(values).tobytes()
        padded = data + b"\0" * (-len(data) % 4)
        self.views.append({"buffer": 0, "byteOffset": self.size, "byteLength": len(data), "target": target})
        self.accessors.append(
            {
                "bufferView": len(self.views) - 1,
                "componentType": component,
                "count": len(values),
                "type": kind,
                **more,
            }
        )
        self.parts.append(padded)
        self.size += len(padded)
        return len(self.accessors) - 1


def _primitive(mesh: Mesh, kind: Material, number: int, origin: NDArray[np.float64], buffer: Buffer) -> dict[str, Any]:
    """Return the part of the mesh that is made of one material."""
    rows = np.flatnonzero(mesh.faces["material"] == kind)
    used, numbers = np.unique(mesh.triangles[rows], return_inverse=True)
    places = (mesh.vertices_m[used] - origin)[:, _AXES].astype(np.float32)
    colours = np.zeros((len(used), 3))
    corners = numbers.reshape(-1, 3)
    colours[corners] = (mesh.faces["colour"][rows] / 255.0)[:, None, :]
    linear = np.where(colours <= 0.04045, colours / 12.92, ((colours + 0.055) / 1.055) ** 2.4)  # IEC 61966-2-1
    coded = np.round(np.column_stack([linear, np.ones(len(linear))]) * 65535.0).astype(np.uint16)
    bounds = {"min": places.min(axis=0).tolist(), "max": places.max(axis=0).tolist()}
    return {
        "attributes": {
            "POSITION": buffer.add(places, FLOAT, "VEC3", ARRAY, **bounds),
            "COLOR_0": buffer.add(coded, _UNSIGNED_SHORT, "VEC4", ARRAY, normalized=True),
        },
        # two axes have changed places, so what was wound one way is wound the other
        "indices": buffer.add(corners[:, [0, 2, 1]].astype(np.uint32).reshape(-1), UNSIGNED_INT, "SCALAR", ELEMENTS),
        "material": number,
    }


def material_of(kind: Material) -> dict[str, Any]:
    """Return the document's entry for a material."""
    return {
        "name": kind.name.lower(),
        "doubleSided": True,
        "pbrMetallicRoughness": {
            "metallicFactor": _METALLIC.get(kind, 0.0),
            "roughnessFactor": _ROUGHNESS.get(kind, _ROUGH),
        },
    }


def file_of(document: dict[str, Any], binary: bytes) -> bytes:
    """Return header, document and binary part, each padded to four bytes (section 4.4 of the specification)."""
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), _JSON) + text + struct.pack("<II", len(binary), _BIN) + binary
    return struct.pack("<III", _MAGIC, _VERSION, 12 + len(chunks)) + chunks
