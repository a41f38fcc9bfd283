"""A tailgater: drive behind the ego along its route."""

from __future__ import annotations

import math
from collections import deque
from typing import TYPE_CHECKING

from basu.scenarios.actions.puppet import LOOK_M, Limits, Puppet
from basu.scenarios.stage import EGO

if TYPE_CHECKING:
    from basu.scenarios.paths import Path

CLOSE_PER_S = 0.6  # of what the gap is off, made good in a second


class FollowEgo(Puppet):
    """Lead a vehicle behind the ego on a path, ``gap_m`` from bumper to bumper, for ``for_s`` seconds.

    It answers to what the ego did ``reaction_s`` before, so that a stop without cause may be too much for it.
    """

    def __init__(
        self,
        actor: str,
        path: Path,
        gap_m: float,
        for_s: float = math.inf,
        *,
        reaction_s: float = 0.0,
        top_mps: float = 15.0,
        accelerate_mps2: float = 2.5,
        brake_mps2: float = 6.0,
    ) -> None:
        super().__init__(
            f"{actor} follows the ego at {gap_m:g} m", actor, path, limits=Limits(accelerate_mps2, brake_mps2)
        )
        self.gap_m, self.for_s, self.reaction_s, self.top_mps = gap_m, for_s, reaction_s, top_mps

    def begin(self) -> None:
        """Begin to watch the ego."""
        super().begin()
        self.began_s = self.stage.time_s
        self.seen: deque[tuple[float, float]] = deque(maxlen=1 + round(self.reaction_s / self.stage.step_s))

    def wanted_mps(self) -> float:
        """The ego's speed as it was seen, and more or less as the gap is too wide or too narrow."""
        ego, body = self.stage.body(EGO), self.stage.body(self.actor)
        place_m = self.path.nearest(ego.x_m, ego.y_m, self.s_m, LOOK_M).s_m
        self.seen.append((place_m - self.s_m - ego.half_length_m - body.half_length_m, ego.forward_mps))
        gap_m, ego_mps = self.seen[0]
        return min(max(0.0, ego_mps + CLOSE_PER_S * (gap_m - self.gap_m)), self.top_mps)

    def over(self) -> str | None:
        """When the time is over or the path ends."""
        if self.stage.time_s - self.began_s >= self.for_s - 1e-6:
            return f"followed for {self.for_s:g} s"
        return super().over()
