"""The thesis's behavioral run: the agent leaves its path on purpose, too fast, and hits what stands beside the road.

Table 5.1 has it with one collision, one speeding and 0.56 of the path. This one drives as ``behavioral`` does up to a
share of the route, then speeds up beyond the limit, drives at something that stands still beside the street, and stays
where that ends.
"""

from __future__ import annotations

import enum
import math
from typing import TYPE_CHECKING, Any

import carla
import numpy as np

from basu.agents.builtin.behavioral import BehavioralAgent
from basu.agents.builtin.deviation import Deviation, Thing, aim_rad, choose
from basu.agents.builtin.perception import see_ego
from basu.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from basu.agents.builtin.driving.behavioral_driver import BehavioralDriver
    from basu.agents.builtin.scene import Ego
    from basu.agents.builtin.vehicle_facts import VehicleFacts

SHARE = 0.56  # of the route, where it ends: table 5.1
RUN_UP_M = 60.0  # before the path is left: from a stop to beyond the limit
ABOVE_LIMIT_MPS = 2.5  # well beyond the tolerance of 1 m/s; 5.6 mph
BLOW_MPS = 2.0  # so much speed is lost in one step only in a crash
HARD_THINGS = ("Buildings", "Poles", "Vegetation", "TrafficSigns", "Fences", "Walls", "Static")
LOWEST_M, HIGHEST_M = 1.0, 0.5  # above the road: a box that begins higher or ends lower is not hit by a bumper


class Phase(enum.Enum):
    """How far it has come with its bad intentions."""

    DRIVING = "driving"
    SPEEDING = "speeding"
    LEAVING = "leaving"
    STAYING = "staying"


class DeviatingAgent(BehavioralAgent):
    """Drives well at first."""

    phase = Phase.DRIVING
    deviation: Deviation | None = None
    _before_mps = 0.0

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        """Drive as the behavioral agent does, and then not any more."""
        if self.phase is Phase.STAYING:
            return carla.VehicleControl(brake=1.0, hand_brake=True)
        control = super().run_step(sensor_data)
        snapshot = self.world.get_snapshot()
        own = snapshot.find(self.vehicle.id)
        if own is None or self.driver is None or self.facts is None:
            return control
        ego = see_ego(snapshot, own, self.vehicle.get_control().gear)
        self._advance(ego, self.driver)
        self._before_mps = ego.speed_mps
        return self._spoilt(control, ego, self.driver, self.facts)

    def _spoilt(
        self, control: carla.VehicleControl, ego: Ego, driver: BehavioralDriver, facts: VehicleFacts
    ) -> carla.VehicleControl:
        """What becomes of a good driver's control."""
        if self.phase is Phase.STAYING:
            return carla.VehicleControl(brake=1.0, hand_brake=True)
        if self.phase is not Phase.DRIVING:
            control.throttle, control.brake = self._pedals(ego, driver)
        if self.phase is Phase.LEAVING and self.deviation is not None:
            angle_rad = aim_rad(ego, self.deviation.thing, facts.body.wheelbase_m)
            control.steer = facts.steering.command(angle_rad, ego.speed_mps)
        return control

    def config(self) -> dict[str, str]:
        """The route, car and weather of the thesis's test runs."""
        return {
            "routes": "routes/linden_short.xml",
            "sensors": "config/sensors.json",
            "vehicle": "vehicle.tesla.model3",
            "weather": "ClearSunset",
        }

    def _get_in(self, pose: carla.Transform) -> tuple[BehavioralDriver, VehicleFacts]:
        """Choose what to hit, too."""
        driver, facts = super()._get_in(pose)
        path = driver.task.path
        self.deviation = choose(path, self._things(), SHARE * path.end_s_m)
        if self.deviation is None:
            raise UserError(
                f"nothing stands beside the street at {SHARE:.0%} of the route that could be driven at; "
                "choose another route for the agent 'deviating'"
            )
        return driver, facts

    def _advance(self, ego: Ego, driver: BehavioralDriver) -> None:
        """From one phase to the next."""
        assert self.deviation is not None
        assert driver.place is not None
        s_m = driver.place.s_m
        if self.phase is Phase.DRIVING and s_m >= self.deviation.leaves_s_m - RUN_UP_M:
            self.phase = Phase.SPEEDING
        elif self.phase is Phase.SPEEDING and s_m >= self.deviation.leaves_s_m:
            self.phase = Phase.LEAVING
        elif self.phase is Phase.LEAVING and self._before_mps - ego.speed_mps > BLOW_MPS:
            self.phase = Phase.STAYING

    def _pedals(self, ego: Ego, driver: BehavioralDriver) -> tuple[float, float]:
        """Throttle and brake for a speed beyond the limit."""
        assert driver.place is not None
        wanted_mps = driver.posted_mps + ABOVE_LIMIT_MPS
        return min(1.0, max(0.0, 0.4 + 0.5 * (wanted_mps - ego.speed_mps))), 0.0

    def _things(self) -> list[Thing]:
        """Everything hard that a bumper may hit, as far as the simulator tells."""
        assert self.route is not None
        road_z_m = float(self.route.points_m[np.searchsorted(self.route.s_m, SHARE * self.route.length_m), 2])
        found = []
        for name in HARD_THINGS:
            for box in self.world.get_level_bbs(getattr(carla.CityObjectLabel, name)):
                at, half = box.location, box.extent
                if at.z - half.z < road_z_m + LOWEST_M and at.z + half.z > road_z_m + HIGHEST_M:
                    found.append(Thing(at.x, at.y, math.radians(box.rotation.yaw), half.x, half.y))
        return found
