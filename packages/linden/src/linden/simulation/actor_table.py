"""The table of actors: descriptions, parents, and the packed rows that the snapshot carries."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linden.blueprints.library import BlueprintKind
from linden.errors import Refusal
from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.enums import ActorState
from linden.protocol.values.snapshot import ROW
from linden.protocol.values.space import BoundingBox, Rotation, Transform, Vector3D
from linden.structured import StructuredArray

NO_BODY = -1
"""Slot of an actor that occupies no space."""


_LARGEST_WISH = 2**30
"""Ids wished for end here; those counted go on behind the largest, for the life of the server, and have 31 bits."""


class ActorRefusal(Refusal):
    """A call names an actor that cannot take it; the reason is worded as CARLA's server words it."""

    def __init__(self, reason: str, actor_id: int) -> None:
        super().__init__(f"{reason}.  Actor Id: {actor_id}")  # two spaces: so CarlaServer.cpp, and scripts match on it


@dataclass(slots=True)
class ActorRecord:
    """What is known of one actor beside its motion."""

    id: int
    description: ActorDescription
    kind: BlueprintKind
    box: BoundingBox
    semantic_tags: bytes
    parent_id: int = 0
    slot: int = NO_BODY
    stream_id: int = 0
    light_state: int = 0


class ActorTable:
    """Actors in the order in which they came.

    Attributes:
        pose: (capacity, 6) x, y, z in m and pitch, yaw, roll in degrees, in the world.
        relative: (capacity, 6) likewise in the parent's frame; read where ``parent_row`` is not -1.
        parent_row: (capacity,) row of the parent, which always stands further up, or -1.
        slot: (capacity,) row in the bodies, or ``NO_BODY``.
        rows: (capacity,) the packed rows of the snapshot; the first ``len(table)`` are meant.
    """

    def __init__(self, first_id: int = 1) -> None:
        """Begin without actors; the ids are counted from ``first_id`` on."""
        self._records: dict[int, ActorRecord] = {}
        self._row_of: dict[int, int] = {}
        self._by_slot: dict[int, ActorRecord] = {}
        self._next_id = first_id
        self._wish = 0
        self._dying: list[int] = []
        self._told: list[int] = []
        self._leaving: list[int] = []  # rows that go with the next frame: all at once, so that each costs little
        self._children: dict[int, dict[int, ActorRecord]] = {}
        self.version = 0
        """Grows whenever an actor comes or goes, so that what is derived from the set can be kept until then."""
        self._lamps: tuple[int, list[tuple[int, int]]] | None = None  # with the version they were listed in
        self._allocate(256)

    def _allocate(self, capacity: int) -> None:
        self.rows: StructuredArray = np.zeros(capacity, ROW)
        self.pose = np.zeros((capacity, 6))
        self.relative = np.zeros((capacity, 6))
        self.parent_row = np.full(capacity, -1, np.int32)
        self.slot = np.full(capacity, NO_BODY, np.int32)

    def _columns(self) -> tuple[NDArray[np.generic], ...]:
        return (self.rows, self.pose, self.relative, self.parent_row, self.slot)

    def __len__(self) -> int:
        return len(self._row_of)

    def __iter__(self) -> Iterator[ActorRecord]:
        return iter(self._records.values())

    def __contains__(self, actor_id: int) -> bool:
        return actor_id in self._records

    def find(self, actor_id: int) -> ActorRecord | None:
        """Return the actor, None where there is none."""
        return self._records.get(actor_id)

    def get(self, actor_id: int) -> ActorRecord:
        """Return the actor with an id.

        Raises:
            ActorRefusal: there is none of that id.
        """
        record = self._records.get(actor_id)
        if record is None:
            raise ActorRefusal("Actor could not be found in the registry", actor_id)
        return record

    def set_lamps(self, actor_id: int, bits: int) -> None:
        """Switch a vehicle's lamps, as bits of VehicleLightState.

        Raises:
            ActorRefusal: there is none of that id.
        """
        record = self.get(actor_id)
        if record.light_state != bits:
            record.light_state, self._lamps = bits, None

    def lamps(self) -> list[tuple[int, int]]:
        """Return id and lamps of every vehicle; a Traffic Manager asks for them in each step."""
        if self._lamps is None or self._lamps[0] != self.version:
            self._lamps = (
                self.version,
                [(each.id, each.light_state) for each in self if each.kind is BlueprintKind.VEHICLE],
            )
        return self._lamps[1]

    def of_slot(self, slot: int) -> ActorRecord:
        """Return the actor with its body in a slot."""
        return self._by_slot[slot]

    def row(self, actor_id: int) -> int:
        """Return the row of a living actor."""
        return self._row_of[actor_id]

    @contextmanager
    def preferring(self, actor_id: int) -> Iterator[None]:
        """Give this id to the next actor in the block, if the id is free; so replayed actors keep their ids."""
        if actor_id in self._leaving:
            self._drop_leaving()
        is_free = 0 < actor_id <= _LARGEST_WISH and actor_id not in self._records and actor_id not in self._row_of
        self._wish = actor_id if is_free else 0
        try:
            yield
        finally:
            self._wish = 0

    @property
    def first_free_id(self) -> int:
        """The id from which on none was ever used; the next episode's table begins there."""
        return self._next_id

    def next_id(self) -> int:
        """Return an id never used before, or the one that :meth:`preferring` asks for."""
        if self._wish:
            wish, self._wish = self._wish, 0
            self._next_id = max(self._next_id, wish + 1)
            return wish
        self._next_id += 1
        return self._next_id - 1

    def add(self, record: ActorRecord, pose: Transform, relative: Transform | None = None) -> None:
        """Put an actor into the table; ``relative`` is its pose in its parent's frame, where it has one."""
        if len(self) == len(self.rows) and self._leaving:
            self._drop_leaving()
        if len(self) == len(self.rows):
            old, count = self._columns(), len(self)
            self._allocate(2 * count)
            for new, column in zip(self._columns(), old, strict=True):
                new[:count] = column
        row = len(self)
        self._records[record.id] = record
        self._row_of[record.id] = row
        self.rows[row] = np.zeros((), ROW)
        self.rows["id"][row] = record.id
        self.rows["actor_state"][row] = ActorState.ACTIVE
        self.pose[row] = (*pose.location, *pose.rotation)
        self.slot[row] = record.slot
        self.parent_row[row] = -1
        if record.slot != NO_BODY:
            self._by_slot[record.slot] = record
        if record.parent_id:
            self._children.setdefault(record.parent_id, {})[record.id] = record
        if relative is not None:
            self.relative[row] = (*relative.location, *relative.rotation)
            self.parent_row[row] = self._row_of[record.parent_id]
        self.version += 1

    def children(self, actor_id: int) -> list[ActorRecord]:
        """Return the actors attached to this one, oldest first."""
        return list(self._children.get(actor_id, {}).values())

    def detach(self, actor_id: int) -> None:
        """Let an actor follow its parent no more; it stays where the last step or call put it."""
        record = self._records[actor_id]
        self._drop_child(record)
        record.parent_id = 0
        self.parent_row[self._row_of[actor_id]] = -1
        self.version += 1

    def _drop_child(self, record: ActorRecord) -> None:
        siblings = self._children.get(record.parent_id, {})
        siblings.pop(record.id, None)
        if not siblings:
            self._children.pop(record.parent_id, None)

    def remove(self, actor_id: int, *, announce: bool) -> ActorRecord:
        """Take an actor out; ``announce`` leaves its row, marked as killed, in the next frame's snapshot.

        The client that destroyed an actor knows it. Other clients with a handle learn it from such a row only.
        """
        record = self._records.pop(actor_id)
        if record.slot != NO_BODY:
            del self._by_slot[record.slot]
        self._drop_child(record)
        row = self._row_of[actor_id]
        self.rows["actor_state"][row] = ActorState.PENDING_KILL
        self.slot[row] = NO_BODY
        self.parent_row[row] = -1
        (self._dying if announce else self._leaving).append(actor_id)
        self.version += 1
        return record

    def turn_page(self) -> None:
        """Begin a frame: drop actors that the last snapshot marked as destroyed; mark those destroyed since then."""
        self._leaving += self._told
        if self._leaving:
            self._drop_leaving()
        self._told, self._dying = self._dying, []

    def _drop_leaving(self) -> None:
        """Close the gaps of removed actors in the rows."""
        actor_ids, self._leaving = self._leaving, []
        self.version += 1
        count = len(self)
        kept = np.ones(count, bool)
        kept[[self._row_of[actor_id] for actor_id in actor_ids]] = False
        new_row = np.cumsum(kept, dtype=np.int32) - 1
        remaining = int(kept.sum())
        for column in self._columns():
            column[:remaining] = column[:count][kept]
        attached = self.parent_row[:remaining] >= 0
        self.parent_row[:remaining][attached] = new_row[self.parent_row[:remaining][attached]]
        gone = set(actor_ids)
        self._row_of = {i: int(new_row[row]) for i, row in self._row_of.items() if i not in gone}

    def transform(self, actor_id: int) -> Transform:
        """Return where an actor is in the world, as of the last step or of the last call that moved it."""
        x, y, z, pitch, yaw, roll = map(float, self.pose[self._row_of[actor_id]])
        return Transform(Vector3D(x, y, z), Rotation(pitch, yaw, roll))

    def relative_transform(self, actor_id: int) -> Transform:
        """Return where an attached actor is in its parent's frame."""
        x, y, z, pitch, yaw, roll = map(float, self.relative[self._row_of[actor_id]])
        return Transform(Vector3D(x, y, z), Rotation(pitch, yaw, roll))

    def place(self, actor_id: int, pose: Transform) -> None:
        """Move an actor without a body: in the world, or in its parent's frame where it has one."""
        row = self._row_of[actor_id]
        column = self.pose if self.parent_row[row] < 0 else self.relative
        column[row] = (*pose.location, *pose.rotation)
