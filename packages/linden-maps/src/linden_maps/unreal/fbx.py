"""Parts of a map as binary FBX 7.4: centimetres, z up, one model for each part.

Sources of the format: the FBX SDK's documentation ("FBX Scenes", "Axis and unit conversion") and Blender's description
of the binary container ("FBX binary file format specification", 2013). Identification and footer are those of a file
without a creation time: readers that check them want them to fit each other.
"""

import struct
import zlib
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden_maps.unreal.parts import Part, PartMaterial

VERSION = 7400
CM_PER_M = 100.0
_MAGIC = b"Kaydara FBX Binary  \x00\x1a\x00"
_FILE_ID = bytes.fromhex("28b32aebb624ccc2bfc8b02aa92bfcf1")
_TIME = "1970-01-01 10:00:00:000"
_FOOT_ID = bytes.fromhex("fabcab09d0c8d466b176fb831cf7267e")
_FOOT_END = bytes.fromhex("f85a8c6adef5d97eece90ce3758f290b")
_END_OF_CHILDREN = b"\0" * 13
_SEPARATOR = "\x00\x01"  # between a name and its class
_LEVEL = 1  # of zlib; the next ones save some percent at twice the time
_Value = int | float | str | bytes | bool | NDArray[np.float64] | NDArray[np.int32]


class _Long(NamedTuple):
    """An integer of 64 bits, as ids are."""

    value: int


class _Node(NamedTuple):
    """A record: name, properties, nested records."""

    name: str
    values: tuple["_Value | _Long", ...] = ()
    children: tuple["_Node", ...] = ()


def fbx(parts: Sequence[Part], name: str) -> bytes:
    """Return the bytes of a .fbx file; equal parts give equal bytes."""
    surfaces = sorted({surface for part in parts for surface in part.surfaces})
    ids = {surface: 3_000_000 + row for row, surface in enumerate(surfaces)}
    top = [
        _header(),
        _Node("FileId", (_FILE_ID,)),
        _Node("CreationTime", (_TIME,)),
        _Node("Creator", ("linden map package",)),
        _settings(),
        _Node("Documents", (), (_Node("Count", (1,)), _document(name))),
        _Node("References"),
        _definitions(len(parts), len(surfaces)),
        _Node("Objects", (), tuple(_objects(parts, ids))),
        _Node("Connections", (), tuple(_connections(parts, ids))),
        _Node("Takes", (), (_Node("Current", ("",)),)),
    ]
    data = bytearray(_MAGIC + struct.pack("<I", VERSION))
    for node in top:
        _write(node, data)
    data += _END_OF_CHILDREN + _FOOT_ID + b"\0" * 4
    data += b"\0" * (16 - len(data) % 16)
    data += struct.pack("<I", VERSION) + b"\0" * 120 + _FOOT_END
    return bytes(data)


def _write(node: _Node, data: bytearray) -> None:
    """Append a record: end, number of properties, their bytes, name, properties, nested records."""
    start = len(data)
    name = node.name.encode()
    data += b"\0" * 12 + bytes([len(name)]) + name
    first = len(data)
    for value in node.values:
        data += _property(value)
    properties = len(data) - first
    for child in node.children:
        _write(child, data)
    if node.children or not node.values:
        data += _END_OF_CHILDREN
    struct.pack_into("<III", data, start, len(data), len(node.values), properties)


def _property(value: "_Value | _Long") -> bytes:
    """Return a property: a letter for its type, and its bytes."""
    if isinstance(value, str | bytes):
        raw = value.encode() if isinstance(value, str) else value
        return (b"S" if isinstance(value, str) else b"R") + struct.pack("<I", len(raw)) + raw
    if isinstance(value, np.ndarray):
        kind, dtype = (b"d", "<f8") if value.dtype.kind == "f" else (b"i", "<i4")
        packed = zlib.compress(np.ascontiguousarray(value, dtype).tobytes(), _LEVEL)
        return kind + struct.pack("<III", value.size, 1, len(packed)) + packed
    if isinstance(value, _Long):
        return b"L" + struct.pack("<q", value.value)
    letter, form = {bool: (b"C", "<?"), int: (b"I", "<i"), float: (b"D", "<d")}[type(value)]
    return letter + struct.pack(form, value)


def _header() -> _Node:
    return _Node(
        "FBXHeaderExtension",
        (),
        (
            _Node("FBXHeaderVersion", (1003,)),
            _Node("FBXVersion", (VERSION,)),
            _Node("EncryptionType", (0,)),
            _Node("Creator", ("linden map package",)),
        ),
    )


def _p(name: str, kind: str, label: str, flags: str, *values: "_Value | _Long") -> _Node:
    return _Node("P", (name, kind, label, flags, *values))


def _settings() -> _Node:
    """Return the axes (z up, x to the right, looking along y: right-handed) and the unit (cm)."""
    numbers = {
        "UpAxis": 2,
        "UpAxisSign": 1,
        "FrontAxis": 1,
        "FrontAxisSign": -1,
        "CoordAxis": 0,
        "CoordAxisSign": 1,
        "OriginalUpAxis": 2,
        "OriginalUpAxisSign": 1,
    }
    axes = tuple(_p(key, "int", "Integer", "", value) for key, value in numbers.items())
    units = tuple(_p(key, "double", "Number", "", 1.0) for key in ("UnitScaleFactor", "OriginalUnitScaleFactor"))
    return _Node("GlobalSettings", (), (_Node("Version", (1000,)), _Node("Properties70", (), axes + units)))


def _document(name: str) -> _Node:
    properties = (_p("SourceObject", "object", "", ""), _p("ActiveAnimStackName", "KString", "", "", ""))
    children = (_Node("Properties70", (), properties), _Node("RootNode", (_Long(0),)))
    return _Node("Document", (_Long(1_000), name, "Scene"), children)


def _definitions(parts: int, surfaces: int) -> _Node:
    counts = {"GlobalSettings": 1, "Geometry": parts, "Model": parts, "Material": surfaces}
    kinds = tuple(_Node("ObjectType", (kind,), (_Node("Count", (count,)),)) for kind, count in counts.items())
    return _Node("Definitions", (), (_Node("Version", (100,)), _Node("Count", (sum(counts.values()),)), *kinds))


def _objects(parts: Sequence[Part], ids: dict[PartMaterial, int]) -> Iterator[_Node]:
    for row, part in enumerate(parts):
        yield _geometry(part, 1_000_000 + row)
    for row, part in enumerate(parts):
        yield _model(part, 2_000_000 + row)
    for surface, number in ids.items():
        yield _material(surface, number)


def _geometry(part: Part, number: int) -> _Node:
    ends = part.triangles.astype(np.int32)
    ends[:, 2] = ~ends[:, 2]  # a negative number ends a polygon
    corners = np.repeat(part.normals, 3, axis=0).reshape(-1)
    distinct, index = np.unique(np.round(part.uv_m.reshape(-1, 2), 4), axis=0, return_inverse=True)
    return _Node(
        "Geometry",
        (_Long(number), f"{part.name}{_SEPARATOR}Geometry", "Mesh"),
        (
            _Node("GeometryVersion", (124,)),
            _Node("Vertices", (np.round(part.vertices_m * CM_PER_M, 4).reshape(-1),)),
            _Node("PolygonVertexIndex", (ends.reshape(-1),)),
            _layer("Normal", "ByPolygonVertex", "Direct", _Node("Normals", (np.round(corners, 7),))),
            _layer(
                "UV",
                "ByPolygonVertex",
                "IndexToDirect",
                _Node("UV", (distinct.reshape(-1),)),
                _Node("UVIndex", (index.reshape(-1).astype(np.int32),)),
            ),
            _layer("Material", "ByPolygon", "IndexToDirect", _Node("Materials", (part.surface.astype(np.int32),))),
            _Node("Layer", (0,), (_Node("Version", (100,)), *map(_element, ("Normal", "UV", "Material")))),
        ),
    )


def _layer(kind: str, mapping: str, reference: str, *data: _Node) -> _Node:
    return _Node(
        f"LayerElement{kind}",
        (0,),
        (
            _Node("Version", (101,)),
            _Node("Name", ("UVMap" if kind == "UV" else "",)),
            _Node("MappingInformationType", (mapping,)),
            _Node("ReferenceInformationType", (reference,)),
            *data,
        ),
    )


def _element(kind: str) -> _Node:
    return _Node("LayerElement", (), (_Node("Type", (f"LayerElement{kind}",)), _Node("TypedIndex", (0,))))


def _model(part: Part, number: int) -> _Node:
    places = tuple(
        _p(f"Lcl {kind}", f"Lcl {kind}", "", "A", value, value, value)
        for kind, value in (("Translation", 0.0), ("Rotation", 0.0), ("Scaling", 1.0))
    )
    return _Node(
        "Model",
        (_Long(number), f"{part.name}{_SEPARATOR}Model", "Mesh"),
        (
            _Node("Version", (232,)),
            _Node("Properties70", (), places),
            _Node("Shading", (True,)),
            _Node("Culling", ("CullingOff",)),
        ),
    )


def _material(surface: PartMaterial, number: int) -> _Node:
    colour = [round(value / 255.0, 6) for value in surface.colour]
    properties = (
        _p("DiffuseColor", "Color", "", "A", *colour),
        _p("DiffuseFactor", "Number", "", "A", 1.0),
        _p("SpecularFactor", "Number", "", "A", 0.1),
    )
    return _Node(
        "Material",
        (_Long(number), f"{surface.name}{_SEPARATOR}Material", ""),
        (
            _Node("Version", (102,)),
            _Node("ShadingModel", ("Phong",)),
            _Node("MultiLayer", (0,)),
            _Node("Properties70", (), properties),
        ),
    )


def _connections(parts: Sequence[Part], ids: dict[PartMaterial, int]) -> Iterator[_Node]:
    """Yield what belongs to what: models to the scene, geometries and materials (in their order) to models."""
    for row, part in enumerate(parts):
        yield _Node("C", ("OO", _Long(2_000_000 + row), _Long(0)))
        yield _Node("C", ("OO", _Long(1_000_000 + row), _Long(2_000_000 + row)))
        for surface in part.surfaces:
            yield _Node("C", ("OO", _Long(ids[surface]), _Long(2_000_000 + row)))
