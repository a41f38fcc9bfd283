"""Writing a recording: packets as bytes, and frames as they are made.

The bytes are those of CARLA 0.9.16. Each frame goes to the file at once and whole, so that a killed server leaves a
readable file.
"""

import contextlib
import io
import os
import struct
from collections.abc import Iterable, Sequence
from itertools import chain
from pathlib import Path

from linden.protocol.values.actors import AttributeValue
from linden.protocol.values.control import VehiclePhysicsControl
from linden.replay.file.folder import open_at_once
from linden.replay.file.layouts import FRAME_START, MAGIC, VERSION, PacketId
from linden.replay.file.packets import ActorAdded, PhysicsRecord, Records, WheelTurns

_HEAD = struct.Struct("<BI")
_COUNT = struct.Struct("<H")
_LONG_COUNT = struct.Struct("<I")
_ADDED_HEAD = struct.Struct("<IB6fI")
_WHEELS_HEAD = struct.Struct("<II")
_PHYSICS_HEAD = struct.Struct("<I5f?4f3f")
_LONGEST_TEXT = 0xFFFF

DURATION_OFFSET = _HEAD.size + 8
"""Where in a frame's bytes its duration stands; it is known only when the next frame begins."""


def header(map_name: str, date_unix_s: int) -> bytes:
    """Return what a file begins with."""
    return struct.pack("<H", VERSION) + text(MAGIC) + struct.pack("<q", date_unix_s) + text(map_name)


def text(value: str) -> bytes:
    """Return a string: a u16 length and as many bytes of UTF-8; what is beyond its reach is cut off."""
    encoded = value.encode("utf-8", "replace")
    if len(encoded) > _LONGEST_TEXT:
        encoded = encoded[:_LONGEST_TEXT].decode("utf-8", "ignore").encode("utf-8")
    return _COUNT.pack(len(encoded)) + encoded


def packet(packet_id: PacketId, content: bytes) -> bytes:
    """Return a packet."""
    return _HEAD.pack(packet_id, len(content)) + content


def frame(number: int, elapsed_s: float, packets: Sequence[bytes]) -> bytes:
    """Return a frame without a known duration; it is written as -1."""
    start = packet(PacketId.FRAME_START, struct.pack("<Qdd", number, -1.0, elapsed_s))
    assert len(start) == _HEAD.size + FRAME_START.itemsize
    return b"".join((start, *packets, packet(PacketId.FRAME_END, b"")))


def records(packet_id: PacketId, rows: Records) -> bytes:
    """Return a packet of records of one size, packed as ``layouts.RECORDS`` has them."""
    return packet(packet_id, _COUNT.pack(len(rows)) + rows.tobytes())


def seconds(packet_id: PacketId, value_s: float) -> bytes:
    """Return a packet that is one time."""
    return packet(packet_id, struct.pack("<d", value_s))


def added(actors: Sequence[ActorAdded]) -> bytes:
    """Return the packet of actors that came."""
    return packet(PacketId.ADDED, _COUNT.pack(len(actors)) + b"".join(map(_added, actors)))


def _added(actor: ActorAdded) -> bytes:
    described = actor.description
    head = _ADDED_HEAD.pack(actor.id, actor.kind, *actor.location_cm, *actor.rotation_deg, described.uid)
    count = _COUNT.pack(len(described.attributes))
    return b"".join((head, text(described.id), count, *map(_attribute, described.attributes)))


def _attribute(attribute: AttributeValue) -> bytes:
    return bytes([attribute.type]) + text(attribute.id) + text(attribute.value)


def wheels(found: Sequence[WheelTurns]) -> bytes:
    """Return the packet of the wheels of vehicles: for each, its id, a u32 count and as many ``layouts.WHEEL``."""
    each = (_WHEELS_HEAD.pack(one.id, len(one.wheels)) + one.wheels.tobytes() for one in found)
    return packet(PacketId.WHEELS, _COUNT.pack(len(found)) + b"".join(each))


def physics(found: Sequence[PhysicsRecord]) -> bytes:
    """Return the packet of what vehicles are made of."""
    return packet(PacketId.PHYSICS, _COUNT.pack(len(found)) + b"".join(_physics(*one) for one in found))


def _physics(actor_id: int, control: VehiclePhysicsControl) -> bytes:
    head = _PHYSICS_HEAD.pack(
        actor_id,
        control.max_rpm,
        control.moi,
        control.damping_rate_full_throttle,
        control.damping_rate_zero_throttle_clutch_engaged,
        control.damping_rate_zero_throttle_clutch_disengaged,
        control.use_gear_autobox,
        control.clutch_strength,
        control.final_ratio,
        control.mass,
        control.drag_coefficient,
        *control.center_of_mass,
    )
    wheels = [(*wheel[:-1], *wheel.position) for wheel in control.wheels]
    lists = (control.torque_curve, control.forward_gears, control.steering_curve, wheels)
    return head + b"".join(map(_numbers, lists))


def _numbers(groups: Iterable[Sequence[float]]) -> bytes:
    """Return a u32-counted list of groups of numbers."""
    found = list(groups)
    flat = list(chain.from_iterable(found))
    return _LONG_COUNT.pack(len(found)) + struct.pack(f"<{len(flat)}f", *flat)


class RecordingWriter:
    """A file that grows by frames.

    Attributes:
        path: of the file.
        elapsed_s: of the last frame.
    """

    def __init__(self, path: Path, map_name: str, date_unix_s: int) -> None:
        """Begin a file; one that stands there is replaced.

        Raises:
            OSError: it cannot be written.
        """
        self.path = path
        self.elapsed_s = 0.0
        self._frames = 0
        self._file: io.FileIO = open(path, "wb", buffering=0, opener=open_at_once)  # noqa: SIM115 - as in read
        self._end = 0
        self._last_duration_at = 0
        try:
            self._append(header(map_name, date_unix_s))
        except OSError:
            self._file.close()
            raise

    def add(self, delta_s: float, packets: Sequence[bytes]) -> None:
        """Add a frame, ``delta_s`` after the last; time begins with the first.

        Raises:
            OSError: the file takes no more; it then ends with the last whole frame.
        """
        if self._frames:
            self.elapsed_s += delta_s
        began = self._end
        self._append(frame(self._frames + 1, self.elapsed_s, packets))
        self._frames += 1
        if self._last_duration_at:
            self._file.seek(self._last_duration_at)
            self._file.write(struct.pack("<d", delta_s))
            self._file.seek(self._end)
        self._last_duration_at = began + DURATION_OFFSET

    def _append(self, content: bytes) -> None:
        left = memoryview(content)
        try:
            while left:
                left = left[self._file.write(left) :]
        except OSError:
            with contextlib.suppress(OSError):  # a frame that cannot be taken back is read as cut short
                os.ftruncate(self._file.fileno(), self._end)
            raise
        self._end += len(content)

    def close(self) -> None:
        """End the file."""
        self._file.close()
