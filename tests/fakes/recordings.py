"""Recordings byte by byte, as CARLA's headers describe them; knows nothing of the reader or the writer."""

import struct
from collections.abc import Sequence
from pathlib import Path

NOON_19_NOV_2021_UTC = 1637323200


def text(value: str) -> bytes:
    return struct.pack("<H", len(value)) + value.encode()


def header(version: int = 1, map_name: str = "Town01", date: int = NOON_19_NOV_2021_UTC) -> bytes:
    return struct.pack("<H", version) + text("CARLA_RECORDER") + struct.pack("<q", date) + text(map_name)


def packet(number: int, content: bytes = b"") -> bytes:
    return struct.pack("<BI", number, len(content)) + content


def several(number: int, layout: str, rows: Sequence[Sequence[float]]) -> bytes:
    return packet(number, struct.pack("<H", len(rows)) + b"".join(struct.pack("<" + layout, *row) for row in rows))


def frame(number: int, elapsed_s: float, *packets: bytes, duration_s: float = 0.05) -> bytes:
    return b"".join((packet(0, struct.pack("<Qdd", number, duration_s, elapsed_s)), *packets, packet(1)))


def actor(
    actor_id: int,
    type_id: str,
    kind: int,
    at_cm: Sequence[float] = (100.0, 200.0, 300.0),
    turned: Sequence[float] = (1.0, 2.0, 3.0),
    attributes: Sequence[tuple[int, str, str]] = (),
) -> bytes:
    described = b"".join(bytes([kind_]) + text(name) + text(value) for kind_, name, value in attributes)
    head = struct.pack("<IB6fI", actor_id, kind, *at_cm, *turned, 7)
    return head + text(type_id) + struct.pack("<H", len(attributes)) + described


def added(*actors: bytes) -> bytes:
    return packet(2, struct.pack("<H", len(actors)) + b"".join(actors))


def removed(*ids: int) -> bytes:
    return several(3, "I", [(i,) for i in ids])


def positions(*rows: Sequence[float]) -> bytes:
    """Rows of id, x, y, z in cm, roll, pitch, yaw in degrees."""
    return several(6, "I6f", rows)


def write(folder: Path, *parts: bytes, name: str = "drive.log") -> Path:
    path = folder / name
    path.write_bytes(b"".join(parts))
    return path
