"""The scenery of a map as tiles in glTF 2.0 with quantised attributes (KHR_mesh_quantization), compressed by gzip.

Frame of the files: x east, y up, z south, metres, like :mod:`linden.scenery.gltf`. A tile has up to four primitives:
rough and smooth surfaces, windows of houses, and lamps. Vertices of lamps carry the light and the box that they belong
to, so that the page can switch them. Triangles larger than a tile go into one base tile with single precision.
"""

import gzip
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.scenery.gltf import ARRAY, ELEMENTS, FLOAT, UNSIGNED_INT, Buffer, file_of
from linden.scenery.mesh import LampOf, Material, Mesh
from linden.structured import StructuredArray

TILE_M = 256.0
"""Edge of a tile: 4 mm of quantisation, and some 60 tiles of Linden's streets."""
_LARGE_M = 64.0
"""Triangles with a longer side belong to the base tile."""
_UNSIGNED_SHORT = 5123
_STEPS = 65535.0
_AXES = [0, 2, 1]
_SMOOTH = (Material.GLASS, Material.CAR_PAINT, Material.METAL)
GZIP_LEVEL = 5
"""A higher level makes the files of Linden 2 % smaller and takes twice the time."""


class Tile(NamedTuple):
    """A file and the box that its triangles fill, in CARLA's axes, m."""

    name: str
    content: bytes
    low_m: tuple[float, float, float]
    high_m: tuple[float, float, float]


class _Look(NamedTuple):
    name: str
    roughness: float
    metallic: float


_LOOKS = (
    _Look("rough", 0.95, 0.0),
    _Look("smooth", 0.35, 0.1),
    _Look("window", 0.2, 0.1),
    _Look("lamp", 0.5, 0.0),
    _Look("painted", 0.35, 0.1),
)
"""Kinds of surfaces in the order of :func:`looks_of`. The page changes window, lamp and painted."""


def looks_of(faces: StructuredArray) -> NDArray[np.int64]:
    """Return the row of ``_LOOKS`` (T,) of each face."""
    look = np.isin(faces["material"], _SMOOTH).astype(np.int64)
    look[faces["lamp"] == LampOf.WINDOW] = 2
    look[(faces["lamp"] != LampOf.NONE) & (faces["lamp"] != LampOf.WINDOW)] = 3
    look[faces["painted"]] = 4
    return look


def tiles_of(mesh: Mesh) -> list[Tile]:
    """Return the tiles of a map's mesh; equal meshes give equal bytes."""
    corners = mesh.vertices_m[mesh.triangles]
    is_large = (corners.max(axis=1) - corners.min(axis=1)).max(axis=1) > _LARGE_M
    cell = np.floor(corners.mean(axis=1)[:, :2] / TILE_M).astype(np.int64)
    key = np.where(is_large, np.iinfo(np.int64).min, cell[:, 0] * 1_000_003 + cell[:, 1])
    order = np.argsort(key, kind="stable")
    starts = np.flatnonzero(np.r_[True, np.diff(key[order]) != 0]) if len(order) else np.zeros(0, np.int64)
    tiles = []
    for number, rows in enumerate(np.split(order, starts[1:]) if len(order) else []):
        part = corners[rows]
        low, high = part.min(axis=(0, 1)), part.max(axis=(0, 1))
        content = gzip.compress(tile_file(part, mesh.faces[rows], f"tile {number}"), GZIP_LEVEL, mtime=0)
        tiles.append(Tile(f"tile-{number}.glb", content, _place(low), _place(high)))
    return tiles


def tile_file(corners_m: NDArray[np.float32], faces: StructuredArray, name: str) -> bytes:
    """Return the bytes of a .glb file of triangles (T, 3, 3) with their faces (T,)."""
    buffer = Buffer()
    low, scale = quantisation(corners_m)
    primitives, looks = surfaces(buffer, corners_m, faces, low, scale)
    node = {
        "mesh": 0,
        "name": name,
        "translation": [float(low[axis]) for axis in _AXES],
        "scale": [scale] * 3,
    }
    return document_of(buffer, [node], [{"primitives": primitives}], looks)


def quantisation(corners_m: NDArray[np.float32]) -> tuple[NDArray[np.float64], float]:
    """Return the lowest corner (3,) of triangles (T, 3, 3) and the size of a step that covers them, m."""
    low = corners_m.min(axis=(0, 1)).astype(np.float64)
    return low, float((corners_m.max(axis=(0, 1)) - low).max()) / _STEPS or 1.0


def surfaces(
    buffer: Buffer, corners_m: NDArray[np.float32], faces: StructuredArray, low: NDArray[np.float64], scale: float
) -> tuple[list[dict[str, Any]], list[int]]:
    """Return the primitives of triangles, quantised from ``low`` in steps of ``scale``, and the rows of their looks."""
    steps = np.rint((corners_m - low) / scale).clip(0, _STEPS).astype(np.uint64)
    looks, primitives, used = looks_of(faces), list[dict[str, Any]](), list[int]()
    for look in np.unique(looks).tolist():
        rows = np.flatnonzero(looks == look)
        primitives.append(_primitive(buffer, steps[rows], faces[rows], is_lamp=look == 3) | {"material": len(used)})
        used.append(look)
    return primitives, used


def document_of(buffer: Buffer, nodes: list[dict[str, Any]], meshes: list[dict[str, Any]], looks: list[int]) -> bytes:
    """Return a file with these nodes; ``looks`` are the rows of its materials."""
    document = {
        "asset": {"version": "2.0", "generator": "linden window"},
        "extensionsUsed": ["KHR_mesh_quantization"],
        "extensionsRequired": ["KHR_mesh_quantization"],
        "scene": 0,
        "scenes": [{"nodes": list(range(len(nodes)))}],
        "nodes": nodes,
        "meshes": meshes,
        "materials": [_material(_LOOKS[look]) for look in looks],
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [{"byteLength": buffer.size}],
    }
    return file_of(document, b"".join(buffer.parts))


def _primitive(buffer: Buffer, steps: NDArray[np.uint64], faces: StructuredArray, *, is_lamp: bool) -> dict[str, Any]:
    """Return one look's triangles; corners of one place and colour, and of one lamp, are one vertex."""
    marks = faces["lamp"].astype(np.uint64) << np.uint64(32) | (faces["object"].astype(np.int64) + 1).astype(np.uint64)
    told, told_row = np.unique(
        np.column_stack([faces["colour"].astype(np.uint64), marks if is_lamp else np.zeros_like(marks)]),
        axis=0, return_inverse=True,
    )  # fmt: skip
    packed = (steps[..., 0] << np.uint64(16) | steps[..., 1]) << np.uint64(16) | steps[..., 2]
    pairs = np.empty((*packed.shape, 2), np.uint64)
    pairs[..., 0], pairs[..., 1] = packed, told_row.reshape(-1, 1)
    flat = np.ascontiguousarray(pairs.reshape(-1, 2)).view([("place", "<u8"), ("told", "<u8")]).reshape(-1)
    order = np.lexsort((flat["told"], flat["place"]))
    ordered = flat[order]
    is_new = np.r_[True, ordered[1:] != ordered[:-1]]
    numbers: NDArray[np.uint32] = np.empty(len(flat), np.uint32)
    numbers[order] = np.cumsum(is_new) - 1
    numbers, vertices = _in_order_of_use(numbers, ordered[is_new])
    places = np.zeros((len(vertices), 4), np.uint16)
    for column, shift in enumerate((32, 0, 16)):  # x, z, y: the file's axes
        places[:, column] = vertices["place"] >> np.uint64(shift) & np.uint64(0xFFFF)
    colours = np.zeros((len(vertices), 4), np.uint16)
    colours[:, :3] = linear(told[vertices["told"], :3])
    bounds = {"min": places[:, :3].min(axis=0).tolist(), "max": places[:, :3].max(axis=0).tolist()}
    attributes = {
        "POSITION": _add_padded(buffer, places, _UNSIGNED_SHORT, normalized=False, **bounds),
        "COLOR_0": _add_padded(buffer, colours, _UNSIGNED_SHORT, normalized=True),
    }
    if is_lamp:
        mark = told[vertices["told"], 3]
        lamps = np.column_stack([mark >> np.uint64(32), mark & np.uint64(0xFFFFFFFF)]).astype(np.float32)
        attributes["_LAMP"] = buffer.add(lamps, FLOAT, "VEC2", ARRAY)
    # two axes have changed places, so what was wound one way is wound the other
    wound = numbers.reshape(-1, 3)[:, [0, 2, 1]].reshape(-1)
    small = len(vertices) <= int(_STEPS)
    indices = buffer.add(
        wound.astype(np.uint16 if small else np.uint32), _UNSIGNED_SHORT if small else UNSIGNED_INT, "SCALAR", ELEMENTS
    )
    return {"attributes": attributes, "indices": indices}


def _in_order_of_use(numbers: NDArray[np.uint32], vertices: NDArray[Any]) -> tuple[NDArray[np.uint32], NDArray[Any]]:
    """Return indices and vertices so that each vertex follows the vertices used before it, which compresses well."""
    _, first = np.unique(numbers, return_index=True)
    order = np.argsort(first, kind="stable")
    new_number = np.empty(len(order), np.uint32)
    new_number[order] = np.arange(len(order), dtype=np.uint32)
    return new_number[numbers], vertices[order]


def _add_padded(
    buffer: Buffer,
    values: NDArray[np.uint16],
    component: int,
    *,
    normalized: bool,
    **more: Any,  # noqa: ANN401 - members of an accessor
) -> int:
    """Keep three columns of four, since the specification aligns vertices to four bytes."""
    number = buffer.add(values, component, "VEC3", ARRAY, **more)
    buffer.views[-1]["byteStride"] = 8
    if normalized:
        buffer.accessors[-1]["normalized"] = True
    return number


def linear(colours: NDArray[Any]) -> NDArray[np.uint16]:
    """Return sRGB bytes as linear 16-bit values (IEC 61966-2-1)."""
    share = colours / 255.0
    made = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    return np.rint(made * _STEPS).astype(np.uint16)


def _material(look: _Look) -> dict[str, Any]:
    return {
        "name": look.name,
        "doubleSided": True,
        "pbrMetallicRoughness": {"metallicFactor": look.metallic, "roughnessFactor": look.roughness},
    }


def _place(corner: NDArray[np.floating[Any]]) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in corner)
    return x, y, z
