"""The controller that follows a policy's trajectory: the steering law and the pedals of BASU's own agents.

AlpaSim has a controller too, a model-predictive one, with a vehicle model of its own. So the same trajectory is not
driven in the same way here and there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import carla

from basu.agents.builtin.driving.controllers import PedalControl, steer_angle_rad
from basu.thresholds import AT_REST_MPS

if TYPE_CHECKING:
    from basu.agents.builtin.perception import VehicleFacts
    from basu.agents.builtin.scene import DrivenVehicle
    from basu_alpasim.plan import Trajectory

SETS_OFF_S = 1.0  # a standing vehicle is held unless its trajectory moves within this time
MOST_MPS2 = 8.0  # about what tyres give: a trajectory that wants more is followed no harder


class TrajectoryControl:
    """Follows trajectories with pedals and wheel."""

    def __init__(self, facts: VehicleFacts, step_s: float) -> None:
        """Take the vehicle's data."""
        self._facts, self._step_s = facts, step_s
        self._pedals = PedalControl(facts.model, step_s)
        self._steer_rad = 0.0

    def step(self, trajectory: Trajectory, ego: DrivenVehicle) -> carla.VehicleControl:
        """Return the control until the next step; ``ego.time_s`` is a time of the trajectory."""
        end_s = ego.time_s + self._step_s
        now_mps, wanted_mps = trajectory.speed_mps(ego.time_s), trajectory.speed_mps(end_s)
        rate_mps2 = max(-MOST_MPS2, min(MOST_MPS2, (wanted_mps - now_mps) / self._step_s))
        soon_mps = max(wanted_mps, trajectory.speed_mps(ego.time_s + SETS_OFF_S))
        holding = ego.speed_mps < AT_REST_MPS and soon_mps < AT_REST_MPS
        pedals = self._pedals.step(ego.speed_mps, wanted_mps, rate_mps2, holding=holding, gear=ego.gear)
        if ego.speed_mps > AT_REST_MPS:  # standing wheels are not turned
            place = trajectory.path.find(ego.x_m, ego.y_m, ego.yaw_rad)
            self._steer_rad = steer_angle_rad(
                trajectory.path, place, ego.yaw_rad, ego.speed_mps, self._facts.body, self._step_s
            )
        steer = self._facts.steering.command(self._steer_rad, ego.speed_mps)
        return carla.VehicleControl(throttle=pedals.throttle, brake=pedals.brake, steer=steer)
