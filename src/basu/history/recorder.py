"""Collects a run's frames and events while it lasts; one cheap call a tick, packed once at the end."""

from __future__ import annotations

from array import array
from typing import TYPE_CHECKING

import numpy as np

from basu.history.model import FRAME, OTHER, Collision, Facts, History, LaneInvasion

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray


class Recorder:
    """Grows a history. Rows are kept as doubles: every column's values are exact in them."""

    def __init__(self) -> None:
        self._frames = array("d")
        self._others = array("d")
        self._collisions: list[Collision] = []
        self._lane_invasions: list[LaneInvasion] = []

    @property
    def ticks(self) -> int:
        """How many frames are recorded."""
        return len(self._frames) // len(_names(FRAME))

    def frame(self, row: Sequence[float]) -> None:
        """Add a frame: one number a column of ``FRAME``, in order."""
        assert len(row) == len(_names(FRAME)), "a row has one number a column"
        self._frames.extend(row)

    def others(self, rows: Iterable[Sequence[float]]) -> None:
        """Add who is near in the latest frame: one number a column of ``OTHER``, in order."""
        for row in rows:
            self._others.extend(row)

    def collision(self, event: Collision) -> None:
        """Add a contact; the order of arrival does not matter."""
        self._collisions.append(event)

    def lane_invasion(self, event: LaneInvasion) -> None:
        """Add a crossed marking; the order of arrival does not matter."""
        self._lane_invasions.append(event)

    def history(self, facts: Facts) -> History:
        """Pack what was recorded until now; events outside of the recorded frames are left out."""
        end = self.ticks
        return History(
            facts=facts,
            frames=_packed(self._frames, FRAME),
            others=_packed(self._others, OTHER),
            collisions=tuple(
                sorted(
                    (event for event in self._collisions if 0 <= event.tick < end),
                    key=lambda event: (event.tick, event.other_id, event.other_type, event.impulse_ns),
                )
            ),
            lane_invasions=tuple(
                sorted(
                    (event for event in self._lane_invasions if 0 <= event.tick < end),
                    key=lambda event: (event.tick, event.markings),
                )
            ),
        )


def _names(dtype: np.dtype[np.void]) -> tuple[str, ...]:
    """The columns of a packed type."""
    assert dtype.names is not None, "FRAME and OTHER have named columns"
    return dtype.names


def _packed(rows: array[float], dtype: np.dtype[np.void]) -> NDArray[np.void]:
    """Flat doubles, row after row, as a packed array."""
    names = _names(dtype)
    table = np.array(rows, dtype=np.float64).reshape(-1, len(names))
    packed = np.zeros(len(table), dtype=dtype)
    for column, name in enumerate(names):
        packed[name] = table[:, column]
    return packed
