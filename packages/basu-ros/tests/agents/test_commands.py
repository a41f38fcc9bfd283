"""Commands of ROS software as CARLA's controls."""

import math

import pytest

from basu.agents.builtin.driving.controllers import DriveModel
from basu.agents.builtin.perception import Steering, VehicleFacts
from basu.agents.builtin.scene import VehicleGeometry
from basu.errors import AgentInvalidControlError
from basu_ros.agents.commands import (
    AckermannControl,
    Wanted,
    ackermann_command,
    autoware_command,
    carla_command,
)
from basu_ros.agents.lockstep import is_answer
from linden_ros2.types import Generation, types_of

TYPES = types_of(Generation.ROS_2)
FACTS = VehicleFacts(
    VehicleGeometry(2.8, 1.4, 2.0, 2.0, 1.0),
    DriveModel((0.0, 20.0), (4.0, 4.0), 8.0),
    Steering(math.radians(35.0), (), ()),
    10.0,
)


def driven(wanted: Wanted, seconds: float, speed_mps: float = 0.0) -> float:
    """The speed of a point that obeys the pedals, forwards or backwards as the gear says."""
    control = AckermannControl(FACTS, 0.05)
    for _ in range(round(seconds / 0.05)):
        answer = control.step(wanted, speed_mps, 1)
        way = -1.0 if answer.reverse else 1.0
        braking = math.copysign(8.0 * answer.brake, speed_mps) if speed_mps else 0.0
        push = way * 4.0 * answer.throttle - braking
        after = speed_mps + push * 0.05
        speed_mps = 0.0 if answer.brake and after * speed_mps < 0.0 else after
    return speed_mps


def test_carla_s_control_is_taken_as_it_is() -> None:
    message = TYPES.message("carla_msgs/msg/CarlaEgoVehicleControl", throttle=0.5, steer=0.25, gear=-1, reverse=True)
    control = carla_command(message)
    assert (control.throttle, control.steer, control.gear, control.reverse) == (0.5, 0.25, -1, True)


def test_a_tyre_angle_to_the_left_is_a_steer_to_the_left() -> None:
    control = AckermannControl(FACTS, 0.05)
    assert control.step(Wanted(2.0, math.radians(17.5)), 2.0, 1).steer == pytest.approx(-0.5)


@pytest.mark.parametrize("goal_mps", [5.0, -2.0])
def test_a_speed_is_reached(goal_mps: float) -> None:
    assert driven(Wanted(goal_mps, 0.0), 8.0) == pytest.approx(goal_mps, abs=0.2)


def test_a_speed_of_zero_brakes_and_holds() -> None:
    assert driven(Wanted(0.0, 0.0), 6.0, 5.0) == pytest.approx(0.0, abs=0.05)


def test_a_given_acceleration_is_kept() -> None:
    assert driven(Wanted(20.0, 0.0, 1.0), 4.0) == pytest.approx(4.0, abs=0.4)


def test_autoware_s_and_ackermann_s_commands_say_the_same() -> None:
    longitudinal = TYPES.message("autoware_control_msgs/msg/Longitudinal", velocity=3.0, acceleration=9.0)
    lateral = TYPES.message("autoware_control_msgs/msg/Lateral", steering_tire_angle=0.25)
    control = TYPES.message("autoware_control_msgs/msg/Control", longitudinal=longitudinal, lateral=lateral)
    drive = TYPES.message("ackermann_msgs/msg/AckermannDrive", speed=3.0, steering_angle=0.25)
    assert autoware_command(control) == ackermann_command(drive) == Wanted(3.0, 0.25, None)
    longitudinal.is_defined_acceleration = True
    assert autoware_command(control).acceleration_mps2 == 9.0


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_what_is_no_number_is_the_agent_s_failure(value: float) -> None:
    for name in ("throttle", "steer", "brake"):
        message = TYPES.message("carla_msgs/msg/CarlaEgoVehicleControl", **{name: value})
        with pytest.raises(AgentInvalidControlError, match=f"commands {name} = "):
            carla_command(message)
    with pytest.raises(AgentInvalidControlError, match="speed"):
        ackermann_command(TYPES.message("ackermann_msgs/msg/AckermannDrive", speed=value))


def test_a_commandis_answer_to_a_frame_by_its_time() -> None:
    def command(sec: int, nanosec: int) -> object:
        stamp = TYPES.message("builtin_interfaces/msg/Time", sec=sec, nanosec=nanosec)
        return TYPES.message("autoware_control_msgs/msg/Control", stamp=stamp)

    assert [is_answer(command(*each), 1.5) for each in ((0, 0), (1, 500_000_000), (2, 0), (1, 499_000_000))] == [
        True, True, True, False,
    ]  # fmt: skip
    assert is_answer(TYPES.message("ackermann_msgs/msg/AckermannDrive"), 1.5)
