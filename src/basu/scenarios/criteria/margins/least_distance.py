"""Least distance: how near the ego's box came to that of anybody else."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from basu.metrics.passengers.boxes import other_boxes, own_boxes
from basu.scenarios.criteria.margins.gap import gap_m
from basu.scenarios.criteria.margins.margin import Margin

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.scenarios.criteria.margins.company import Company

MOVING_MPS = 0.1


class LeastDistance(Margin):
    """The ego's box stays ``at_least`` m away from the boxes of others, seen from above.

    With ``while_moving`` only frames count in which the ego moved: who comes close to a vehicle at rest has done so
    alone. The rest is as for every `Margin`.
    """

    called = "least distance"
    unit = "m"

    def __init__(
        self,
        at_least: float | None = None,
        *,
        to: str | None = None,
        since: str | None = None,
        while_moving: bool = False,
        deciding: bool = True,
    ) -> None:
        super().__init__(at_least, to=to, since=since, deciding=deciding)
        self.while_moving = while_moving

    def frames(self, with_whom: Company) -> NDArray[np.bool_]:
        """All, or those in which the ego moved."""
        speed_mps = with_whom.history.speed_mps()
        return np.asarray(speed_mps > MOVING_MPS) if self.while_moving else np.ones(len(speed_mps), dtype=np.bool_)

    def measure(self, with_whom: Company, rows: NDArray[np.int64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Between the boxes in each row's frame."""
        history = with_whom.history
        others = history.others[rows]
        own = own_boxes(history.facts, history.frames)[others["tick"]]
        return gap_m(own, other_boxes(history.facts, others)), others["tick"].astype(np.int64)

    def words(self, value: float) -> str:
        """How far away."""
        return f"was {value:.2f} m away"
