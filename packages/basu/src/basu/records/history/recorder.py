"""Collects a run's frames and events while it lasts; one cheap call a tick, packed on request."""

from __future__ import annotations

from array import array
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from basu.records.history.model import CONTROL, FRAME, OTHER, Collision, Facts, History, LaneInvasion
from basu.records.structured import StructuredArray

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence


MIXED_TICKS = 20  # events of frames no farther apart than this may come in any order


class Recorder:
    """Grows a history. Rows are kept as doubles: every column's values are exact in them."""

    def __init__(self) -> None:
        self._frames = array("d")  # frames that are not packed yet
        self._packed = np.zeros(0, dtype=FRAME)  # packed frames, and room for more
        self._packed_ticks = 0
        self._others = array("d")
        self._collisions: list[Collision] = []
        self._lane_invasions: list[LaneInvasion] = []

    @property
    def ticks(self) -> int:
        """How many frames are recorded."""
        return self._packed_ticks + len(self._frames) // len(_names(FRAME))

    def frame(self, row: Sequence[float]) -> None:
        """Add a frame: one number a column of ``FRAME``, in order."""
        assert len(row) == len(_names(FRAME)), "a row has one number a column"
        self._frames.extend(row)

    def applied(self, values: Sequence[float]) -> None:
        """Set the applied control of the latest frame: one number for each of ``CONTROL``; may be called again."""
        names = [f"applied_{name}" for name in CONTROL]
        if len(self._frames):
            first = len(self._frames) - len(_names(FRAME)) + _names(FRAME).index(names[0])
            self._frames[first : first + len(names)] = array("d", values)
        else:
            for name, value in zip(names, values, strict=True):
                self._packed[name][self._packed_ticks - 1] = value

    def others(self, rows: Iterable[Sequence[float]]) -> None:
        """Add an actor near in the latest frame: one number a column of ``OTHER``, in order."""
        for row in rows:
            self._others.extend(row)

    def collision(self, event: Collision) -> None:
        """Add a contact; the order of arrival does not matter."""
        self._collisions.append(event)

    def lane_invasion(self, event: LaneInvasion) -> None:
        """Add a crossed marking; the order of arrival does not matter."""
        self._lane_invasions.append(event)

    def history(self, facts: Facts) -> History:
        """What was recorded until now; events outside of the recorded frames are left out."""
        end = self.ticks
        return History(
            facts=facts,
            frames=self._all_frames().copy(),
            others=_packed(self._others, OTHER),
            collisions=self.contacts_since(0),
            lane_invasions=tuple(
                sorted(
                    (event for event in self._lane_invasions if 0 <= event.tick < end),
                    key=lambda event: (event.tick, event.markings),
                )
            ),
        )

    def window(self, first: int, facts: Facts) -> History:
        """The frames from ``first`` on and the contacts in them; ticks count from there.

        It holds neither other actors nor lane invasions, and costs no more than what is new since the last call: for
        repeated use while the run lasts. Its frames must not be written to.
        """
        contacts = (replace(event, tick=event.tick - first) for event in self.contacts_since(first))
        return History(
            facts=facts,
            frames=self._all_frames()[first:],
            others=np.zeros(0, dtype=OTHER),
            collisions=tuple(contacts),
            lane_invasions=(),
        )

    def _all_frames(self) -> StructuredArray:
        """(T,) every frame, packed; rows that are there stay as they are."""
        fresh = _packed(self._frames, FRAME)
        if len(fresh):
            end = self._packed_ticks + len(fresh)
            if end > len(self._packed):
                room = np.zeros(2 * end, dtype=FRAME)  # doubled, so that all the copying together is linear
                room[: self._packed_ticks] = self._packed[: self._packed_ticks]
                self._packed = room
            self._packed[self._packed_ticks : end] = fresh
            self._packed_ticks = end
            self._frames = array("d")
        return self._packed[: self._packed_ticks]

    def contacts_since(self, first: int) -> tuple[Collision, ...]:
        """Messages of the collision sensor from a tick on, in order; those outside of recorded frames are left out."""
        end = self.ticks
        later = []
        for event in reversed(self._collisions):  # they come in nearly in order: those of one second may be mixed
            if event.tick < first - MIXED_TICKS:
                break
            if max(0, first) <= event.tick < end:
                later.append(event)
        return tuple(sorted(later, key=lambda event: (event.tick, event.other_id, event.other_type, event.impulse_ns)))


def _names(dtype: np.dtype[np.void]) -> tuple[str, ...]:
    """The columns of a packed type."""
    assert dtype.names is not None, "FRAME and OTHER have named columns"
    return dtype.names


def _packed(rows: array[float], dtype: np.dtype[np.void]) -> StructuredArray:
    """Flat doubles, row after row, as a packed array."""
    names = _names(dtype)
    table = np.array(rows, dtype=np.float64).reshape(-1, len(names))
    packed = np.zeros(len(table), dtype=dtype)
    for column, name in enumerate(names):
        packed[name] = table[:, column]
    return packed
