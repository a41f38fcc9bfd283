"""Map facts as plain arrays and back. What comes back is checked: kernels index these arrays without looking.

Nothing here is Python's own serialisation, which could carry code: numbers are arrays, records are JSON in UTF-8.
"""

import json
import math
from collections.abc import Iterator, Mapping
from functools import lru_cache
from types import NoneType, UnionType
from typing import Any, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from linden.maps.facts import MapFacts
from linden.maps.ground import Ground
from linden.maps.opendrive.roadside import Controller
from linden.maps.reading import MapReading
from linden.maps.records import GIVE_WAY, LANES, LOTS, PlacedSignal, Standing
from linden.protocol.values.space import Rotation, Transform, Vector3D

Arrays = Mapping[str, NDArray[Any]]

_POSE = 6  # x, y, z, pitch, yaw, roll
_RECORDS = {
    "signals": tuple[PlacedSignal, ...],
    "controllers": tuple[Controller, ...],
    "geo_origin_deg": tuple[float, float],
    "standing": tuple[Standing, ...],
}
"""Fields of the facts that are kept as JSON."""
_RECORDS_IN_LINE = 500

_COLUMNS: dict[str, tuple[np.dtype[Any], tuple[int | None, ...]]] = {
    "planes": (np.dtype(np.float64), (None, 9)),
    "bin_start": (np.dtype(np.int32), (None,)),
    "bin_items": (np.dtype(np.int32), (None,)),
    "bin_frame": (np.dtype(np.float64), (5,)),
    "terrain": (np.dtype(np.float64), (None, None)),
    "terrain_frame": (np.dtype(np.float64), (3,)),
    "lane_of_triangle": (np.dtype(np.int32), (None,)),
    "lanes": (LANES, (None,)),
    "spawn_points": (np.dtype(np.float64), (None, _POSE)),
    "lots": (LOTS, (None,)),
    "give_way": (GIVE_WAY, (None,)),
    "records": (np.dtype(np.uint8), (None,)),
}
"""What an archive of facts holds: type and shape of each array, ``None`` for any length."""
_WALLS = "wall_feet_m"


def pack(facts: MapFacts) -> dict[str, NDArray[Any]]:
    """Return the facts as the arrays of ``_COLUMNS``."""
    return {
        **facts.ground._asdict(),
        "lane_of_triangle": facts.lane_of_triangle,
        "lanes": facts.lanes,
        "lots": facts.lots,
        "spawn_points": np.array([(*point.location, *point.rotation) for point in facts.spawn_points]).reshape(-1, 6),
        "give_way": facts.give_way,
        "records": np.frombuffer("\n".join(_lines(facts)).encode(), np.uint8),
    }


def _lines(facts: MapFacts) -> Iterator[str]:
    """Yield the records as lines of JSON, each with a field's name and a list of some of its values.

    One text of 100,000 records would hold Python's lock for 0.3 s, and all clients with it.
    """
    for name in _RECORDS:
        values = getattr(facts, name)
        for first in range(0, max(1, len(values)), _RECORDS_IN_LINE):
            yield json.dumps([name, values[first : first + _RECORDS_IN_LINE]])


def unpack(arrays: Arrays) -> MapFacts:
    """Return the facts that :func:`pack` made arrays of.

    Raises:
        ValueError, TypeError, KeyError: these are not such arrays.
    """
    columns = {name: _column(name, arrays[name]) for name in _COLUMNS}
    ground = Ground(*(columns[name] for name in Ground._fields))
    _check_ground(ground)
    lane_of_triangle, lanes = columns["lane_of_triangle"], columns["lanes"]
    if len(lane_of_triangle) != len(ground.planes) or not _within(lane_of_triangle, len(lanes)):
        raise ValueError("the triangles' lanes do not fit the triangles or the lanes")
    records: dict[str, list[Any]] = {}
    for line in columns["records"].tobytes().splitlines():
        name, values = json.loads(line)
        records.setdefault(name, []).extend(values)
    if set(records) != set(_RECORDS):
        raise ValueError("the records are not those of a map")
    if not _within(columns["give_way"]["signal"], len(records["signals"])):
        raise ValueError("a place to give way belongs to no signal")
    return MapFacts(
        ground=ground,
        lane_of_triangle=lane_of_triangle,
        lanes=lanes,
        lots=columns["lots"],
        spawn_points=tuple(
            Transform(Vector3D(*pose[:3]), Rotation(*pose[3:])) for pose in columns["spawn_points"].tolist()
        ),
        give_way=columns["give_way"],
        **{name: _revive(kind, records[name]) for name, kind in _RECORDS.items()},
    )


def pack_walls(wall_feet_m: NDArray[np.float64]) -> dict[str, NDArray[Any]]:
    """Return the feet of walls, (N, 2, 3), as an archive has them."""
    return {_WALLS: wall_feet_m}


def unpack_walls(arrays: Arrays) -> NDArray[np.float64]:
    """Return what :func:`pack_walls` was given.

    Raises:
        ValueError, KeyError: these are not such arrays.
    """
    return _fitting(_WALLS, arrays[_WALLS], np.dtype(np.float64), (None, 2, 3))


def pack_reading(reading: MapReading) -> dict[str, NDArray[Any]]:
    """Return facts and walls as arrays."""
    return {**pack(reading.facts), **pack_walls(reading.wall_feet_m)}


def unpack_reading(arrays: Arrays) -> MapReading:
    """Return what :func:`pack_reading` made arrays of.

    Raises:
        ValueError, TypeError, KeyError: these are not such arrays.
    """
    return MapReading(unpack(arrays), unpack_walls(arrays))


def _column(name: str, array: NDArray[Any]) -> NDArray[Any]:
    return _fitting(name, array, *_COLUMNS[name])


def _fitting(name: str, array: NDArray[Any], dtype: np.dtype[Any], shape: tuple[int | None, ...]) -> NDArray[Any]:
    """Return the array.

    Raises:
        ValueError: it has another type or shape.
    """
    fits = array.ndim == len(shape) and all(
        wanted in (None, size) for wanted, size in zip(shape, array.shape, strict=True)
    )
    if array.dtype != dtype or not fits or not array.flags.c_contiguous:
        raise ValueError(f"{name} is {array.dtype} of shape {array.shape}")
    return array


def _check_ground(ground: Ground) -> None:
    """Raise ValueError where a query could read outside of the arrays."""
    per_m, columns, rows = ground.bin_frame[2:].tolist()
    start, items = ground.bin_start, ground.bin_items
    ends_meet = len(start) > 1 and start[0] == 0 and start[-1] == len(items)
    if not (min(columns, rows) >= 1.0 and columns * rows == len(start) - 1 and float(columns).is_integer()):
        raise ValueError("the bins of the ground are not those of its frame")
    if not (ends_meet and (np.diff(start) >= 0).all() and _within(items, len(ground.planes))):
        raise ValueError("the bins of the ground name triangles that are not there")
    frames = (*ground.bin_frame.tolist(), *ground.terrain_frame.tolist())
    if not (all(map(math.isfinite, frames)) and per_m > 0.0 and ground.terrain_frame[2] > 0.0):
        raise ValueError("a frame of the ground is none")
    if min(ground.terrain.shape) < 2 or not np.isfinite(ground.terrain).all():  # a cell has four nodes
        raise ValueError("the terrain is none")


def _within(numbers: NDArray[np.int32], count: int) -> bool:
    return len(numbers) == 0 or bool(numbers.min() >= 0 and numbers.max() < count)


def _revive(kind: Any, value: Any) -> Any:  # noqa: ANN401 - whatever the records are made of
    """Return a value of JSON as ``kind``: a plain type, one or None, a named tuple, or a tuple of such.

    Raises:
        TypeError: it is something else.
        ValueError: there are more or fewer of them.
    """
    if kind in (str, int, float, bool):
        if type(value) is not kind:
            raise TypeError(f"{value!r} where {kind.__name__} was expected")
        return value
    if get_origin(kind) is UnionType:
        return None if value is None else _revive(next(part for part in get_args(kind) if part is not NoneType), value)
    if not isinstance(value, list):
        raise TypeError(f"{value!r} where a list was expected")
    if get_origin(kind) is tuple:
        parts = get_args(kind)
        kinds = parts[:1] * len(value) if parts[-1] is Ellipsis else parts
        return tuple(_revive(part, item) for part, item in zip(kinds, value, strict=True))
    return kind(*(_revive(field, item) for field, item in zip(_fields(kind), value, strict=True)))


@lru_cache(maxsize=32)
def _fields(kind: type) -> tuple[Any, ...]:
    """Return the types of a named tuple's fields, in their order."""
    return tuple(get_type_hints(kind).values())
