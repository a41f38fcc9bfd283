"""The forward agent: presses the throttle and never steers. What does a driver score that looks at nothing?"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import carla

from basu.agents.autonomous_agent import AutonomousAgent

if TYPE_CHECKING:
    from collections.abc import Mapping

THROTTLE = 0.9  # as the sample agent of the thesis, figure 4.9


class ForwardAgent(AutonomousAgent):
    """Drives straight ahead until something stops it."""

    def setup(self) -> None:
        """Nothing to get ready."""

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        """Full ahead, whatever the sensors say."""
        del sensor_data
        return carla.VehicleControl(throttle=THROTTLE)

    def config(self) -> dict[str, str]:
        """The route, sensors, car and weather of the thesis's test runs."""
        return {
            "routes": "data/route_linden.xml",
            "sensors": "config/sensors.json",
            "vehicle": "vehicle.tesla.model3",
            "weather": "ClearSunset",
        }
