"""Post-encroachment time: how long between one's leaving a place that both took and the other's coming to it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from basu.metrics.passengers.boxes import other_boxes, own_boxes
from basu.metrics.passengers.near_misses import CROSSING_RAD, STILL_MPS, post_encroachment_s
from basu.scenarios.criteria.margins.margin import Margin

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.scenarios.criteria.margins.company import Company

HORIZON_S = 5.0  # with which the Surrogate Safety Assessment Model screens


class Pet(Margin):
    """The post-encroachment time stays at ``at_least`` s or more.

    Allen, Shin and Cooper 1978, over the places that both boxes swept: the least over all of them, as the Surrogate
    Safety Assessment Model (FHWA-HRT-08-051) takes it, to a frame. Only where the ways cross at 30 degrees or more, for
    who follows in a lane takes the same places all the time. It is measured up to 5 s; the frame told is that in which
    the second of the two came to the place.
    """

    called = "post-encroachment time"
    unit = "s"
    horizon = HORIZON_S

    def measure(self, with_whom: Company, rows: NDArray[np.int64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """From each row's place to the ego's being there, before or after."""
        history = with_whom.history
        own, others = own_boxes(history.facts, history.frames), other_boxes(history.facts, history.others)
        found_s, later = post_encroachment_s(history, own, others, HORIZON_S)
        return found_s[rows], later[rows]

    def touched(self, with_whom: Company, rows: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Only who was coming across the ego's way: not who was run into from behind, and not who stood."""
        history = with_whom.history
        others = history.others[rows]
        came = history.others[np.hypot(history.others["velocity_x_mps"], history.others["velocity_y_mps"]) > STILL_MPS]
        just_before = set(zip((came["tick"] + 1).tolist(), came["id"].tolist(), strict=True))
        pairs = zip(others["tick"].tolist(), others["id"].tolist(), strict=True)
        moving = np.array([pair in just_before for pair in pairs], dtype=np.bool_)
        off_rad = others["yaw_rad"] - history.frames["yaw_rad"][others["tick"]]
        crossing = np.asarray(np.abs(np.sin(off_rad)) >= math.sin(CROSSING_RAD), dtype=np.bool_)
        return super().touched(with_whom, rows) & crossing & moving

    def never(self) -> str:
        """That no way was crossed."""
        return f"nobody crossed its way within {self.horizon:g} s"

    def words(self, value: float) -> str:
        """How long between the two."""
        return f"and the ego took the same place {value:.2f} s apart"
