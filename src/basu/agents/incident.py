"""The incident of 20 February 2020: drives like the basic agent, and stops hard over a small deviation of its steering.

What is known (Smart Columbus, review of 15 May 2020; Washington Post, 29 February 2020): the shuttle drove at 7.1 mph,
stopped by itself, suddenly, because of a small steering deviation; a passenger slid to the floor, the operator was thrown
off his feet. Not known are the place, the size of the deviation and how hard the stop was. They are set here: a straight
piece of the short route where nothing is ahead, a wheel that stands 0.01 of its full lock away from where it was told to,
for less than half a second, and 3.5 m/s², the middle of what such a vehicle's emergency stop is taken to be.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import carla

from basu.agents.basic import BasicAgent
from basu.agents.driving.longitudinal import HOLD_BRAKE
from basu.agents.vehicle_facts import SHUTTLE

if TYPE_CHECKING:
    from collections.abc import Mapping

    from basu.agents.driving.driver import Driver
    from basu.agents.vehicle_facts import VehicleFacts

CRUISE_MPS = 7.1 * 0.44704
KICK_S_M = 600.0  # along the route, where the wheel is kicked: 90 m before the next line, 85 m after the last bend
KICK_STEER, KICK_S = 0.01, 0.4
TOLERATED_STEER = 0.005  # a deviation above this is taken for a failure
STOP_MPS2 = 3.5
STANDING_S = 10.0  # until the operator has looked round and goes on
AT_REST_MPS = 0.05


class IncidentAgent(BasicAgent):
    """The basic agent, no faster than the shuttle was that day, with a nervous watchdog between it and the wheels."""

    def setup(self) -> None:
        """Nothing has happened yet."""
        super().setup()
        self._kick_left = 0  # steps for which the wheel is still off
        self._kicked = False
        self._stopping = False
        self._standing = 0  # steps at rest since the stop

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        """Drive; see to it that the wheel does what it was told to, and stop where it does not."""
        if self._stopping:
            return self._stop()
        told = super().run_step(sensor_data)
        control = carla.VehicleControl(throttle=told.throttle, brake=told.brake, steer=told.steer + self._kick())
        if abs(control.steer - told.steer) > TOLERATED_STEER:
            self._stopping = True
        return control

    def config(self) -> dict[str, str]:
        """The shuttle on the short route, in February."""
        return {
            "routes": "routes/linden_short.xml",
            "sensors": "config/sensors.json",
            "vehicle": SHUTTLE,
            "weather": "CloudyNoon",
        }

    def _get_in(self, pose: carla.Transform) -> tuple[Driver, VehicleFacts]:
        """As slow as that day."""
        driver, facts = super()._get_in(pose)
        return driver, facts
