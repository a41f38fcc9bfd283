"""Notices who drives up close behind."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from basu.agents.builtin.scene import Kind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.agents.builtin.driving.path import Path, Place
    from basu.agents.builtin.scene import Body, Ego, Other

LEAST_MPS = 2.0  # nobody tailgates one who hardly moves
BEHIND_M = 40.0
SAME_WAY_RAD = math.radians(45.0)
NOTICED_S = 1.0  # it has to go on for so long …
FORGOTTEN_S = 3.0  # … and is over after so long


class Tailgating:
    """Whether somebody follows at less than ``near_s`` seconds; 0: one does not care."""

    def __init__(self, body: Body, near_s: float) -> None:
        self.is_on = False
        self._body = body
        self._near_s = near_s
        self._changed_s: float | None = None

    def step(self, ego: Ego, path: Path, place: Place, others: Sequence[Other]) -> bool:
        """Look behind; the answer changes only after a while."""
        seen = (
            self._near_s > 0.0 and ego.speed_mps > LEAST_MPS and any(self._is_one(ego, path, place, o) for o in others)
        )
        if seen == self.is_on:
            self._changed_s = None
            return self.is_on
        self._changed_s = ego.time_s if self._changed_s is None else self._changed_s
        if ego.time_s - self._changed_s >= (NOTICED_S if seen else FORGOTTEN_S):
            self.is_on, self._changed_s = seen, None
        return self.is_on

    def _is_one(self, ego: Ego, path: Path, place: Place, other: Other) -> bool:
        """Whether one other follows too closely in our lane."""
        if other.kind is not Kind.VEHICLE or other.speed_mps < LEAST_MPS:
            return False
        dx_m, dy_m = other.x_m - ego.x_m, other.y_m - ego.y_m
        if dx_m * dx_m + dy_m * dy_m > BEHIND_M * BEHIND_M:
            return False
        behind = dx_m * math.cos(ego.yaw_rad) + dy_m * math.sin(ego.yaw_rad) < 0.0
        if not behind or abs(math.remainder(other.yaw_rad - ego.yaw_rad, math.tau)) > SAME_WAY_RAD:
            return False
        there = path.follow(other.x_m, other.y_m, place.near)
        if abs(there.lateral_m) > self._body.half_width_m + other.half_width_m:
            return False
        gap_m = place.s_m - self._body.rear_m - there.s_m - other.half_length_m
        return gap_m < self._near_s * ego.speed_mps
