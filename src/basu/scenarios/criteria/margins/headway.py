"""Headway: the time that the ego keeps to who drives ahead of it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from basu.metrics.passengers.boxes import other_boxes, own_boxes
from basu.scenarios.criteria.margins.margin import Margin

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.scenarios.criteria.margins.company import Company

HORIZON_S = 10.0
MOVING_MPS = 3.0  # below this a queue moves up, and seconds say little
SAME_WAY_RAD = math.radians(45.0)


class KeepsHeadway(Margin):
    """The time gap to who drives ahead stays at ``at_least`` s or more.

    From the ego's front bumper to the leader's rear along the ego's heading, over the ego's speed (the time gap of ISO
    15622). Ahead is who overlaps the ego's width and heads the same way within 45 degrees. Frames count in which the
    ego drives faster than 3 m/s.
    """

    called = "headway"
    unit = "s"
    horizon = HORIZON_S

    def frames(self, with_whom: Company) -> NDArray[np.bool_]:
        """Those in which the ego drives."""
        return np.asarray(with_whom.history.speed_mps() > MOVING_MPS)

    def measure(self, with_whom: Company, rows: NDArray[np.int64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """In each row's frame; inf for who is not ahead."""
        history = with_whom.history
        rows_of = history.others[rows]
        ticks = rows_of["tick"].astype(np.int64)
        own, others = own_boxes(history.facts, history.frames)[ticks], other_boxes(history.facts, rows_of)
        cos, sin = np.cos(own[:, 2]), np.sin(own[:, 2])
        dx_m, dy_m = (others[:, :2] - own[:, :2]).T
        turned = np.abs(np.cos(others[:, 2] - own[:, 2])), np.abs(np.sin(others[:, 2] - own[:, 2]))
        reach_m = others[:, 3] * turned[0] + others[:, 4] * turned[1]
        aside_m = others[:, 3] * turned[1] + others[:, 4] * turned[0]
        gap_m = dx_m * cos + dy_m * sin - own[:, 3] - reach_m
        beside = np.abs(dy_m * cos - dx_m * sin) >= own[:, 4] + aside_m
        same_way = np.cos(others[:, 2] - own[:, 2]) >= math.cos(SAME_WAY_RAD)
        time_s = gap_m / history.speed_mps()[ticks]
        return np.where((gap_m >= 0.0) & ~beside & same_way & (time_s <= HORIZON_S), time_s, np.inf), ticks

    def words(self, value: float) -> str:
        """How long behind."""
        return f"was {value:.2f} s ahead"
