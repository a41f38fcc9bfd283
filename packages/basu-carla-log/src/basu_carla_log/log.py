"""A recorder file as columns: one table for each kind of record, over all frames, read in one pass.

::

    log = read_log(Path("drive.log"))
    where = log.table(Kind.POSITIONS).of(log.ids_of(type_id="vehicle.*")[0])
    log.elapsed_s[where.frame - 1], where.rows["location_cm"] / 100.0
"""

from __future__ import annotations

import fnmatch
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.errors import UserError
from basu.records.structured import StructuredArray
from basu_carla_log.layouts import (
    MAGIC,
    RECORDS,
    VERSIONS,
    Created,
    DamageError,
    Kind,
    Physics,
    Reader,
    must_be,
)
from basu_carla_log.scan import Place, scan

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Rows(NamedTuple):
    """Some records with their frames, ascending."""

    frame: NDArray[np.int64]  # (N,) from 1
    rows: StructuredArray  # (N,)


class Table:
    """Records in the file's order: ``frame`` (R,) from 1, ascending, and ``rows`` (R,)."""

    def __init__(self, frame: NDArray[np.int64], rows: StructuredArray) -> None:
        self.frame, self.rows = frame, rows

    def __len__(self) -> int:
        return len(self.rows)

    def of(self, actor_id: int) -> Rows:
        """The records of an actor; none where it has none."""
        chosen = self.which(actor_id)
        return Rows(self.frame[chosen], self.rows[chosen])

    def which(self, actor_id: int) -> NDArray[np.int64]:
        """(N,) which rows are an actor's, frames ascending."""
        begin, end = self._span_of.get(actor_id, (0, 0))
        return self._by_actor[begin:end]

    def at(self, actor_id: int, frame: int) -> np.void | None:
        """The record of an actor in a frame."""
        index = self.last(actor_id, frame)
        return None if index is None or self.frame[index] != frame else self.rows[index]

    def last(self, actor_id: int, frame: int) -> int | None:
        """Which row is the actor's last until a frame, that one included."""
        begin, end = self._span_of.get(actor_id, (0, 0))
        place = begin + int(np.searchsorted(self._frame_by_actor[begin:end], frame, side="right")) - 1
        return None if place < begin else int(self._by_actor[place])

    def in_frame(self, frame: int) -> StructuredArray:
        """The records of a frame, in the file's order."""
        begin, end = np.searchsorted(self.frame, [frame, frame + 1])
        return self.rows[begin:end]

    @cached_property
    def _by_actor(self) -> NDArray[np.int64]:
        """(R,) rows, an actor after the other, frames ascending within each."""
        return np.argsort(self.rows["id"], kind="stable")

    @cached_property
    def _frame_by_actor(self) -> NDArray[np.int64]:
        return self.frame[self._by_actor]

    @cached_property
    def _span_of(self) -> dict[int, tuple[int, int]]:
        """Where in ``_by_actor`` each actor's rows stand."""
        ids, begins, counts = np.unique(self.rows["id"][self._by_actor], return_index=True, return_counts=True)
        spans = zip(ids.tolist(), begins.tolist(), counts.tolist(), strict=True)
        return {actor: (begin, begin + count) for actor, begin, count in spans}


_VERSION, _DATE = struct.Struct("<H"), struct.Struct("<q")


@dataclass(frozen=True, slots=True, kw_only=True)
class Log:
    """A recording. Frames count from 1, as in ScenarioRunner; arrays have one element a frame, (F,)."""

    path: Path
    version: int
    map_name: str
    begun_unix_s: int
    duration_s: NDArray[np.float64]  # of a frame; -1 in the last of a recording that was closed
    elapsed_s: NDArray[np.float64]  # simulated time since the recording began
    platform_s: NDArray[np.float64]  # likewise, the machine's clock; nan without additional data
    tables: Mapping[Kind, Table]
    created: tuple[Created, ...]
    physics: tuple[Physics, ...]
    unread: Mapping[int, int]  # packets no query asks for: how many by their number
    problem: str | None  # what of the file is missing here, in a sentence

    @property
    def frames(self) -> int:
        """How many whole frames there are."""
        return len(self.elapsed_s)

    def table(self, kind: Kind) -> Table:
        """The records of a kind; empty where the file has none."""
        return self.tables[kind]

    def ids_of(self, *, role_name: str | None = None, type_id: str = "*") -> tuple[int, ...]:
        """Ids of actors in the order in which they came; ``type_id`` as ``fnmatch`` has it."""
        return tuple(
            dict.fromkeys(
                actor.id
                for actor in self.created
                if (role_name is None or dict(actor.attributes).get("role_name") == role_name)
                and fnmatch.fnmatch(actor.type_id, type_id)
            )
        )


def read_log(path: Path) -> Log:
    """Read a recorder file as far as it is whole; ``problem`` of the answer names the rest.

    Raises:
        UserError: it cannot be opened, or is no recorder file, or has no whole frame.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise UserError(f"{path} cannot be read: {error.strerror}; name a recorder file (.log)") from error
    version, begun, map_name, at = _header(data, path)
    contents, damage = scan(data, at)
    whole = len(contents.starts)
    if not whole:
        raise UserError(f"{path} has no whole frame{'' if damage is None else f': {damage}'}; record it again")
    starts = np.array([start[1:] for start in contents.starts], dtype=np.float64)
    return Log(
        path=path,
        version=version,
        map_name=map_name,
        begun_unix_s=begun,
        duration_s=starts[:, 0],
        elapsed_s=starts[:, 1],
        platform_s=np.array(contents.platform_s),
        tables={kind: _table(data, kind, places) for kind, places in contents.places.items()},
        created=tuple(contents.created),
        physics=tuple(contents.physics),
        unread=dict(sorted(contents.unread.items())),
        problem=None if damage is None else f"{path}: {damage}; it was read up to frame {whole}",
    )


def _header(data: bytes, path: Path) -> tuple[int, int, str, int]:
    """Version, date, map and where the frames begin."""
    reader = Reader(data, 0, len(data))
    try:
        (version,) = reader.take(_VERSION)
        magic = reader.raw_text()
        must_be(magic == MAGIC, f"{MAGIC.decode()} should stand at its beginning, not {magic[:20]!r}")
        if version not in VERSIONS:
            raise UserError(f"{path} is a recorder file of version {int(version)}; this program reads 1 and 2")
        (begun,) = reader.take(_DATE)
        return int(version), int(begun), reader.text(), reader.at
    except DamageError as error:
        raise UserError(f"{path} is no recorder file of CARLA: {error}") from None


def _table(data: bytes, kind: Kind, places: list[Place]) -> Table:
    """All records of a kind, with the frame of each."""
    layout = RECORDS[kind]
    content = b"".join(data[place.start : place.start + place.records * layout.itemsize] for place in places)
    frames = np.repeat([place.frame for place in places], [place.records for place in places]).astype(np.int64)
    return Table(frames, np.frombuffer(content, layout))
