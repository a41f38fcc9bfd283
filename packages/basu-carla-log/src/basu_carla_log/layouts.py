"""The layout of recorder files of CARLA 0.9.16: packets, records of fixed size, and readers of the others.

Everything is little-endian and packed. A packet is a byte of kind, four of size, the content; one that holds records
begins with their number as u16. Places are in cm, angles in degrees, rotations stand as roll, pitch, yaw.
Source: CARLA's ``Plugins/Carla/Source/Carla/Recorder``, the ``Write`` functions.
"""

from __future__ import annotations

import struct
from enum import IntEnum
from typing import NamedTuple

import numpy as np

MAGIC = b"CARLA_RECORDER"
VERSIONS = (1, 2)  # 1: all releases; 2: of development after 0.9.16, the same but for how attributes' types count
NO_ACTOR = 0xFFFFFFFF  # an actor's id in a collision with scenery


class Kind(IntEnum):
    """The packets that are read; the others (bones, wheels, doors, clocks, weather) answer none of the queries."""

    FRAME_START = 0
    FRAME_END = 1
    CREATED = 2
    DESTROYED = 3
    PARENTS = 4
    COLLISIONS = 5
    POSITIONS = 6
    LIGHT_STATES = 7
    CONTROLS = 8
    WALKER_SPEEDS = 9
    VEHICLE_LIGHTS = 10
    SCENE_LIGHTS = 11
    VELOCITIES = 12
    BOXES = 13
    PLATFORM_TIME = 14
    PHYSICS = 15
    LIGHT_TIMES = 16
    TRIGGER_VOLUMES = 17
    LAST_BITS = 240  # of places in m, by Linden: how many last bits they are off those in cm over 100


BOX = np.dtype([("id", "<u4"), ("centre_cm", "<f4", (3,)), ("extent_cm", "<f4", (3,))])

RECORDS: dict[Kind, np.dtype[np.void]] = {
    Kind.DESTROYED: np.dtype([("id", "<u4")]),
    Kind.PARENTS: np.dtype([("id", "<u4"), ("parent_id", "<u4")]),
    Kind.COLLISIONS: np.dtype(
        [("number", "<u4"), ("id", "<u4"), ("other_id", "<u4"), ("is_hero", "?"), ("other_is_hero", "?")]
    ),
    Kind.POSITIONS: np.dtype([("id", "<u4"), ("location_cm", "<f4", (3,)), ("rotation_deg", "<f4", (3,))]),
    Kind.LIGHT_STATES: np.dtype([("id", "<u4"), ("frozen", "?"), ("elapsed_s", "<f4"), ("state", "i1")]),
    Kind.CONTROLS: np.dtype(
        [
            ("id", "<u4"),
            ("steer", "<f4"),
            ("throttle", "<f4"),
            ("brake", "<f4"),
            ("hand_brake", "?"),
            ("gear", "<i4"),  # negative: reverse
        ]
    ),
    Kind.WALKER_SPEEDS: np.dtype([("id", "<u4"), ("speed_mps", "<f4")]),
    Kind.VEHICLE_LIGHTS: np.dtype([("id", "<u4"), ("bits", "<u4")]),
    Kind.SCENE_LIGHTS: np.dtype(
        [("id", "<i4"), ("intensity", "<f4"), ("rgba", "<f4", (4,)), ("on", "?"), ("group", "u1")]
    ),
    Kind.VELOCITIES: np.dtype([("id", "<u4"), ("velocity_mps", "<f4", (3,)), ("angular_degps", "<f4", (3,))]),
    Kind.BOXES: BOX,
    Kind.LIGHT_TIMES: np.dtype([("id", "<u4"), ("green_s", "<f4"), ("yellow_s", "<f4"), ("red_s", "<f4")]),
    Kind.TRIGGER_VOLUMES: BOX,
    Kind.LAST_BITS: np.dtype([("off", "i1", (3,))]),
}


Triple = tuple[float, float, float]

_U16, _U32 = struct.Struct("<H"), struct.Struct("<I")
_CREATED = struct.Struct("<IB6fI")
_PHYSICS = struct.Struct("<I5f?4f3f")


class DamageError(Exception):
    """Something cannot stand where it stands; the text says what, without the place."""


def must_be(holds: bool, otherwise: str) -> None:  # noqa: FBT001 - an assertion about a file
    """Raises: DamageError where it does not hold."""
    if not holds:
        raise DamageError(otherwise)


class Created(NamedTuple):
    """An actor that came, in the first frame all there are; its place is its parent's where it has one."""

    frame: int  # from 1
    id: int
    kind: int  # 0 other, 1 vehicle, 2 walker, 3 traffic light, 4 traffic sign, 5 sensor
    location_cm: Triple
    rotation_deg: Triple  # roll, pitch, yaw
    type_id: str
    attributes: tuple[tuple[str, str], ...]  # name and value, in the file's order


class Physics(NamedTuple):
    """What a vehicle is made of, in CARLA's units; wheels have nine numbers as the client names them, then cm."""

    frame: int  # from 1
    id: int
    max_rpm: float
    moi: float
    damping_rate_full_throttle: float
    damping_rate_zero_throttle_clutch_engaged: float
    damping_rate_zero_throttle_clutch_disengaged: float
    use_gear_autobox: bool
    clutch_strength: float
    final_ratio: float
    mass: float
    drag_coefficient: float
    center_of_mass: Triple
    torque_curve: tuple[tuple[float, ...], ...]  # of 2
    forward_gears: tuple[tuple[float, ...], ...]  # of 3: ratio, down, up
    steering_curve: tuple[tuple[float, ...], ...]  # of 2
    wheels: tuple[tuple[float, ...], ...]  # of 12


class Reader:
    """Goes through ``data`` from ``at`` to ``end`` and no farther."""

    def __init__(self, data: bytes, at: int, end: int) -> None:
        self._data, self.at, self._end = data, at, end

    def take(self, layout: struct.Struct) -> tuple[float, ...]:
        """The next numbers.

        Raises:
            DamageError: they would end beyond the end.
        """
        self._must_have(layout.size)
        found = layout.unpack_from(self._data, self.at)
        self.at += layout.size
        return found

    def count(self) -> int:
        """The next u16."""
        return int(self.take(_U16)[0])

    def raw_text(self) -> bytes:
        """The next text as it stands: a u16 and as many bytes."""
        size = self.count()
        self._must_have(size)
        self.at += size
        return self._data[self.at - size : self.at]

    def text(self) -> str:
        """The next text; bytes that are no UTF-8 become question marks."""
        return self.raw_text().decode("utf-8", "replace")

    def rows(self, width: int) -> tuple[tuple[float, ...], ...]:
        """The next list of rows of ``width`` floats, counted by a u32."""
        layout = struct.Struct(f"<{width}f")
        count = int(self.take(_U32)[0])
        self._must_have(count * layout.size)
        begin, self.at = self.at, self.at + count * layout.size
        return tuple(layout.iter_unpack(self._data[begin : self.at]))

    def must_be_at_end(self) -> None:
        """Raises: DamageError where something is left."""
        if self.at != self._end:
            raise DamageError(f"{self._end - self.at} bytes are left over")

    def _must_have(self, size: int) -> None:
        if self.at + size > self._end:
            raise DamageError(f"{size} bytes are announced where {self._end - self.at} are left")


def created(data: bytes, at: int, end: int, frame: int) -> list[Created]:
    """The actors in a packet's content.

    Raises:
        DamageError: size and content disagree.
    """
    reader = Reader(data, at, end)
    found = []
    for _ in range(reader.count()):
        actor_id, kind, x, y, z, roll, pitch, yaw, _uid = reader.take(_CREATED)
        type_id = reader.text()
        attributes = tuple(_attribute(reader) for _ in range(reader.count()))
        found.append(Created(frame, int(actor_id), int(kind), (x, y, z), (roll, pitch, yaw), type_id, attributes))
    reader.must_be_at_end()
    return found


def physics(data: bytes, at: int, end: int, frame: int) -> list[Physics]:
    """The vehicles in a packet's content.

    Raises:
        DamageError: size and content disagree.
    """
    reader = Reader(data, at, end)
    found = []
    for _ in range(reader.count()):
        actor_id, *numbers, x, y, z = reader.take(_PHYSICS)
        lists = (reader.rows(2), reader.rows(3), reader.rows(2), reader.rows(12))
        found.append(Physics._make((frame, int(actor_id), *numbers, (x, y, z), *lists)))
    reader.must_be_at_end()
    return found


def _attribute(reader: Reader) -> tuple[str, str]:
    """A name and its value; the byte before tells a type, which releases number in two ways."""
    reader.take(struct.Struct("<B"))
    return reader.text(), reader.text()
