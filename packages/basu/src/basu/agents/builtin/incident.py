"""The incident of 20 February 2020: drives like the basic agent, and stops hard over a small deviation of its steering.

What is known (Smart Columbus, review of 15 May 2020; Washington Post, 29 February 2020): the shuttle drove at 7.1 mph,
stopped by itself, suddenly, because of a small steering deviation; a passenger slid to the floor, the operator was
thrown off his feet. Not known are the place, the size of the deviation and how hard the stop was. They are set here: a
straight piece of the short route where nothing is ahead, wheels that stand 0.01 of full lock away from where they were
told to, and 3.5 m/s², the middle of what such a vehicle's emergency stop is taken to be.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import carla

from basu.agents.builtin.basic import BasicAgent
from basu.agents.builtin.driving.controllers import HOLD_BRAKE
from basu.agents.builtin.perception import SHUTTLE
from basu.thresholds import STANDSTILL_MPS

if TYPE_CHECKING:
    from collections.abc import Mapping

CRUISE_MPS = 7.1 * 0.44704
DEVIATION_SHARE = 0.78  # of the route, where the wheels deviate: on the short one 90 m before a line, 85 m after a bend
DEVIATION_STEER = 0.01
TOLERATED_STEER = 0.005  # a deviation above this is taken for a failure
STOP_MPS2 = 3.5
STANDING_S = 10.0  # until the operator has looked round and lets it go on


class IncidentAgent(BasicAgent):
    """The basic agent, no faster than the shuttle was that day, with a nervous watchdog over its wheels."""

    cruise_mps = CRUISE_MPS

    def setup(self) -> None:
        """Begin a drive before the incident."""
        super().setup()
        self._deviated = self._stopping = False
        self._rested = 0  # steps at rest since the stop began

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        """Drive; compare the wheels with their command; stop where they deviate."""
        if self._stopping:
            return self._stop()
        given = super().run_step(sensor_data)
        done = carla.VehicleControl(throttle=given.throttle, brake=given.brake, steer=given.steer + self._deviation())
        self._stopping = abs(done.steer - given.steer) > TOLERATED_STEER
        return done

    def config(self) -> dict[str, str]:
        """The shuttle on the short route, under a sky of February."""
        return {
            "routes": "routes/linden_short.xml",
            "sensors": "config/sensors.json",
            "vehicle": SHUTTLE,
            "weather": "CloudyNoon",
        }

    def _deviation(self) -> float:
        """How far the wheels are off, once."""
        assert self.driver is not None  # it has just answered
        place, path = self.driver.place, self.driver.path
        if self._deviated or place is None or place.s_m < DEVIATION_SHARE * path.end_s_m:
            return 0.0
        self._deviated = True
        return DEVIATION_STEER

    def _stop(self) -> carla.VehicleControl:
        """Brake to rest, stand, and get in anew."""
        assert self.facts is not None  # a stop begins while driving
        if self.vehicle.get_velocity().length() > STANDSTILL_MPS:
            return carla.VehicleControl(brake=min(1.0, STOP_MPS2 / self.facts.model.full_brake_mps2))
        self._rested += 1
        if self._rested * self.time_step_s >= STANDING_S:
            self._stopping, self.driver = False, None
        return carla.VehicleControl(brake=HOLD_BRAKE)
