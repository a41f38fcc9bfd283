"""Lateral and longitudinal controllers: steering along the path, throttle and brake for a wanted acceleration.

Kinematic bicycle (Rajamani, Vehicle Dynamics and Control, 2nd ed., section 2.2): the origin moves at the slip angle b
off the vehicle's axis, with tan b = (rear axle distance / wheelbase) tan(steer), and yaw turns by sin b / rear axle
distance per metre. Steering so that axis plus slip points along the path, turned in towards it by atan(e / length),
lets the offset e die out within a few ``length`` and the yaw follow by itself like a trailer's. It is Stanley's law
(Hoffmann et al. 2007, equation 5) with the origin in the place of the front axle.

What throttle and brake do is taken from the vehicle's physics control; the rest (drag, slope, gear, load) is one
disturbance, estimated from how the vehicle really accelerated (a disturbance observer, Chen et al. 2016, "Disturbance-
observer-based control and related methods", section II).
"""

from __future__ import annotations

import math
from bisect import bisect_right
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from basu.agents.builtin.driving.path import PathPosition, SampledPath
    from basu.agents.builtin.scene import VehicleGeometry


CATCH_M = 2.0  # an offset shrinks by e over this length at walking pace …
CATCH_S = 0.6  # … and over this time at speed
CALM_S = 0.3  # yaw errors are answered within this time at speed, at walking pace as the geometry has it
MAX_TURN_IN_RAD = 0.6  # towards the path, however far off


def steer_angle_rad(
    path: SampledPath, place: PathPosition, yaw_rad: float, speed_mps: float, body: VehicleGeometry, preview_s: float
) -> float:
    """Return the angle of the front wheels in rad that follows the path, positive to the right.

    Args:
        path: what to follow.
        place: where the origin is beside it.
        yaw_rad: of the vehicle, CARLA frame.
        speed_mps: along the vehicle's axis.
        body: axles.
        preview_s: how much later the angle takes effect; heading and curvature are read that much farther on.
    """
    ahead_s_m = place.s_m + max(speed_mps, 0.0) * preview_s
    heading_rad, curvature_1pm = path.heading_at_rad(ahead_s_m), path.curvature_at_1pm(ahead_s_m)
    rear_m = body.rear_axle_m
    steady_slip_rad = math.asin(max(-0.9, min(0.9, curvature_1pm * rear_m)))
    calm = rear_m / max(rear_m, CALM_S * speed_mps)
    catch_m = max(CATCH_M, CATCH_S * speed_mps)
    turn_in_rad = max(-MAX_TURN_IN_RAD, min(MAX_TURN_IN_RAD, math.atan(place.lateral_m / catch_m)))
    error_rad = math.remainder(heading_rad - turn_in_rad - yaw_rad, math.tau)
    slip_rad = steady_slip_rad + calm * (error_rad - steady_slip_rad)
    slip_rad = max(-1.2, min(1.2, slip_rad))
    return math.atan(body.wheelbase_m / rear_m * math.tan(slip_rad))


FOLLOW_1PS = 1.5  # how fast a lag behind the reference speed is made up
LEARN = 0.15  # share of a step's surprise that the estimate of the disturbance takes up
MAX_DISTURBANCE_MPS2 = 12.0  # an engine in first gear brakes as hard as that at small throttle
HOLD_BRAKE = 0.6  # when standing
HOLD_STEP = 0.04  # it is pressed down this much more a step …
ROLLING_STEP = 0.01  # … and this much while the wheels still turn a little, so that the stop is not felt
ROLLING_MPS = 0.005
STUCK_MPS = 0.1  # below this the vehicle may be held by friction, from which nothing is learnt


class DriveModel(NamedTuple):
    """What full pedals do to the vehicle's speed, in m/s²."""

    speeds_mps: tuple[float, ...]  # ascending, from 0
    full_throttle_mps2: tuple[float, ...]  # beside them
    full_brake_mps2: float

    def throttle_mps2(self, speed_mps: float) -> float:
        """What full throttle does at a speed, interpolated."""
        speeds, gains = self.speeds_mps, self.full_throttle_mps2
        i = min(max(bisect_right(speeds, speed_mps), 1), len(speeds) - 1)
        share = min(max((speed_mps - speeds[i - 1]) / (speeds[i] - speeds[i - 1]), 0.0), 1.0)
        return gains[i - 1] + share * (gains[i] - gains[i - 1])


class Pedals(NamedTuple):
    """Both in [0, 1], never both above 0."""

    throttle: float
    brake: float


class PedalControl:
    """Follows a reference speed and acceleration."""

    def __init__(self, model: DriveModel, dt_s: float) -> None:
        self.model = model
        self.dt_s = dt_s
        self.disturbance_mps2 = 0.0
        self.last = Pedals(0.0, HOLD_BRAKE)
        self.last_speed_mps = 0.0
        self._gear = 1
        self._of_gear: dict[int, float] = {}

    def step(
        self, speed_mps: float, reference_mps: float, reference_mps2: float, *, holding: bool, gear: int = 1
    ) -> Pedals:
        """Pedals until the next step, from the speed measured now and the reference for the end of this step."""
        self._shift(gear)
        self._learn(speed_mps)
        if holding:
            pressed = self.last.brake if self.last.throttle == 0.0 else 0.0
            more = ROLLING_STEP if abs(speed_mps) > ROLLING_MPS else HOLD_STEP
            self.last = Pedals(0.0, min(HOLD_BRAKE, pressed + more))
            return self.last
        lag_mps = reference_mps - reference_mps2 * self.dt_s - speed_mps
        demand_mps2 = reference_mps2 + FOLLOW_1PS * lag_mps - self.disturbance_mps2
        gain_mps2 = max(self.model.throttle_mps2(speed_mps), 0.1)
        if demand_mps2 >= 0.0 and gear == 0 and speed_mps > STUCK_MPS:
            self.last = Pedals(0.0, 0.0)  # nothing pulls while it shifts, and everything at once afterwards
        elif demand_mps2 >= 0.0:
            self.last = Pedals(min(demand_mps2 / gain_mps2, 1.0), 0.0)
        else:
            self.last = Pedals(0.0, min(-demand_mps2 / self.model.full_brake_mps2, 1.0))
        return self.last

    def _shift(self, gear: int) -> None:
        """Each gear has a disturbance of its own, for most of it is what the engine brakes."""
        if gear == self._gear:
            return
        if self._gear != 0:
            self._of_gear[self._gear] = self.disturbance_mps2
        self.disturbance_mps2 = self._of_gear.get(gear, self.disturbance_mps2 / 3.0) if gear != 0 else 0.0
        self._gear = gear

    def _learn(self, speed_mps: float) -> None:
        """Take up part of the difference between what the last pedals should have done and what they did."""
        before_mps, self.last_speed_mps = self.last_speed_mps, speed_mps
        if min(speed_mps, before_mps) < STUCK_MPS or self._gear == 0:
            return
        done_mps2 = (speed_mps - before_mps) / self.dt_s
        expected_mps2 = (
            self.last.throttle * self.model.throttle_mps2(before_mps) - self.last.brake * self.model.full_brake_mps2
        )
        estimate = self.disturbance_mps2 + LEARN * (done_mps2 - expected_mps2 - self.disturbance_mps2)
        self.disturbance_mps2 = min(max(estimate, -MAX_DISTURBANCE_MPS2), MAX_DISTURBANCE_MPS2)
