"""Embree ray packets in numba: `RayPacket`, fill and query functions, and `build` for closest hit and occlusion.

RTCRayHit16 and RTCRayHit8 (embree4/rtcore_ray.h) are columns of that many numbers of 4 bytes: those of the ray, then
those of the hit. A kernel that wants more than distances (a camera's) is built of the same parts.
"""

from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np
from numba import types
from numpy.typing import NDArray

from linden.compiled import fingerprint, part, unlocked
from linden.sensors.casting import back_faces as inner_sides

F32 = NDArray[np.float32]
I32 = NDArray[np.int32]

ORIGIN, NEAR, DIRECTION, TIME, FAR, MASK, ID, FLAGS = 0, 3, 4, 7, 8, 9, 10, 11
NORMAL, U, V, TRIANGLE, GEOMETRY, INSTANCE = 12, 15, 16, 17, 18, 19
"""Columns of a packet; where a column is a vector's, y and z follow. Of a hit, GEOMETRY is -1 where there is none."""

_COLUMNS = 21  # INSTANCE is followed by a column for instance arrays

_ALIGNED = 64  # bytes
_ALL_BITS = -1

_intp = types.intp
_PACKET = types.void(_intp, _intp, _intp, _intp)  # of the mask, the scene, the rays and RTCIntersectArguments


def _external(name: str) -> Callable[[int, int, int, int], None]:
    return cast("Callable[[int, int, int, int], None]", types.ExternalFunction(name, _PACKET))


_intersect4, _intersect8, _intersect16 = (_external(f"rtcIntersect{width}") for width in (4, 8, 16))
_occluded4, _occluded8, _occluded16 = (_external(f"rtcOccluded{width}") for width in (4, 8, 16))

_set_transform = cast(
    "Callable[[int, int, int, int], None]",
    types.ExternalFunction("rtcSetGeometryTransform", types.void(_intp, types.uint32, types.int32, _intp)),
)
_commit_geometry = cast("Callable[[int], None]", types.ExternalFunction("rtcCommitGeometry", types.void(_intp)))
_ROWS_3X4 = 0x9134  # RTC_FORMAT_FLOAT3X4_ROW_MAJOR


@lru_cache(maxsize=4)
def asked(*, coherent: bool, outer: bool) -> NDArray[np.uint64]:
    """Return RTCIntersectArguments, all features, for rays that go side by side, as a camera's, and for others.

    With ``outer``, bodies with a filter on their geometry are met from outside only.
    """
    flags = 1 << 16 if coherent else 0  # RTC_RAY_QUERY_FLAG_COHERENT
    return np.array([flags | 0xFFFF_FFFF << 32, 0, inner_sides.address() if outer else 0, 0, 0], np.uint64)


class RayPacket(NamedTuple):
    """Memory for one packet, used again and again; ``width`` rays in columns."""

    floats: F32  # (columns * width,)
    ints: I32  # the same memory
    valid: I32  # (width,) -1 where there is a ray, 0 where there is none
    at: int  # addresses of the two
    valid_at: int


@part
def new_packet(width: int) -> RayPacket:
    """Return a packet of rays without mask, id, flags, start or time."""
    raw = np.zeros((_COLUMNS + 1) * width + 16, np.float32)
    skip = ((-raw.ctypes.data) % _ALIGNED) // 4
    floats = raw[skip : skip + (_COLUMNS + 1) * width]
    ints = floats.view(np.int32)
    ints[MASK * width : (MASK + 1) * width] = _ALL_BITS
    valid = ints[_COLUMNS * width :]
    return RayPacket(floats, ints, valid, floats.ctypes.data, valid.ctypes.data)


@part
def put_rays(packet: RayPacket, width: int, origin: F32, direction: F32, first: int, count: int, far_m: float) -> None:
    """Fill a packet with ``count`` rays from number ``first`` on, up to a distance."""
    floats, ints, valid = packet.floats, packet.ints, packet.valid
    for axis in range(3):
        for k in range(count):
            floats[(ORIGIN + axis) * width + k] = origin[first + k, axis]
            floats[(DIRECTION + axis) * width + k] = direction[first + k, axis]
    for k in range(width):
        floats[NEAR * width + k] = 0.0
        floats[FAR * width + k] = far_m
        ints[GEOMETRY * width + k] = -1
        ints[INSTANCE * width + k] = -1
        valid[k] = _ALL_BITS if k < count else 0


@part
def intersect(packet: RayPacket, width: int, scene: int, arguments: int) -> None:
    """Find the nearest hit of each ray; ``scene`` and ``arguments`` are addresses."""
    if width == 16:
        _intersect16(packet.valid_at, scene, packet.at, arguments)
    elif width == 8:
        _intersect8(packet.valid_at, scene, packet.at, arguments)
    else:
        _intersect4(packet.valid_at, scene, packet.at, arguments)


@part
def occlude(packet: RayPacket, width: int, scene: int, arguments: int) -> None:
    """Make FAR negative for each ray that meets anything."""
    if width == 16:
        _occluded16(packet.valid_at, scene, packet.at, arguments)
    elif width == 8:
        _occluded8(packet.valid_at, scene, packet.at, arguments)
    else:
        _occluded4(packet.valid_at, scene, packet.at, arguments)


@part
def _read(
    packet: RayPacket,
    width: int,
    count: int,
    pose: F32,
    distance: F32,
    instance: I32,
    triangle: I32,
    normal: F32,
    first: int,
) -> None:
    """Write what the rays of a packet met as the answers from number ``first`` on."""
    floats, ints = packet.floats, packet.ints
    for k in range(count):
        ray, met = first + k, ints[GEOMETRY * width + k] != -1
        distance[ray] = floats[FAR * width + k] if met else np.float32(np.inf)
        instance[ray] = ints[INSTANCE * width + k] - 1 if met else -2
        triangle[ray] = ints[TRIANGLE * width + k] if met else -1
        x, y, z = floats[NORMAL * width + k], floats[(NORMAL + 1) * width + k], floats[(NORMAL + 2) * width + k]
        scale = np.float32(1.0) / np.sqrt(x * x + y * y + z * z) if met else np.float32(0.0)
        normal[ray, 0] = x * scale if met else np.float32(0.0)
        normal[ray, 1] = y * scale if met else np.float32(0.0)
        normal[ray, 2] = z * scale if met else np.float32(0.0)
    for ray in range(first, first + count):
        row = instance[ray]
        if row >= 0:
            _turn(pose, row, normal, ray)


@part
def _turn(pose: F32, row: int, normal: F32, ray: int) -> None:
    """Turn a normal from the frame of instance ``row`` to the world, its length 1 again where the body is scaled."""
    x, y, z = normal[ray, 0], normal[ray, 1], normal[ray, 2]
    u = pose[row, 0, 0] * x + pose[row, 0, 1] * y + pose[row, 0, 2] * z
    v = pose[row, 1, 0] * x + pose[row, 1, 1] * y + pose[row, 1, 2] * z
    w = pose[row, 2, 0] * x + pose[row, 2, 1] * y + pose[row, 2, 2] * z
    scale = np.float32(1.0) / np.sqrt(u * u + v * v + w * w)
    normal[ray, 0], normal[ray, 1], normal[ray, 2] = u * scale, v * scale, w * scale


@unlocked
def place(geometry: NDArray[np.int64], pose: F32, before: F32) -> None:
    """Give instances (K,) their poses (K, 3, 4), where it differs from that in ``before``."""
    start = pose.ctypes.data
    for row in range(len(pose)):
        moved = row >= len(before)
        for i in range(3):
            for j in range(4):
                moved = moved or pose[row, i, j] != before[row, i, j]
        if moved:
            _set_transform(geometry[row], 0, _ROWS_3X4, start + row * 48)
            _commit_geometry(geometry[row])


class PacketKernels(NamedTuple):
    """Compiled for a width; both work on rays from ``start`` to ``stop`` only, ``start`` being a multiple of it."""

    closest: Any
    blocked: Any


@lru_cache(maxsize=3)
def build(width: int) -> PacketKernels:
    """Return the kernels for packets of a width; once, for compiled code is never given back."""
    sources = fingerprint(Path(__file__))

    def closest(
        scene: int,
        arguments: int,
        origin: F32,
        direction: F32,
        far_m: float,
        pose: F32,
        distance: F32,
        instance: I32,
        triangle: I32,
        normal: F32,
        start: int,
        stop: int,
    ) -> None:
        _fingerprint = sources
        packet = new_packet(width)
        for first in range(start, stop, width):
            count = min(width, stop - first)
            put_rays(packet, width, origin, direction, first, count, far_m)
            intersect(packet, width, scene, arguments)
            _read(packet, width, count, pose, distance, instance, triangle, normal, first)

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
            put_rays(packet, width, origin, direction, first, count, far_m)
            occlude(packet, width, scene, arguments)
            for k in range(count):
                hit[first + k] = packet.floats[FAR * width + k] < 0.0

    return PacketKernels(unlocked(closest), unlocked(blocked))
