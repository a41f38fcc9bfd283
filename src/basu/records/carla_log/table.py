"""Records of one kind over all frames of a recording, found by actor and frame in logarithmic time."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Rows(NamedTuple):
    """Some records with their frames, ascending."""

    frame: NDArray[np.int64]  # (N,) from 1
    rows: NDArray[np.void]  # (N,)


class Table:
    """Records in the file's order: ``frame`` (R,) from 1, ascending, and ``rows`` (R,)."""

    def __init__(self, frame: NDArray[np.int64], rows: NDArray[np.void]) -> None:
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

    def in_frame(self, frame: int) -> NDArray[np.void]:
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
