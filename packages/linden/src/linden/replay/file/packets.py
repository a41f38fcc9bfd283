"""The content of a recording as values: header, frames, records of varying size; errors of damaged files.

Records of fixed size are arrays (``layouts``).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from linden.errors import UserError
from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.control import VehiclePhysicsControl
from linden.replay.file import layouts
from linden.replay.file.layouts import PacketId
from linden.structured import StructuredArray


class RecordingError(UserError):
    """A file is no recording, or damaged; ``offset`` is the byte where that shows."""

    def __init__(self, sentence: str, offset: int) -> None:
        super().__init__(sentence)
        self.offset = offset


class NoRecordingError(RecordingError):
    """A file that CARLA's recorder has not written."""


class CutShortError(RecordingError):
    """A recording ends inside a frame, as that of a server that was killed may; all whole frames before are good."""


Records = StructuredArray
Triple = tuple[float, float, float]


class Header(NamedTuple):
    """The version, the time and the map of a recording; ``date_unix_s`` counts from 1970."""

    version: int
    date_unix_s: int
    map_name: str


class ActorAdded(NamedTuple):
    """An actor that came, or was there when the recording began; cm, and roll, pitch, yaw in degrees.

    Where the same frame tells of its parent, its place is relative to that one; otherwise it is in the world.
    The types of the description's attributes are those of the file: releases number them from 0 or from 1.
    """

    id: int
    kind: int
    location_cm: Triple
    rotation_deg: Triple
    description: ActorDescription


class PhysicsRecord(NamedTuple):
    """What a vehicle is made of; the file has neither ``gear_switch_time`` nor the sweep flag, so they are defaults."""

    id: int
    control: VehiclePhysicsControl


class Bone(NamedTuple):
    """One bone of a walker relative to its parent bone; cm, and roll, pitch, yaw in degrees."""

    name: str
    location_cm: Triple
    rotation_deg: Triple


class WalkerBones(NamedTuple):
    """The pose of a walker."""

    id: int
    bones: tuple[Bone, ...]


class WheelTurns(NamedTuple):
    """How a vehicle's wheels stand: records of ``layouts.WHEEL``."""

    id: int
    wheels: Records


@dataclass(frozen=True, slots=True)
class Frame:
    """One frame.

    Attributes:
        number: from 1.
        duration_s: until the next frame, -1 in the last.
        elapsed_s: since the recording began.
        packets: by what they hold, in the order of the file. What the file leaves out is not here; the properties
            below answer with none of it.
    """

    number: int
    duration_s: float
    elapsed_s: float
    packets: Mapping[PacketId, Any]

    def _records(self, packet: PacketId) -> Records:
        found: Records | None = self.packets.get(packet)
        return np.zeros(0, layouts.RECORDS[packet]) if found is None else found

    @property
    def added(self) -> tuple[ActorAdded, ...]:
        """Actors that came; in the first frame, all there are."""
        return tuple(self.packets.get(PacketId.ADDED, ()))

    @property
    def removed(self) -> Records:
        """Return the actors that this frame removed, as ``layouts.REMOVED``."""
        return self._records(PacketId.REMOVED)

    @property
    def parents(self) -> Records:
        """Return the records of new attachments, child and parent: ``layouts.PARENT``."""
        return self._records(PacketId.PARENTS)

    @property
    def collisions(self) -> Records:
        """Return the contacts of this frame, as ``layouts.COLLISION``."""
        return self._records(PacketId.COLLISIONS)

    @property
    def positions(self) -> Records:
        """Where everybody is: ``layouts.POSITION``, cm and roll, pitch, yaw in degrees."""
        return self._records(PacketId.POSITIONS)

    @property
    def light_states(self) -> Records:
        """How the traffic lights stand: ``layouts.LIGHT_STATE``."""
        return self._records(PacketId.LIGHT_STATES)

    @property
    def vehicles(self) -> Records:
        """Controls in force of each vehicle: ``layouts.VEHICLE``."""
        return self._records(PacketId.VEHICLES)

    @property
    def walkers(self) -> Records:
        """Speeds the walkers were told: ``layouts.WALKER``."""
        return self._records(PacketId.WALKERS)

    @property
    def vehicle_lights(self) -> Records:
        """Lamps of each vehicle: ``layouts.VEHICLE_LIGHT``."""
        return self._records(PacketId.VEHICLE_LIGHTS)

    @property
    def scene_lights(self) -> Records:
        """Lamps of streets and houses that were switched, in the first frame all: ``layouts.SCENE_LIGHT``."""
        return self._records(PacketId.SCENE_LIGHTS)

    @property
    def doors(self) -> Records:
        """Doors that were opened or closed, in the first frame all open ones: ``layouts.DOOR``."""
        return self._records(PacketId.DOORS)

    @property
    def wheels(self) -> tuple[WheelTurns, ...]:
        """Steering angle and rotation of the wheels of each vehicle."""
        return tuple(self.packets.get(PacketId.WHEELS, ()))

    @property
    def kinematics(self) -> Records:
        """Velocities (additional data): ``layouts.KINEMATICS``, m/s and degrees/s."""
        return self._records(PacketId.KINEMATICS)

    @property
    def boxes(self) -> Records:
        """Boxes of actors that came (additional data): ``layouts.BOX``, cm, local."""
        return self._records(PacketId.BOXES)

    @property
    def physics(self) -> tuple[PhysicsRecord, ...]:
        """What vehicles that came are made of (additional data)."""
        return tuple(self.packets.get(PacketId.PHYSICS, ()))

    @property
    def light_times(self) -> Records:
        """How long lights that came last (additional data): ``layouts.LIGHT_TIME``."""
        return self._records(PacketId.LIGHT_TIMES)

    @property
    def platform_time_s(self) -> float | None:
        """Time of the machine's clock since the recording began (additional data)."""
        return self.packets.get(PacketId.PLATFORM_TIME)
