"""Yielding: an emergency vehicle that came from behind is in front of the ego at the end."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from basu.metrics.leaderboard.scenario_events import YIELDS
from basu.scenarios.criteria.criterion import Aspect, Criterion

if TYPE_CHECKING:
    from basu.scenarios.criteria.criterion import Judgement, Played


class YieldsToEmergencyVehicle(Criterion):
    """The emergency vehicle ``role`` has passed the ego when the scenario ends, or when the run ends before it.

    Source: ``YieldToEmergencyVehicleTest`` in ``atomic_criteria.py`` of carla-simulator/scenario_runner, branch
    leaderboard-2.0: the agent must not be ahead of the vehicle, seen along the vehicle's own direction. The record has
    the vehicle within 60 m of the ego, so its last recorded frame decides.
    """

    aspect = Aspect.COMPLETED
    name = YIELDS

    def __init__(self, role: str, *, deciding: bool = True) -> None:
        super().__init__(deciding=deciding)
        self.role = role

    def judge(self, played: Played) -> Judgement:
        """The figure is how far the ego's middle was ahead of the vehicle's, in m along the vehicle's direction."""
        ids = [actor for actor, role in played.roles.items() if role == self.role]
        rows = played.history.others[[other in ids for other in played.history.others["id"].tolist()]]
        limit = "at most 0 m"
        if len(rows) == 0:
            return self.says(played, None, f"{self.role} never came near", unit="m", limit=limit)
        vehicle = rows[-1]
        tick = int(vehicle["tick"])
        ego = played.history.frames[tick]
        yaw_rad = float(vehicle["yaw_rad"])
        ahead_m = float(ego["x_m"] - vehicle["x_m"]) * math.cos(yaw_rad) + float(
            ego["y_m"] - vehicle["y_m"]
        ) * math.sin(yaw_rad)
        passed = ahead_m <= 0.0
        where = f"{self.role} was {abs(ahead_m):.1f} m {'ahead of' if passed else 'behind'} the ego"
        sentence = f"{where} at {float(ego['t_s']):.2f} s{'' if passed else ': the ego did not let it pass'}"
        return self.says(played, passed, sentence, tick=tick, measured=ahead_m, unit="m", limit=limit, other=self.role)
