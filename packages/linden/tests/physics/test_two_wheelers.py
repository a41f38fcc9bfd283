"""Two-wheelers as a client sees them: four wheels, in pairs, of which the physics makes two."""

import numpy as np
import pytest

from fleet import BOX, at, run, sedan, slow_uncompiled, wheels
from linden.errors import Refusal
from linden.physics.bodies import Bodies
from linden.physics.vehicle.parameters import axle_wheel
from linden.protocol.values.control import VehicleControl, VehiclePhysicsControl
from linden.protocol.values.space import Vector3D

OFFSETS = (Vector3D(0.7, 0.0, 0.3), Vector3D(-0.7, 0.0, 0.3))
FRONT, REAR = wheels()[0]._replace(max_steer_angle=40.0), wheels()[2]


def bike(control: VehiclePhysicsControl) -> tuple[Bodies, int]:
    bodies = Bodies()
    return bodies, bodies.add_vehicle(control, at(x=3.0, yaw=90.0), BOX, OFFSETS)


def of_two() -> VehiclePhysicsControl:
    return sedan(mass=280.0, wheels=(FRONT, REAR), moi=0.2, clutch_strength=2.0)


def of_four() -> VehiclePhysicsControl:
    halves = [
        wheel._replace(
            damping_rate=0.5 * wheel.damping_rate,
            max_brake_torque=0.5 * wheel.max_brake_torque,
            max_handbrake_torque=0.5 * wheel.max_handbrake_torque,
            long_stiff_value=0.5 * wheel.long_stiff_value,
        )
        for wheel in (FRONT, REAR)
    ]
    return of_two()._replace(wheels=(halves[0], halves[0], halves[1], halves[1]))


def test_two_halves_side_by_side_make_the_wheel() -> None:
    front, _, rear, _ = of_four().wheels
    assert axle_wheel(front, front) == FRONT
    assert axle_wheel(rear, rear) == REAR


@slow_uncompiled
def test_four_wheels_in_pairs_drive_as_the_two_that_they_stand_for() -> None:
    two, four = bike(of_two()), bike(of_four())
    for bodies, slot in (two, four):
        bodies.set_control(slot, VehicleControl(throttle=0.6, steer=0.05))
        run(bodies, 3.0)
        bodies.set_control(slot, VehicleControl(brake=0.5))
        run(bodies, 1.0)
    assert np.array_equal(two[0].state[two[1]], four[0].state[four[1]])


def test_all_four_are_answered_as_they_were_set_with_the_places_of_their_axles() -> None:
    bodies, slot = bike(of_four())
    changed = tuple(wheel._replace(tire_friction=1.0 + k) for k, wheel in enumerate(of_four().wheels))
    bodies.set_physics_control(slot, of_four()._replace(wheels=changed))
    seen = bodies.physics_control(slot)
    assert [wheel.tire_friction for wheel in seen.wheels] == [1.0, 2.0, 3.0, 4.0]
    assert bodies.spec(slot)["friction"][:2] == pytest.approx([1.5, 3.5])
    assert [wheel.position for wheel in seen.wheels[:2]] == [pytest.approx((300.0, 70.0, 30.0))] * 2
    assert [wheel.position for wheel in seen.wheels[2:]] == [pytest.approx((300.0, -70.0, 30.0))] * 2
    bodies.set_physics_control(slot, seen)
    assert bodies.spec(slot)["wheel_x_m"][:2] == pytest.approx([0.7, -0.7])


def test_a_two_wheeler_cannot_be_given_another_number_of_wheels() -> None:
    bodies, slot = bike(of_four())
    with pytest.raises(Refusal, match="this vehicle has 4 wheels, not 2"):
        bodies.set_physics_control(slot, of_two())


def test_the_two_of_a_pair_carry_half_of_what_their_axle_does() -> None:
    bodies, slot = bike(of_four())
    bodies.set_control(slot, VehicleControl(throttle=0.6))
    run(bodies, 2.0)
    seen = bodies.telemetry(slot)
    assert len(seen.wheels) == 4
    assert seen.wheels[0] == seen.wheels[1]
    assert [wheel.tire_load for wheel in seen.wheels[1:3]] == pytest.approx(0.5 * bodies.wheel_load[slot, :2])
    assert sum(wheel.tire_load for wheel in seen.wheels) == pytest.approx(280.0 * 9.81, rel=0.02)
    assert seen.wheels[2].torque == pytest.approx(0.5 * float(bodies.state["wheel_torque"][slot, 1]))
