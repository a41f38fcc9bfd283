"""Packets of rays as Embree takes them from compiled code: made, filled, sent and read without Python in between.

RTCRayHit16 and RTCRayHit8 (embree4/rtcore_ray.h) are columns of that many numbers of 4 bytes: those of the ray, then
those of the hit. A kernel that wants more than distances (a camera's) is built of the same parts.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np
from numba import types
from numpy.typing import NDArray

from linden.compiled import fingerprint, part, unlocked

F32 = NDArray[np.float32]
I32 = NDArray[np.int32]

ORIGIN, NEAR, DIRECTION, TIME, FAR, MASK, ID, FLAGS = 0, 3, 4, 7, 8, 9, 10, 11
NORMAL, U, V, TRIANGLE, GEOMETRY, INSTANCE = 12, 15, 16, 17, 18, 19
"""Columns of a packet; where a column is a vector's, y and z follow. Of a hit, GEOMETRY is -1 where there is none."""

_COLUMNS = 21  # INSTANCE is followed by a column for instance arrays
INNER_SIDES = 16
"""How many inner sides of bodies a ray goes out through at most: those of the car it starts in, its seats, a rider."""
ON_M = np.float32(1e-3)
"""How far behind an inner side it goes on."""

_ALIGNED = 64  # bytes
_ALL_BITS = -1

_intp = types.intp
_PACKET = types.void(_intp, _intp, _intp, _intp)  # of the mask, the scene, the rays and RTCIntersectArguments


def _external(name: str) -> Callable[[int, int, int, int], None]:
    return cast("Callable[[int, int, int, int], None]", types.ExternalFunction(name, _PACKET))


_intersect4, _intersect8, _intersect16 = (_external(f"rtcIntersect{width}") for width in (4, 8, 16))
_intersect1 = cast(
    "Callable[[int, int, int], None]", types.ExternalFunction("rtcIntersect1", types.void(_intp, _intp, _intp))
)
_occluded4, _occluded8, _occluded16 = (_external(f"rtcOccluded{width}") for width in (4, 8, 16))

_set_transform = cast(
    "Callable[[int, int, int, int], None]",
    types.ExternalFunction("rtcSetGeometryTransform", types.void(_intp, types.uint32, types.int32, _intp)),
)
_commit_geometry = cast("Callable[[int], None]", types.ExternalFunction("rtcCommitGeometry", types.void(_intp)))
_ROWS_3X4 = 0x9134  # RTC_FORMAT_FLOAT3X4_ROW_MAJOR

COHERENT = np.array([1 << 16, 0xFFFF_FFFF, 0, 0, 0, 0, 0, 0], np.uint32)
INCOHERENT = np.array([0, 0xFFFF_FFFF, 0, 0, 0, 0, 0, 0], np.uint32)
"""RTCIntersectArguments for rays that go side by side, as a camera's, and for others; all features, no callbacks."""


class Packet(NamedTuple):
    """Memory for one packet, used again and again; ``width`` rays in columns."""

    floats: F32  # (columns * width,)
    ints: I32  # the same memory
    valid: I32  # (width,) -1 where there is a ray, 0 where there is none
    at: int  # addresses of the two
    valid_at: int


@part
def new_packet(width: int) -> Packet:
    """Return a packet whose rays have no mask, id, flags, start or time."""
    raw = np.zeros((_COLUMNS + 1) * width + 16, np.float32)
    skip = ((-raw.ctypes.data) % _ALIGNED) // 4
    floats = raw[skip : skip + (_COLUMNS + 1) * width]
    ints = floats.view(np.int32)
    ints[MASK * width : (MASK + 1) * width] = _ALL_BITS
    valid = ints[_COLUMNS * width :]
    return Packet(floats, ints, valid, floats.ctypes.data, valid.ctypes.data)


@part
def put_ray(
    packet: Packet, width: int, k: int, x: float, y: float, z: float, dx: float, dy: float, dz: float, far_m: float
) -> None:
    """Make ray ``k`` one from a place (m) in a direction (length 1) up to a distance."""
    floats, ints = packet.floats, packet.ints
    floats[ORIGIN * width + k], floats[(ORIGIN + 1) * width + k], floats[(ORIGIN + 2) * width + k] = x, y, z
    floats[DIRECTION * width + k], floats[(DIRECTION + 1) * width + k] = dx, dy
    floats[(DIRECTION + 2) * width + k] = dz
    floats[FAR * width + k] = far_m
    ints[GEOMETRY * width + k] = -1
    ints[INSTANCE * width + k] = -1
    packet.valid[k] = _ALL_BITS


@part
def intersect(packet: Packet, width: int, scene: int, arguments: int) -> None:
    """Find the nearest hit of each ray; ``scene`` and ``arguments`` are addresses."""
    if width == 16:
        _intersect16(packet.valid_at, scene, packet.at, arguments)
    elif width == 8:
        _intersect8(packet.valid_at, scene, packet.at, arguments)
    else:
        _intersect4(packet.valid_at, scene, packet.at, arguments)


@part
def occlude(packet: Packet, width: int, scene: int, arguments: int) -> None:
    """Make FAR negative for each ray that meets anything."""
    if width == 16:
        _occluded16(packet.valid_at, scene, packet.at, arguments)
    elif width == 8:
        _occluded8(packet.valid_at, scene, packet.at, arguments)
    else:
        _occluded4(packet.valid_at, scene, packet.at, arguments)


@part
def _write_turned(pose: F32, row: int, x: float, y: float, z: float, out: F32, at: int) -> None:
    """Write the vector, turned as instance ``row`` is (not at all where that is negative), with length 1."""
    if row >= 0:
        x, y, z = (
            pose[row, 0, 0] * x + pose[row, 0, 1] * y + pose[row, 0, 2] * z,
            pose[row, 1, 0] * x + pose[row, 1, 1] * y + pose[row, 1, 2] * z,
            pose[row, 2, 0] * x + pose[row, 2, 1] * y + pose[row, 2, 2] * z,
        )
    scale = np.float32(1.0) / np.sqrt(x * x + y * y + z * z)
    out[at, 0], out[at, 1], out[at, 2] = x * scale, y * scale, z * scale


@part
def _read(
    packet: Packet, width: int, k: int, pose: F32, distance: F32, instance: I32, triangle: I32, normal: F32, ray: int
) -> None:
    """Write what ray ``k`` met as the answer of ray number ``ray``."""
    floats, ints = packet.floats, packet.ints
    if ints[GEOMETRY * width + k] == -1:
        distance[ray], instance[ray], triangle[ray] = np.inf, -2, -1
        normal[ray, 0], normal[ray, 1], normal[ray, 2] = 0.0, 0.0, 0.0
        return
    distance[ray] = floats[FAR * width + k]
    instance[ray] = ints[INSTANCE * width + k] - 1
    triangle[ray] = ints[TRIANGLE * width + k]
    x, y, z = floats[NORMAL * width + k], floats[(NORMAL + 1) * width + k], floats[(NORMAL + 2) * width + k]
    _write_turned(pose, instance[ray], x, y, z, normal, ray)


@part
def _is_inner(direction: F32, instance: I32, normal: F32, ray: int) -> bool:
    along = direction[ray, 0] * normal[ray, 0] + direction[ray, 1] * normal[ray, 1] + direction[ray, 2] * normal[ray, 2]
    inner: bool = instance[ray] >= 0 and along > 0.0
    return inner


@unlocked
def place(geometry: NDArray[np.int64], pose: F32, before: F32) -> None:
    """Give instances (K,) their poses (K, 3, 4), those that have another one than ``before`` had."""
    start = pose.ctypes.data
    for row in range(len(pose)):
        moved = row >= len(before)
        for i in range(3):
            for j in range(4):
                moved = moved or pose[row, i, j] != before[row, i, j]
        if moved:
            _set_transform(geometry[row], 0, _ROWS_3X4, start + row * 48)
            _commit_geometry(geometry[row])


class Kernels(NamedTuple):
    """Compiled for a width; both work on rays from ``start`` to ``stop`` only, ``start`` being a multiple of it."""

    closest: Any
    blocked: Any


def build(width: int) -> Kernels:
    """Return the kernels for packets of a width."""
    sources = fingerprint(Path(__file__))

    def closest(
        scene: int,
        arguments: int,
        origin: F32,
        direction: F32,
        far_m: float,
        outer: bool,  # noqa: FBT001 - numba knows no keywords
        pose: F32,
        distance: F32,
        instance: I32,
        triangle: I32,
        normal: F32,
        start: int,
        stop: int,
    ) -> None:
        _fingerprint = sources
        packet, single = new_packet(width), new_packet(1)
        for first in range(start, stop, width):
            count = min(width, stop - first)
            packet.valid[:] = 0
            for k in range(count):
                o, d = origin[first + k], direction[first + k]
                put_ray(packet, width, k, o[0], o[1], o[2], d[0], d[1], d[2], far_m)
            intersect(packet, width, scene, arguments)
            for k in range(count):
                ray = first + k
                _read(packet, width, k, pose, distance, instance, triangle, normal, ray)
                passed = 0
                while outer and passed < INNER_SIDES and _is_inner(direction, instance, normal, ray):
                    o, d, near_m = origin[ray], direction[ray], distance[ray] + ON_M
                    put_ray(single, 1, 0, o[0], o[1], o[2], d[0], d[1], d[2], far_m)
                    single.floats[NEAR] = near_m
                    _intersect1(scene, single.at, arguments)
                    _read(single, 1, 0, pose, distance, instance, triangle, normal, ray)
                    passed += 1

    def blocked(
        scene: int,
        arguments: int,
        origin: F32,
        direction: F32,
        far_m: float,
        hit: NDArray[np.bool_],
        start: int,
        stop: int,
    ) -> None:
        _fingerprint = sources
        packet = new_packet(width)
        for first in range(start, stop, width):
            count = min(width, stop - first)
            packet.valid[:] = 0
            for k in range(count):
                o, d = origin[first + k], direction[first + k]
                put_ray(packet, width, k, o[0], o[1], o[2], d[0], d[1], d[2], far_m)
            occlude(packet, width, scene, arguments)
            for k in range(count):
                hit[first + k] = packet.floats[FAR * width + k] < 0.0

    return Kernels(unlocked(closest), unlocked(blocked))
