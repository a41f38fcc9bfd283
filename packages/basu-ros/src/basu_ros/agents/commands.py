"""Commands of ROS software as CARLA's controls: pedals as they are, speed and tyre angle by a controller."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import carla

from basu.agents.builtin.driving.controllers import PedalControl
from basu.errors import AgentInvalidControlError
from basu.thresholds import AT_REST_MPS

if TYPE_CHECKING:
    from basu.agents.builtin.perception import VehicleFacts

DRIVE, REVERSE, PARK = 2, 20, 22  # autoware_vehicle_msgs/GearCommand
REACH_S = 0.5  # a speed without an acceleration is to be reached in this time …
MOST_MPS2 = 3.0  # … but with no more than this


class Wanted(NamedTuple):
    """What an Ackermann command wants: CARLA's side of it is a controller's affair."""

    speed_mps: float  # along the vehicle's axis, negative backwards
    tyre_angle_rad: float  # positive to the left
    acceleration_mps2: float | None = None  # None: as the controller likes


def carla_command(message: Any) -> carla.VehicleControl:  # noqa: ANN401 - a message
    """Return the control of a ``carla_msgs/CarlaEgoVehicleControl``.

    Raises:
        AgentInvalidControlError: a value is no finite number.
    """
    for name in ("throttle", "steer", "brake"):
        finite(getattr(message, name), name)
    return carla.VehicleControl(
        throttle=float(message.throttle),
        steer=float(message.steer),
        brake=float(message.brake),
        hand_brake=bool(message.hand_brake),
        reverse=bool(message.reverse),
        manual_gear_shift=bool(message.manual_gear_shift),
        gear=int(message.gear),
    )


def ackermann_command(message: Any) -> Wanted:  # noqa: ANN401 - a message
    """Return what an ``ackermann_msgs/AckermannDrive`` wants; an acceleration of 0 is "as fast as possible" there.

    Raises:
        AgentInvalidControlError: a value is no finite number.
    """
    speed, angle = finite(message.speed, "speed"), finite(message.steering_angle, "steering_angle")
    acceleration = finite(message.acceleration, "acceleration")
    return Wanted(speed, angle, acceleration or None)


def autoware_command(message: Any) -> Wanted:  # noqa: ANN401 - a message
    """Return what an ``autoware_control_msgs/Control`` wants.

    Raises:
        AgentInvalidControlError: a value is no finite number.
    """
    along, across = message.longitudinal, message.lateral
    speed = finite(along.velocity, "longitudinal.velocity")
    angle = finite(across.steering_tire_angle, "lateral.steering_tire_angle")
    acceleration = finite(along.acceleration, "longitudinal.acceleration")
    return Wanted(speed, angle, acceleration if along.is_defined_acceleration else None)


def finite(value: float, name: str) -> float:
    """Return the value.

    Raises:
        AgentInvalidControlError: it is no finite number.
    """
    if not math.isfinite(value):
        raise AgentInvalidControlError(f"the ROS software commands {name} = {value}; it must be a finite number")
    return float(value)


class AckermannControl:
    """Follows speed and tyre angle with pedals and wheel, as the built-in agents' feet do."""

    def __init__(self, facts: VehicleFacts, step_s: float) -> None:
        """Take the vehicle's data."""
        self._steering, self._step_s = facts.steering, step_s
        self._pedals = PedalControl(facts.model, step_s)

    def step(self, wanted: Wanted, speed_mps: float, gear: int) -> carla.VehicleControl:
        """Return the control until the next step; ``speed_mps`` is the present one along the axis."""
        is_back = wanted.speed_mps < -AT_REST_MPS
        way = -1.0 if is_back else 1.0
        now_mps, goal_mps = way * speed_mps, way * wanted.speed_mps
        holding = goal_mps < AT_REST_MPS and now_mps < AT_REST_MPS
        towards = (goal_mps - now_mps) / REACH_S
        given = wanted.acceleration_mps2
        rate = max(-MOST_MPS2, min(MOST_MPS2, towards)) if given is None else way * given
        aim_mps = now_mps + rate * self._step_s
        pedals = self._pedals.step(now_mps, max(0.0, aim_mps), rate, holding=holding, gear=gear)
        steer = self._steering.command(-wanted.tyre_angle_rad, speed_mps)
        return carla.VehicleControl(throttle=pedals.throttle, brake=pedals.brake, steer=steer, reverse=is_back)
