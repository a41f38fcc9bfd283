"""Controls that stay and controls that do not."""

from collections.abc import Callable

import numpy as np
import pytest

from fleet import one, run, slow_uncompiled
from linden.physics.bodies import Bodies
from linden.protocol.values.control import AckermannControl, VehicleControl

FULL = VehicleControl(throttle=1.0, steer=0.5, hand_brake=True)
NONE = VehicleControl()


def held(bodies: Bodies, car: int) -> VehicleControl:
    return bodies.control(car)._replace(gear=0)


def drive(each_frame: Callable[[Bodies, int], None], *, sticky: bool) -> float:
    """Return how far a car has come that was told to go and then, frame by frame, what ``each_frame`` tells it."""
    bodies, car = one()
    bodies.set_sticky(car, sticky=sticky)
    bodies.set_control(car, VehicleControl(throttle=1.0))
    for _ in range(60):
        run(bodies, 0.05, 0.05)
        each_frame(bodies, car)
    return float(bodies.position[car, 0])


def again(bodies: Bodies, car: int) -> None:
    bodies.set_control(car, VehicleControl(throttle=1.0))


def let_go(bodies: Bodies, car: int) -> None:
    bodies.set_control(car, NONE)


def nothing(_bodies: Bodies, _car: int) -> None:
    """A client that keeps silent."""


@slow_uncompiled
def test_a_control_that_sticks_is_one_that_comes_every_frame() -> None:
    assert drive(nothing, sticky=True) == drive(again, sticky=True) == drive(again, sticky=False) > 10.0


@slow_uncompiled
def test_a_control_that_does_not_stick_is_one_that_is_taken_back_in_the_next_frame() -> None:
    assert drive(nothing, sticky=False) == drive(let_go, sticky=True) == drive(let_go, sticky=False) < 1.0


def test_it_acts_in_the_frame_that_it_comes_for_and_no_other() -> None:
    bodies, car = one()
    bodies.set_sticky(car, sticky=False)
    bodies.set_control(car, FULL)
    run(bodies, 0.05, 0.05)
    assert held(bodies, car) == FULL
    run(bodies, 0.05, 0.05)
    assert held(bodies, car) == NONE


def test_many_set_at_once_stick_no_more_than_one() -> None:
    bodies, car = one()
    bodies.set_sticky(car, sticky=False)
    bodies.set_controls(np.array([car]), np.array([FULL], np.float64))
    run(bodies, 0.05, 0.05)
    assert held(bodies, car) == FULL
    run(bodies, 0.05, 0.05)
    assert held(bodies, car) == NONE


def test_a_target_speed_that_does_not_stick_is_forgotten_too() -> None:
    bodies, car = one()
    bodies.set_sticky(car, sticky=False)
    bodies.set_ackermann(car, AckermannControl(speed=8.0))
    run(bodies, 0.05, 0.05)
    assert held(bodies, car).throttle > 0.0
    run(bodies, 0.05, 0.05)
    assert held(bodies, car) == NONE


def test_what_an_autopilot_says_sticks_until_it_is_switched_off() -> None:
    bodies, car = one()
    bodies.set_sticky(car, sticky=False)
    bodies.set_autopilot(car, on=True)
    bodies.set_control(car, FULL)
    run(bodies, 0.2, 0.05)
    assert held(bodies, car) == FULL
    bodies.set_autopilot(car, on=False)
    assert held(bodies, car) == NONE


@pytest.mark.parametrize("on", [True, False])
def test_an_autopilot_that_was_so_already_changes_nothing(*, on: bool) -> None:
    bodies, car = one()
    bodies.set_autopilot(car, on=on)
    bodies.set_control(car, FULL)
    run(bodies, 0.05, 0.05)
    bodies.set_autopilot(car, on=on)
    assert held(bodies, car) == FULL


def test_a_client_s_own_control_goes_before_the_change_of_autopilot() -> None:
    bodies, car = one()
    bodies.set_control(car, FULL)
    bodies.set_autopilot(car, on=True)
    assert held(bodies, car) == FULL
