"""The conditions and the reference point that the agents of both generations of Autoware share."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.agents.builtin.perception import SHUTTLE
from basu_ros.agents.lockstep import LockstepAgent

if TYPE_CHECKING:
    from basu.agents.builtin.perception import VehicleFacts


class AutowareBase(LockstepAgent):
    """An agent with an Autoware as its software."""

    def config(self) -> dict[str, str]:
        """The shuttle on its round, with a lidar."""
        return {
            "routes": "routes/linden_leap.xml",
            "sensors": "config/autoware_sensors.json",
            "vehicle": SHUTTLE,
            "weather": "ClearNoon",
        }

    def axle_m(self, facts: VehicleFacts) -> float:
        """Return how far the rear axle, Autoware's base_link, lies behind the vehicle's origin."""
        return facts.body.rear_axle_m
