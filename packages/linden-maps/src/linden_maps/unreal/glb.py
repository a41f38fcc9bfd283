"""Parts of a map as binary glTF 2.0: metres, y up, one node for each part, one primitive for each material."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from linden.scenery.gltf import ARRAY, ELEMENTS, FLOAT, UNSIGNED_INT, Buffer, file_of, material_of
from linden_maps.unreal.parts import Part, PartMaterial

_AXES, _SIGNS = [0, 2, 1], (1.0, 1.0, -1.0)  # of ours that are x, y, z of the file: east, up, south


def glb(parts: Sequence[Part], name: str) -> bytes:
    """Return the bytes of a .glb file; equal parts give equal bytes."""
    buffer = Buffer()
    surfaces = sorted({surface for part in parts for surface in part.surfaces})
    rows = {surface: row for row, surface in enumerate(surfaces)}
    nodes: list[dict[str, Any]] = []
    meshes: list[dict[str, Any]] = []
    for part in parts:
        origin = np.round(part.vertices_m.mean(axis=0))  # so that single precision lasts
        moved = (origin[_AXES] * _SIGNS).tolist()
        nodes.append({"mesh": len(meshes), "name": part.name, "translation": moved})
        primitives = [
            _primitive(part, row, origin, buffer) | {"material": rows[surface]}
            for row, surface in enumerate(part.surfaces)
        ]
        meshes.append({"primitives": primitives, "name": part.name})
    document = {
        "asset": {"version": "2.0", "generator": "linden map package"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(nodes))), "name": name}],
        "nodes": nodes,
        "meshes": meshes,
        "materials": [_material(surface) for surface in surfaces],
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [{"byteLength": buffer.size}],
    }
    return file_of(document, b"".join(buffer.parts))


def _primitive(part: Part, row: int, origin: np.ndarray[Any, np.dtype[np.float64]], buffer: Buffer) -> dict[str, Any]:
    """Return the triangles of one material; corners are not shared, since normals are flat."""
    chosen = np.flatnonzero(part.surface == row)
    corners = (part.vertices_m[part.triangles[chosen]].reshape(-1, 3) - origin)[:, _AXES] * _SIGNS
    places = corners.astype(np.float32)
    normals = np.repeat(part.normals[chosen], 3, axis=0)[:, _AXES] * _SIGNS
    texture = part.uv_m[chosen].reshape(-1, 2) * (1.0, -1.0)  # the file's v runs downwards
    bounds = {"min": places.min(axis=0).tolist(), "max": places.max(axis=0).tolist()}
    numbers = np.arange(len(places), dtype=np.uint32)
    return {
        "attributes": {
            "POSITION": buffer.add(places, FLOAT, "VEC3", ARRAY, **bounds),
            "NORMAL": buffer.add(normals.astype(np.float32), FLOAT, "VEC3", ARRAY),
            "TEXCOORD_0": buffer.add(texture.astype(np.float32), FLOAT, "VEC2", ARRAY),
        },
        "indices": buffer.add(numbers, UNSIGNED_INT, "SCALAR", ELEMENTS),
    }


def _material(surface: PartMaterial) -> dict[str, Any]:
    found = material_of(surface.kind)
    linear = [round((value / 255.0) ** 2.2, 6) for value in surface.colour]
    found["name"] = surface.name
    found["pbrMetallicRoughness"]["baseColorFactor"] = [*linear, 1.0]
    return found
