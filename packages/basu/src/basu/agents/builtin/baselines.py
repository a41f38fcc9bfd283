"""Baseline agents for comparison: blind, creeper, standing and forward perceive no other actor.

They are controls for the judgement, not drivers to compete with. `docs/decisions/0055-control-drivers.md` states what
each of them proves.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import carla

from basu.agents.autonomous_agent import AutonomousAgent
from basu.agents.builtin.basic import BasicAgent
from basu.agents.builtin.driving.controllers import HOLD_BRAKE
from basu.agents.sight import Knowledge

if TYPE_CHECKING:
    from collections.abc import Mapping


CREEP_MPS = 2.0


class BlindAgent(BasicAgent):
    """The basic agent without other actors: it keeps lanes, limits, lights and signs, and brakes for nothing else."""

    knowledge = Knowledge.NONE


class CreeperAgent(BlindAgent):
    """The blind agent at 2 m/s: what it survives, it survives by slowness."""

    cruise_mps = CREEP_MPS


class StandingAgent(BlindAgent):
    """The blind agent with its brake on: what it survives, it survives by staying away."""

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        """Return the same braking control at each step."""
        del sensor_data
        return carla.VehicleControl(brake=HOLD_BRAKE)


THROTTLE = 0.9  # as the sample agent of the thesis, figure 4.9


class ForwardAgent(AutonomousAgent):
    """Drives straight ahead until something stops it."""

    def setup(self) -> None:
        """Do nothing, because this agent needs no preparation."""

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        """Return full throttle, whatever the sensors measure."""
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
