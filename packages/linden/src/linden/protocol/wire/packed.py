"""Batches of vehicle controls, read from msgpack's bytes straight into columns: what a Traffic Manager sends each tick.

A batch of 100 controls is 2,200 objects of Python, made to be thrown away. One compiled pass over its bytes makes two
arrays. Anything unusual is left to msgpack and the decoders of :mod:`linden.protocol.wire.commands`.
"""

from typing import NamedTuple

import msgpack
import numpy as np
from numpy.typing import NDArray

from linden.compiled import kernel
from linden.protocol.wire.controls import CONTROL_FIELDS, LARGEST_PLAIN, WORTH_COLUMNS, Controls

BATCH = "apply_batch"
CONTROL_INDEX = 2
"""Of ApplyVehicleControl among CARLA's commands."""

_REQUEST = b"\x94\x00"  # an array of four; the first says that it is a request
_METHOD = bytes(
    (0xA0 + len(BATCH), *BATCH.encode(), 0x93, 0x91)
)  # its name, then three parameters, the first [is_async]
_LATEST = len(_REQUEST) + 5 + len(_METHOD)  # where the name ends at the latest: an id has at most five bytes
_BOOLS = {0xC2: False, 0xC3: True}
_LONGEST = 4 + 5 + 1 + 3 * 9 + 3 + 5
"""Bytes of one command at most: brackets and index, id, bracket, three pedals, three switches, gear."""
_SHORTEST = 4 + 1 + 1 + 3 * 5 + 3 + 1
_NONE = -1

U8 = NDArray[np.uint8]


class PackedBatch(NamedTuple):
    """A call of ``apply_batch`` with plain controls alone."""

    call_id: int
    is_async: bool
    controls: Controls
    do_tick: bool
    end: int
    """Where in the bytes it ends."""


def read(data: bytes) -> PackedBatch | None:
    """Return the call that ``data`` begins with, where it is a whole batch of plain controls; else None."""
    if len(data) < WORTH_COLUMNS * _SHORTEST or not data.startswith(_REQUEST):
        return None
    place = data.find(_METHOD, len(_REQUEST), _LATEST)
    if place < 0:
        return None
    call_id, at = _unsigned(data[len(_REQUEST) : place]), place + len(_METHOD)
    is_async = _BOOLS.get(data[at])
    count, at = _array(data, at + 1)
    if call_id is None or is_async is None or not WORTH_COLUMNS <= count <= len(data) // _SHORTEST:
        return None
    actor_ids, fields = np.empty(count, np.int64), np.empty((count, CONTROL_FIELDS))
    padded = np.frombuffer(data + bytes(_LONGEST), np.uint8)
    at = _read_controls(padded, len(data), at, actor_ids, fields)
    do_tick = _BOOLS.get(data[at]) if 0 <= at < len(data) else None
    return None if do_tick is None else PackedBatch(call_id, is_async, Controls(actor_ids, fields), do_tick, at + 1)


def warm_up() -> None:
    """Compile, or load from the cache, what reads a batch; bytes cannot be written to, which numba tells apart."""
    _read_controls(np.frombuffer(bytes(_LONGEST), np.uint8), 0, 0, np.empty(1, np.int64), np.empty((1, CONTROL_FIELDS)))


def _unsigned(packed: bytes) -> int | None:
    """Return the number that these bytes are, None where they are none."""
    try:
        number = msgpack.unpackb(packed)
    except (ValueError, msgpack.UnpackException):
        return None
    return number if type(number) is int else None


def _array(data: bytes, at: int) -> tuple[int, int]:
    """Return how many items the array has that begins here, and where they begin; -1 where none does."""
    first = data[at]
    if 0x90 <= first < 0xA0:  # msgpack's fixarray
        return first - 0x90, at + 1
    width = {0xDC: 2, 0xDD: 4}.get(first, 0)
    return (int.from_bytes(data[at + 1 : at + 1 + width], "big"), at + 1 + width) if width else (_NONE, at)


@kernel
def _read_controls(
    data: U8, length: int, at: int, actor_ids: NDArray[np.int64], fields: NDArray[np.float64]
) -> int:  # pragma: no cover - compiled
    """Fill (K,) ids and (K, 7) controls from the bytes from ``at`` on; return where they end, -1 where one is unusual.

    ``data`` goes on behind ``length`` for at least a command's length.
    """
    for n in range(len(actor_ids)):
        if (
            at >= length
            or data[at] != 0x91
            or data[at + 1] != 0x92
            or data[at + 2] != CONTROL_INDEX
            or data[at + 3] != 0x92
        ):
            return -1
        number, at = _integer(data, at + 4)
        if at < 0 or number < 0 or data[at] != 0x90 + CONTROL_FIELDS:
            return -1
        actor_ids[n] = number
        at += 1
        for column in range(3):
            value, at = _number(data, at)
            if at < 0 or not abs(value) <= LARGEST_PLAIN:
                return -1
            fields[n, column] = value
        for column in range(3, 6):
            fields[n, column] = data[at] - 0xC2
            if data[at] != 0xC2 and data[at] != 0xC3:
                return -1
            at += 1
        number, at = _integer(data, at)
        if at < 0 or number > LARGEST_PLAIN:
            return -1
        fields[n, 6] = number
    return at if at <= length else -1


@kernel
def _big_endian(data: U8, at: int, width: int) -> int:  # pragma: no cover - compiled
    word = np.uint64(0)
    for byte in range(width):
        word = (word << np.uint64(8)) | np.uint64(data[at + byte])
    return word  # type: ignore[return-value] # a number to numba


@kernel
def _number(data: U8, at: int) -> tuple[float, int]:  # pragma: no cover - compiled
    """Return a float of 32 or 64 bits, and where it ends; -1 where it is none."""
    if data[at] == 0xCA:
        return float(np.uint32(_big_endian(data, at + 1, 4)).view(np.float32)), at + 5
    if data[at] == 0xCB:
        return float(np.uint64(_big_endian(data, at + 1, 8)).view(np.float64)), at + 9
    return 0.0, -1


@kernel
def _integer(data: U8, at: int) -> tuple[int, int]:  # pragma: no cover - compiled
    """Return an integer of at most 32 bits, and where it ends; -1 where it is none."""
    first = np.int64(data[at])
    if first < 0x80:
        return int(first), at + 1
    if first >= 0xE0:
        return int(first - 0x100), at + 1
    if 0xCC <= first <= 0xCE:
        width = 1 << int(first - 0xCC)
        return int(np.int64(_big_endian(data, at + 1, width))), at + 1 + width
    if 0xD0 <= first <= 0xD2:
        width = 1 << int(first - 0xD0)
        word = np.int64(_big_endian(data, at + 1, width))
        if word >= np.int64(1) << np.int64(8 * width - 1):
            word -= np.int64(1) << np.int64(8 * width)
        return int(word), at + 1 + width
    return 0, -1
