"""Least time to collision: how soon the ego and somebody else would have touched, had both gone on as they did."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from basu.metrics.passengers.boxes import other_boxes, own_boxes
from basu.metrics.passengers.near_misses import times_to_collision_s
from basu.scenarios.criteria.margins.margin import Margin

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.scenarios.criteria.margins.company import Company

HORIZON_S = 5.0


class LeastTtc(Margin):
    """The time to collision stays at ``at_least`` s or more.

    Hayward 1972, by oriented boxes, as ``basu.metrics.passengers.near_misses`` has it: each frame, both are moved on
    with the speeds they have, the ego on its present bend, the other straight ahead, until their boxes touch. It is
    measured up to 5 s. Two who both stand are in no danger.
    """

    called = "least time to collision"
    unit = "s"
    horizon = HORIZON_S

    def measure(self, with_whom: Company, rows: NDArray[np.int64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """From each row's frame on."""
        history = with_whom.history
        own, others = own_boxes(history.facts, history.frames), other_boxes(history.facts, history.others)
        found_s = times_to_collision_s(history, own, others, HORIZON_S)[rows]
        return found_s, history.others["tick"][rows].astype(np.int64)

    def words(self, value: float) -> str:
        """How long until both would have touched."""
        return f"was {value:.2f} s from a collision"
