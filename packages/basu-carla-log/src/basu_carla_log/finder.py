"""`Finder`: finds an actor by id or role in a recording, its records by frame, and their vectors and transforms."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from basu_carla_log import carla_values as values
from basu_carla_log.arrays import locations_m
from basu_carla_log.layouts import Kind

if TYPE_CHECKING:
    import carla
    from numpy.typing import NDArray

    from basu_carla_log.layouts import Physics
    from basu_carla_log.log import Log

Actor: TypeAlias = int | str  # an id, or a role name


class Finder:
    """Looks things up in one recording."""

    def __init__(self, log: Log) -> None:
        self._log = log

    def id(self, actor: Actor) -> int:
        """Return the actor's id; for a role name, the id of the first actor with that role.

        Raises:
            IndexError: no actor has the role. (ScenarioRunner's log fails here with an index, too.)
        """
        if not isinstance(actor, str):
            return actor
        found = self._log.ids_of(role_name=actor)
        if not found:
            roles = sorted({dict(one.attributes).get("role_name", "") for one in self._log.created} - {""})
            raise IndexError(f"no actor of the recording has the role '{actor}'; it has {', '.join(roles) or 'none'}")
        return found[0]

    def index(self, frame: int) -> int:
        """Where a frame's numbers stand.

        Raises:
            IndexError: there is no such frame.
        """
        if not 1 <= frame <= self._log.frames:
            raise IndexError(f"there is no frame {frame}: the recording's count from 1 to {self._log.frames}")
        return frame - 1

    def row(self, kind: Kind, actor: Actor, frame: int) -> np.void | None:
        """An actor's record in a frame."""
        self.index(frame)
        return self._log.table(kind).at(self.id(actor), frame)

    def last(self, kind: Kind, actor: Actor, frame: int) -> np.void | None:
        """An actor's latest record until a frame."""
        self.index(frame)
        table = self._log.table(kind)
        row = table.last(self.id(actor), frame)
        return None if row is None else table.rows[row]

    def vector(self, kind: Kind, column: str, actor: Actor, frame: int) -> carla.Vector3D | None:
        """Three numbers of a record."""
        row = self.row(kind, actor, frame)
        return None if row is None else values.vector(row[column])

    def transform(self, actor: Actor, frame: int) -> carla.Transform | None:
        """Where an actor is, m and degrees."""
        self.index(frame)
        positions = self._log.table(Kind.POSITIONS)
        row = positions.last(self.id(actor), frame)
        if row is None or positions.frame[row] != frame:
            return None
        return values.transform(self.locations_m[row], positions.rows["rotation_deg"][row])

    def physics(self, actor: Actor, frame: int) -> Physics | None:
        """A vehicle's parts, by the last record until a frame."""
        self.index(frame)
        wanted = self.id(actor)
        earlier = [made_of for made_of in self._log.physics if made_of.id == wanted and made_of.frame <= frame]
        return earlier[-1] if earlier else None

    def over(
        self, ask: Callable[[Actor, int], Any], actor: Actor, first_frame: int | None, last_frame: int | None
    ) -> list[Any]:
        """Answers for one actor, frame after frame, both ends included."""
        wanted = self.id(actor)
        first = 1 if first_frame is None else first_frame
        last = self._log.frames if last_frame is None else last_frame
        return [ask(wanted, frame) for frame in range(first, last + 1)]

    def among(self, ask: Callable[[Actor, int], Any], frame: int, actors: Iterable[int] | None) -> dict[int, Any]:
        """Values in one frame, by actor; an actor without one is left out."""
        self.index(frame)
        wanted = None if actors is None else set(actors)
        there = (int(row["id"]) for row in self._log.table(Kind.POSITIONS).in_frame(frame))
        answers = {actor: ask(actor, frame) for actor in there if wanted is None or actor in wanted}
        return {actor: answer for actor, answer in answers.items() if answer is not None}

    @cached_property
    def locations_m(self) -> NDArray[np.float32]:
        """(R, 3) the places of all records of positions."""
        return locations_m(self._log)

    @cached_property
    def actors(self) -> dict[int, dict[str, Any]]:
        """What is known of each actor: type, first place, frames, attributes, parent, boxes."""
        actors: dict[int, dict[str, Any]] = {}
        for one in self._log.created:
            actors[one.id] = {
                "type_id": one.type_id,
                "location": values.location(one.location_cm),
                "created": one.frame,
                **dict(one.attributes),
            }
        for kind, name, value in (
            (Kind.DESTROYED, "destroyed", None),
            (Kind.PARENTS, "parent", lambda row: int(row["parent_id"])),
            (Kind.BOXES, "bounding_box", values.box),
            (Kind.TRIGGER_VOLUMES, "trigger_volume", values.box),
        ):
            table = self._log.table(kind)
            for frame, row in zip(table.frame, table.rows, strict=True):
                if (actor := actors.get(int(row["id"]))) is not None:
                    actor[name] = int(frame) if value is None else value(row)
        return actors
