"""Bytes of packets to values. Offsets in errors count from the start of the file."""

import struct
from collections.abc import Callable
from typing import Any, NamedTuple, TypeVar

import numpy as np

from linden.protocol.values.actors import ActorDescription, AttributeValue
from linden.protocol.values.control import Gear, VehiclePhysicsControl, Wheel
from linden.protocol.values.space import Vector2D, Vector3D
from linden.replay.file import layouts
from linden.replay.file.layouts import PacketId
from linden.replay.file.packets import (
    ActorAdded,
    Bone,
    PhysicsRecord,
    RecordingError,
    Records,
    Triple,
    WalkerBones,
    WheelTurns,
)

Item = TypeVar("Item")

_KNOWN_IDS = frozenset(PacketId)
DISPUTED_IDS = (PacketId.DOORS, PacketId.WHEELS, PacketId.BIKERS)
"""Which of these a packet is tells its content alone."""

_COUNT = struct.Struct("<H")
_LONG_COUNT = struct.Struct("<I")
_TRIPLE = struct.Struct("<3f")
_ADDED_HEAD = struct.Struct("<IB")
_PHYSICS_HEAD = struct.Struct("<I5f?4f")


class FilePacket(NamedTuple):
    """A packet as it lies in the file; ``offset`` is where its content begins."""

    id: int
    offset: int
    content: bytes


class Cursor:
    """Reads one packet's content from front to back."""

    def __init__(self, packet: FilePacket) -> None:
        self._packet = packet
        self._at = 0

    def fail(self, what: str) -> RecordingError:
        """Return the error that says where in which packet something is wrong."""
        where = self._packet.offset + self._at
        return RecordingError(f"damaged recording: {name_of(self._packet.id)} at byte {where}: {what}", where)

    def take(self, count: int) -> bytes:
        """Return the next bytes.

        Raises:
            RecordingError: the packet has no more of them.
        """
        left = len(self._packet.content) - self._at
        if count > left:
            raise self.fail(f"{count} bytes expected, the packet has {left} left")
        self._at += count
        return self._packet.content[self._at - count : self._at]

    def unpack(self, layout: struct.Struct) -> tuple[Any, ...]:
        """Return the next numbers."""
        return layout.unpack(self.take(layout.size))

    def text(self) -> str:
        """Return the next string: a u16 length and as many bytes of UTF-8."""
        (length,) = self.unpack(_COUNT)
        return self.take(length).decode("utf-8", "replace")

    def triple(self) -> Triple:
        """Return three numbers."""
        x, y, z = self.unpack(_TRIPLE)
        return x, y, z

    def floats(self, width: int) -> list[tuple[float, ...]]:
        """Return a u32-counted list of groups of ``width`` numbers."""
        (count,) = self.unpack(_LONG_COUNT)
        layout = struct.Struct(f"<{width}f")
        return list(layout.iter_unpack(self.take(count * layout.size)))

    def several(self, read: Callable[["Cursor"], Item]) -> tuple[Item, ...]:
        """Return a u16-counted list of what ``read`` reads."""
        (count,) = self.unpack(_COUNT)
        return tuple(read(self) for _ in range(count))

    def end(self) -> None:
        """Make sure that nothing is left.

        Raises:
            RecordingError: something is.
        """
        left = len(self._packet.content) - self._at
        if left:
            raise self.fail(f"{left} bytes too many for what it holds")


def name_of(packet_id: int) -> str:
    """Return a packet's name for a sentence."""
    try:
        return f"packet {packet_id} ({PacketId(packet_id).name.lower().replace('_', ' ')})"
    except ValueError:
        return f"packet {packet_id}"


def decode(packet: FilePacket) -> tuple[PacketId, object] | None:
    """Return what a packet holds, None where no release of CARLA has such a packet (it is skipped, as CARLA does).

    Raises:
        RecordingError: its size and its content disagree.
    """
    if packet.id not in _KNOWN_IDS:
        return None
    kind = _undisputed(packet) if packet.id in DISPUTED_IDS else PacketId(packet.id)
    return kind, _content(kind, packet)


def _content(kind: PacketId, packet: FilePacket) -> object:
    if kind in layouts.RECORDS:
        return _records(packet, layouts.RECORDS[kind])
    cursor = Cursor(packet)
    content: object
    if kind in (PacketId.PLATFORM_TIME, PacketId.VISUAL_TIME):
        (content,) = cursor.unpack(struct.Struct("<d"))
    elif kind is PacketId.FRAME_COUNTER:
        (content,) = cursor.unpack(struct.Struct("<Q"))
    else:
        content = cursor.several(_VARYING[kind])
    cursor.end()
    return content


def _records(packet: FilePacket, layout: "np.dtype[np.void]") -> Records:
    cursor = Cursor(packet)
    (count,) = cursor.unpack(_COUNT)
    records = np.frombuffer(cursor.take(count * layout.itemsize), layout)
    cursor.end()
    return records


def _undisputed(packet: FilePacket) -> PacketId:
    """Return what packet 21, 22 or 23 holds; versions number doors, wheels and bikers in different orders.

    A door takes 6 bytes, a biker 12, a vehicle's wheels 8 and 9 more for each wheel: the size tells them apart. An
    empty list has no size to tell by and is taken as CARLA 0.9.16 numbers it.
    """
    (count,) = Cursor(packet).unpack(_COUNT)
    if count == 0:
        return PacketId(packet.id)
    size = len(packet.content) - _COUNT.size
    for kind in (PacketId.DOORS, PacketId.BIKERS):
        if size == count * layouts.RECORDS[kind].itemsize:
            return kind
    return PacketId.WHEELS


def _added(cursor: Cursor) -> ActorAdded:
    actor_id, kind = cursor.unpack(_ADDED_HEAD)
    location, rotation = cursor.triple(), cursor.triple()
    (uid,) = cursor.unpack(_LONG_COUNT)
    type_id = cursor.text()
    return ActorAdded(actor_id, kind, location, rotation, ActorDescription(uid, type_id, cursor.several(_attribute)))


def _attribute(cursor: Cursor) -> AttributeValue:
    (kind,) = cursor.take(1)
    return AttributeValue(type=kind, id=cursor.text(), value=cursor.text())


def _physics(cursor: Cursor) -> PhysicsRecord:
    (
        actor_id, max_rpm, moi, full, engaged, disengaged, autobox, clutch, final_ratio, mass, drag
    ) = cursor.unpack(_PHYSICS_HEAD)  # fmt: skip
    centre = Vector3D(*cursor.triple())
    torque, gears, steering, wheels = cursor.floats(2), cursor.floats(3), cursor.floats(2), cursor.floats(12)
    control = VehiclePhysicsControl(
        torque_curve=tuple(Vector2D(*point) for point in torque),
        max_rpm=max_rpm,
        moi=moi,
        damping_rate_full_throttle=full,
        damping_rate_zero_throttle_clutch_engaged=engaged,
        damping_rate_zero_throttle_clutch_disengaged=disengaged,
        use_gear_autobox=autobox,
        clutch_strength=clutch,
        final_ratio=final_ratio,
        forward_gears=tuple(Gear(*gear) for gear in gears),
        mass=mass,
        drag_coefficient=drag,
        center_of_mass=centre,
        steering_curve=tuple(Vector2D(*point) for point in steering),
        wheels=tuple(Wheel._make((*wheel[:9], Vector3D(*wheel[9:]))) for wheel in wheels),
    )
    return PhysicsRecord(actor_id, control)


def _bones(cursor: Cursor) -> WalkerBones:
    (actor_id,) = cursor.unpack(_LONG_COUNT)
    return WalkerBones(actor_id, cursor.several(lambda at: Bone(at.text(), at.triple(), at.triple())))


def _wheels(cursor: Cursor) -> WheelTurns:
    actor_id, count = cursor.unpack(struct.Struct("<II"))
    return WheelTurns(actor_id, np.frombuffer(cursor.take(count * layouts.WHEEL.itemsize), layouts.WHEEL))


_VARYING: dict[PacketId, Callable[[Cursor], Any]] = {
    PacketId.ADDED: _added,
    PacketId.PHYSICS: _physics,
    PacketId.BONES: _bones,
    PacketId.WHEELS: _wheels,
}
