"""One walk through a recorder file: where which packets lie, and where it stops being whole."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from typing import NamedTuple

from basu_carla_log.layouts import RECORDS, Created, DamageError, Kind, Physics, created, must_be, physics

_HEAD, _COUNT = struct.Struct("<BI"), struct.Struct("<H")
_FRAME_START, _SECONDS = struct.Struct("<Qdd"), struct.Struct("<d")
_KINDS = {int(kind): kind for kind in Kind}


class Place(NamedTuple):
    """Records of one packet: ``records`` of them from byte ``start``, in frame ``frame`` (from 1)."""

    frame: int
    start: int
    records: int


@dataclass(slots=True)
class Contents:
    """What was found, frame after whole frame."""

    starts: list[tuple[int, float, float]] = field(default_factory=list)  # number, duration, elapsed time in s
    platform_s: list[float] = field(default_factory=list)  # nan where a frame has none
    places: dict[Kind, list[Place]] = field(default_factory=lambda: {kind: [] for kind in RECORDS})
    created: list[Created] = field(default_factory=list)
    physics: list[Physics] = field(default_factory=list)
    unread: dict[int, int] = field(default_factory=dict)  # packets that no query asks for, by their number


class Packet(NamedTuple):
    """A packet by its content's bytes."""

    kind: int
    start: int
    end: int


def scan(data: bytes, at: int) -> tuple[Contents, str | None]:
    """Walk from byte ``at`` to the end, or to where a frame is not whole; that is said in words, None where all is."""
    contents = Contents()
    while at < len(data):
        frame = len(contents.starts) + 1
        try:
            packets, at = _frame(data, at)
            found = _read(data, packets, frame)
        except DamageError as error:
            return contents, f"frame {frame} is not whole ({error})"
        _add(contents, found)
    return contents, None


def _frame(data: bytes, at: int) -> tuple[list[Packet], int]:
    """The packets of the frame that begins at ``at``, and where the next begins."""
    packets: list[Packet] = []
    while True:
        packet = _packet(data, at)
        if (packet.kind == Kind.FRAME_START) != (not packets):
            what = "does not begin a frame" if not packets else "begins a frame inside another"
            raise DamageError(f"packet {packet.kind} at byte {at} {what}")
        packets.append(packet)
        at = packet.end
        if packet.kind == Kind.FRAME_END:
            return packets, at


def _packet(data: bytes, at: int) -> Packet:
    if at + _HEAD.size > len(data):
        raise DamageError(f"the file ends at byte {len(data)}, inside the packet at byte {at}")
    kind, size = _HEAD.unpack_from(data, at)
    start = at + _HEAD.size
    if start + size > len(data):
        raise DamageError(f"the file ends at byte {len(data)}, inside the packet at byte {at}")
    return Packet(kind, start, start + size)


def _read(data: bytes, packets: list[Packet], frame: int) -> Contents:
    """What one frame holds."""
    found = Contents(platform_s=[float("nan")])
    for packet in packets:
        kind = _KINDS.get(packet.kind)
        if kind is None:
            found.unread[packet.kind] = found.unread.get(packet.kind, 0) + 1
            continue
        try:
            _read_packet(data, packet, kind, frame, found)
        except DamageError as error:
            name = kind.name.lower().replace("_", " ")
            raise DamageError(f"packet {packet.kind}, {name}, at byte {packet.start - _HEAD.size}: {error}") from None
    return found


def _read_packet(data: bytes, packet: Packet, kind: Kind, frame: int, found: Contents) -> None:
    size = packet.end - packet.start
    if kind in RECORDS:
        must_be(size >= _COUNT.size, f"{size} bytes have no room for a count")
        (count,) = _COUNT.unpack_from(data, packet.start)
        needed = _COUNT.size + count * RECORDS[kind].itemsize
        must_be(size == needed, f"{size} bytes for {count} records, which take {needed}")
        must_be(not found.places[kind], "it stands twice")
        found.places[kind].append(Place(frame, packet.start + _COUNT.size, count))
    elif kind is Kind.FRAME_START:
        must_be(size == _FRAME_START.size, f"{size} bytes instead of {_FRAME_START.size}")
        found.starts.append(_FRAME_START.unpack_from(data, packet.start))
    elif kind is Kind.PLATFORM_TIME:
        must_be(size == _SECONDS.size, f"{size} bytes instead of {_SECONDS.size}")
        (found.platform_s[0],) = _SECONDS.unpack_from(data, packet.start)
    elif kind is Kind.CREATED:
        found.created.extend(created(data, packet.start, packet.end, frame))
    elif kind is Kind.PHYSICS:
        found.physics.extend(physics(data, packet.start, packet.end, frame))


def _add(contents: Contents, found: Contents) -> None:
    """Take in a whole frame."""
    contents.starts.extend(found.starts)
    contents.platform_s.extend(found.platform_s)
    contents.created.extend(found.created)
    contents.physics.extend(found.physics)
    for kind, places in found.places.items():
        contents.places[kind].extend(places)
    for number, count in found.unread.items():
        contents.unread[number] = contents.unread.get(number, 0) + count
