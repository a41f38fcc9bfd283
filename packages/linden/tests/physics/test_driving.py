"""Driving against the closed forms of the textbooks."""

import itertools
import math

import numpy as np
import pytest

from fleet import (
    BOX,
    FLAT,
    NOTHING,
    OFFSETS,
    RATIOS,
    TORQUE,
    G,
    at,
    one,
    run,
    sedan,
    slick,
    slope,
    slow_uncompiled,
    speed_mps,
    wheels,
)
from linden.physics.bodies import Bodies
from linden.physics.step import advance
from linden.physics.vehicle.powertrain import AUTOBOX_LATENCY_S
from linden.physics.vehicle.wheels import ROAD_FRICTION, WHEEL_MASS_KG, grip_load
from linden.protocol.values.control import AckermannControl, Gear, VehicleControl
from linden.protocol.values.space import Vector2D, Vector3D
from naive.physics import on_curve

NEUTRAL = VehicleControl(manual_gear_shift=True, gear=0)
MASS_KG = 1696.0
WITH_WHEELS_KG = MASS_KG + 4 * 0.5 * WHEEL_MASS_KG  # a disc of mass m that rolls resists like m/2 more
DRAG_KGPM = 0.5 * 1.25 * 0.3 * 1.8 * 1.4
REST_N = (MASS_KG / 4.0 + WHEEL_MASS_KG) * G  # a quarter of the car with its wheel
GRIP_N = grip_load(MASS_KG * G / 4.0, REST_N)
WHEELBASE_M, TRACK_M = 2.87, 1.57


def launched(v_mps: float, control: VehicleControl = NEUTRAL, **changes: object) -> tuple[Bodies, int]:
    bodies, car = one(slick(**changes))
    bodies.set_control(car, control)
    run(bodies, 0.5)  # the pedals have followed
    bodies.set_target_velocity(car, (v_mps, 0.0, 0.0))
    return bodies, car


@slow_uncompiled
def test_coasting_slows_by_drag() -> None:
    bodies, car = launched(30.0, drag_coefficient=0.3)
    run(bodies, 20.0)
    expected = 30.0 / (1.0 + 30.0 * DRAG_KGPM / WITH_WHEELS_KG * 20.0)
    assert bodies.velocity[car, 0] == pytest.approx(expected, rel=0.005)


@slow_uncompiled
@pytest.mark.parametrize(("v_mps", "friction"), [(10.0, 0.8), (20.0, 0.8), (30.0, 0.4)])
def test_braking_distance_of_locked_wheels_is_v_squared_over_two_mu_g(v_mps: float, friction: float) -> None:
    locking = wheels(damping_rate=0.0, tire_friction=friction, max_brake_torque=1e5)
    bodies, car = launched(v_mps, VehicleControl(manual_gear_shift=True, brake=1.0), wheels=locking)
    start = float(bodies.position[car, 0])
    run(bodies, 15.0)
    assert speed_mps(bodies, car) == 0.0
    slowing = ROAD_FRICTION * friction * 4.0 * GRIP_N / MASS_KG
    assert bodies.position[car, 0] - start == pytest.approx(v_mps**2 / (2.0 * slowing), rel=0.03)


@slow_uncompiled
def test_brakes_slow_by_their_torque_while_the_wheels_turn() -> None:
    bodies, car = launched(40.0, VehicleControl(manual_gear_shift=True, brake=0.5))
    run(bodies, 0.5)
    before = float(bodies.velocity[car, 0])
    run(bodies, 1.0)
    assert (bodies.wheel_omega[car] > 0.0).all()
    assert before - bodies.velocity[car, 0] == pytest.approx(4 * 400.0 / 0.355 / WITH_WHEELS_KG, rel=0.02)


@slow_uncompiled
def test_a_wheel_that_has_locked_stays_locked_until_the_brake_is_released() -> None:
    for lags in (True, False):  # CARLA's wheels; those that the road turns again when it is stronger than the brake
        bodies, car = launched(10.0, VehicleControl(manual_gear_shift=True, brake=0.2))
        bodies.spec(car)["tyres_lag"] = lags
        bodies.state["wheel_omega"][car] = 0.0
        run(bodies, 0.1)
        assert (bodies.wheel_omega[car] == 0.0).all() == lags
        bodies.set_control(car, NEUTRAL)
        run(bodies, 0.3)
        assert (bodies.wheel_omega[car] > 0.0).all()


@slow_uncompiled
def test_light_wheels_that_lag_are_locked_by_a_brake_that_alone_could_not() -> None:
    slowest = []
    for lags in (True, False):
        bodies, car = launched(8.0, NEUTRAL)
        bodies.spec(car)["tyres_lag"] = lags
        bodies.set_control(car, VehicleControl(manual_gear_shift=True, brake=1.0))
        slowing = []
        while speed_mps(bodies, car) > 1.0:
            run(bodies, 0.01)
            slowing.append(-float(bodies.acceleration[car, 0]))
        slowest.append(max(slowing))
    grip = ROAD_FRICTION * 3.5 * 4.0 * GRIP_N / MASS_KG
    assert slowest[0] == pytest.approx(grip, rel=0.1)  # as recorded: 26 m/s²
    assert slowest[1] == pytest.approx(4 * 800.0 / 0.355 / WITH_WHEELS_KG, rel=0.1)


@slow_uncompiled
def test_a_car_spawned_is_in_neutral_and_leaves_it_when_the_engine_turns_up() -> None:
    bodies, car = one()
    bodies.set_control(car, VehicleControl(throttle=1.0))
    waited = 0
    while bodies.gear[car] == 0 and waited < 300:
        run(bodies, 0.01)
        waited += 1
    assert bodies.engine_rpm[car] > 0.15 * 6500.0
    assert AUTOBOX_LATENCY_S + 0.5 <= 0.01 * waited < AUTOBOX_LATENCY_S + 1.0  # and takes its time to change


@slow_uncompiled
@pytest.mark.parametrize("dt_s", [0.01, 0.05, 0.1])
@pytest.mark.parametrize(("front", "rear"), [(20.0, 20.0), (12.0, 20.0)])
def test_the_steady_turn_has_the_radius_of_the_understeer_gradient(front: float, rear: float, dt_s: float) -> None:
    # Rajamani, 2nd ed., eq. 3.15: steering angle = L / R + K a, K = m_front / C_front - m_rear / C_rear
    grip = [
        wheel._replace(tire_friction=30.0, lat_stiff_value=front if k < 2 else rear)
        for k, wheel in enumerate(wheels(damping_rate=0.0))
    ]
    inner = math.radians(3.0)
    bodies, car = one(slick(wheels=tuple(grip), steering_curve=(Vector2D(0.0, 1.0),)))
    bodies.set_control(car, NEUTRAL._replace(steer=3.0 / 70.0))
    run(bodies, 0.1)
    bodies.set_target_velocity(car, (12.0, 0.0, 0.0))
    run(bodies, 3.0, dt_s)
    v, turn = speed_mps(bodies, car), float(bodies.angular_velocity[car, 2])
    middle = math.atan(1.0 / (1.0 / math.tan(inner) + TRACK_M / 2.0 / WHEELBASE_M))
    use = GRIP_N / REST_N  # of the load at which the stiffness levels off, times three
    stiffness_n = REST_N * (use - use**2 / 3.0 + use**3 / 27.0)  # per rad
    gradient = (1.0 / front - 1.0 / rear) * MASS_KG / 4.0 / stiffness_n * (v + 1.0) / v  # the slip angle's tangent
    assert turn > 0.0  # steer is positive to the right, and so is yaw
    assert v / turn == pytest.approx((WHEELBASE_M + gradient * v * v) / math.tan(middle), rel=0.03)


@slow_uncompiled
def test_free_fall_is_half_g_t_squared() -> None:
    bodies, car = one(pose=at(z=50.0))
    run(bodies, 2.0)
    assert bodies.position[car, 2] == pytest.approx(50.0 - 0.5 * G * 4.0, abs=1e-9)
    assert bodies.velocity[car, 2] == pytest.approx(-G * 2.0)


@slow_uncompiled
def test_a_dropped_car_lands_and_stands_still() -> None:
    bodies, car = one(pose=at(z=1.0))
    run(bodies, 5.0)
    assert bodies.position[car] == pytest.approx((0.0, 0.0, 0.0), abs=1e-4)
    assert not bodies.velocity[car].any()
    assert bodies.wheel_load[car].sum() == pytest.approx(MASS_KG * G, rel=1e-3)


@slow_uncompiled
@pytest.mark.parametrize("rise", [0.05, -0.1, 0.3])
@pytest.mark.parametrize("yaw", [0.0, 90.0, 30.0])
def test_brakes_hold_a_car_on_a_slope_without_creeping(rise: float, yaw: float) -> None:
    ground = slope(rise)
    bodies, car = one(pose=at(yaw=yaw, z=0.3))
    bodies.set_control(car, VehicleControl(brake=1.0))
    run(bodies, 4.0, ground=ground)
    stood = bodies.position[car].copy()
    run(bodies, 20.0, ground=ground)
    assert (bodies.position[car] == stood).all()
    assert not bodies.velocity[car].any()


@slow_uncompiled
def test_without_brakes_a_car_rolls_down_by_gravity() -> None:
    ground = slope(-0.1)
    bodies, car = one(slick(), at(z=0.0))
    bodies.set_control(car, NEUTRAL)
    run(bodies, 1.0, ground=ground)
    before = speed_mps(bodies, car)
    run(bodies, 4.0, ground=ground)
    tilt = math.atan(0.1)
    pulled = math.sin(tilt) * MASS_KG * G / WITH_WHEELS_KG
    assert speed_mps(bodies, car) - before == pytest.approx(4.0 * pulled, rel=0.01)
    assert bodies.velocity[car, 2] / bodies.velocity[car, 0] == pytest.approx(-0.1, rel=3e-3)
    assert bodies.rotation[car, 0] == pytest.approx(-tilt, abs=0.003)


@slow_uncompiled
def test_top_speed_is_where_the_engine_balances_what_holds_the_car_back() -> None:
    bodies, car = one(sedan(forward_gears=(Gear(1.0),), final_ratio=2.5))
    bodies.set_control(car, VehicleControl(throttle=1.0))
    run(bodies, 120.0, 0.05)
    v, radius = speed_mps(bodies, car), 0.355
    radps = float(bodies.engine_rpm[car]) * math.pi / 30.0
    engine_n = (on_curve(float(bodies.engine_rpm[car]), TORQUE) - 0.05 * radps) * 2.5 / radius
    held_n = DRAG_KGPM * v * v + 4 * 0.25 * v / radius**2
    assert abs(bodies.acceleration[car, 0]) < 0.01
    assert engine_n == pytest.approx(held_n, rel=0.01)
    assert radps > v / radius * 2.5  # the clutch slips by torque over its strength


@slow_uncompiled
def test_the_automatic_goes_through_its_gears_with_a_pause_in_each_change() -> None:
    bodies, car = one()
    bodies.set_control(car, VehicleControl(throttle=1.0))
    gears = []
    for _ in range(1500):
        run(bodies, 0.01)
        gears.append(int(bodies.gear[car]))
    visited = [gear for gear, _ in itertools.groupby(gears)]
    assert visited[:8] == [0, 1, 0, 2, 0, 3, 0, 4]
    pauses = [len(list(same)) for gear, same in itertools.groupby(gears) if gear == 0][1:4]
    assert pauses == pytest.approx([51, 51, 51], abs=1)  # the first step past gear_switch_time engages
    assert max(visited) == len(RATIOS)


@slow_uncompiled
def test_the_automatic_waits_after_a_change_before_it_looks_again() -> None:
    eager = tuple(Gear(1.0, 0.1, 0.11) for _ in range(6))  # wants up, always
    bodies, car = one(sedan(forward_gears=eager, gear_switch_time=0.05))
    bodies.set_control(car, VehicleControl(throttle=1.0))
    begun = []
    for n in range(600):
        before = int(bodies.gear[car])
        run(bodies, 0.01)
        if before > 0 and bodies.gear[car] == 0:
            begun.append(0.01 * n)
    assert len(begun) >= 4
    assert np.diff(begun) == pytest.approx(AUTOBOX_LATENCY_S, abs=0.03)


def test_manual_gears_and_reverse_engage_at_once() -> None:
    bodies, car = one()
    bodies.set_control(car, VehicleControl(manual_gear_shift=True, gear=3))
    run(bodies, 0.01)
    assert bodies.control(car).gear == 3
    bodies.set_control(car, VehicleControl(reverse=True, throttle=0.5))
    run(bodies, 3.0)
    assert bodies.control(car).gear == -1
    assert bodies.velocity[car, 0] < -1.0


@slow_uncompiled
def test_engine_braking_slows_more_in_a_low_gear() -> None:
    slowed = []
    for gear in (2, 5):
        bodies, car = launched(
            15.0, VehicleControl(manual_gear_shift=True, gear=gear), damping_rate_zero_throttle_clutch_engaged=2.0
        )
        run(bodies, 2.0)
        slowed.append(15.0 - speed_mps(bodies, car))
    assert slowed[0] > 1.5 * slowed[1] > 0.5


@slow_uncompiled
def test_load_moves_forward_in_braking_and_outward_in_a_bend() -> None:
    bodies, car = launched(20.0, VehicleControl(manual_gear_shift=True, brake=0.6))
    run(bodies, 1.2)
    loads = bodies.wheel_load[car]
    a = -float(bodies.acceleration[car, 0])
    height_m = BOX.location.z - 0.3  # nobody says how far below the centre of mass the tyres push: from the ground
    assert loads[:2].sum() - loads[2:].sum() == pytest.approx(2.0 * MASS_KG * a * height_m / WHEELBASE_M, rel=0.05)
    bodies, car = launched(15.0, NEUTRAL._replace(steer=0.1))
    run(bodies, 1.0)
    loads = bodies.wheel_load[car]
    assert loads[0] + loads[2] > 1.1 * (loads[1] + loads[3])  # a right turn loads the left
    assert bodies.rotation[car, 2] < 0.0  # and the right side rises


@slow_uncompiled
def test_the_friction_circle_is_never_left() -> None:
    bodies, car = one(sedan(wheels=wheels(tire_friction=0.6, max_brake_torque=4000.0)))
    rng = np.random.default_rng(7)
    for _ in range(60):
        throttle, brake = rng.uniform(size=2)
        bodies.set_control(car, VehicleControl(throttle, rng.uniform(-1.0, 1.0), brake * (rng.random() < 0.4)))
        run(bodies, 0.2)
        force = np.hypot(bodies.wheel_long_force[car], bodies.wheel_lat_force[car])
        most = [ROAD_FRICTION * 0.6 * grip_load(load, REST_N) for load in bodies.wheel_load[car]]
        assert (force <= np.array(most) * (1.0 + 1e-2) + 1.0).all()


def test_steering_weakens_with_speed_by_the_steering_curve() -> None:
    for v_mps, fraction in ((0.0, 1.0), (60.0 / 3.6, 0.8), (200.0 / 3.6, 0.7)):
        bodies, car = one()
        bodies.enable_constant_velocity(car, (v_mps, 0.0, 0.0))
        bodies.set_control(car, NEUTRAL._replace(steer=-0.1))
        run(bodies, 0.1)
        assert bodies.wheel_steer_deg(car, 0) == pytest.approx(-7.0 * fraction, rel=1e-3)  # the inner wheel
        assert -7.0 * fraction < bodies.wheel_steer_deg(car, 1) < 0.0


def test_the_hand_brake_locks_the_rear_wheels_only() -> None:
    bodies, car = launched(
        15.0, VehicleControl(manual_gear_shift=True, hand_brake=True), wheels=wheels(tire_friction=0.9)
    )
    run(bodies, 0.5)
    assert (bodies.wheel_omega[car, :2] > 20.0).all()
    assert (bodies.wheel_omega[car, 2:] == 0.0).all()


@slow_uncompiled
def test_ackermann_control_reaches_its_speed_and_angle() -> None:
    bodies, car = one()
    bodies.set_ackermann(car, AckermannControl(steer=0.05, speed=8.0))
    run(bodies, 40.0, 0.05)
    assert speed_mps(bodies, car) == pytest.approx(8.0, rel=0.1)
    assert bodies.control(car).steer == pytest.approx(0.05 / math.radians(70.0))
    bodies.set_ackermann(car, AckermannControl(speed=0.0))
    run(bodies, 30.0, 0.05)
    assert speed_mps(bodies, car) == 0.0
    assert bodies.control(car).brake == 1.0


@slow_uncompiled
def test_constant_velocity_is_held_and_can_be_steered() -> None:
    bodies, car = one(pose=at(yaw=90.0))
    bodies.enable_constant_velocity(car, (6.0, 0.0, 0.0))
    run(bodies, 1.0)
    assert bodies.velocity[car, :2] == pytest.approx((0.0, 6.0), abs=1e-6)
    bodies.set_control(car, VehicleControl(steer=0.2))
    run(bodies, 1.0)
    assert bodies.angular_velocity[car, 2] > 0.1
    bodies.disable_constant_velocity(car)
    bodies.set_control(car, VehicleControl(brake=1.0))
    run(bodies, 5.0)
    assert speed_mps(bodies, car) == 0.0


@slow_uncompiled
def test_a_two_wheeler_stays_up_and_leans_into_the_bend() -> None:
    two = (wheels()[0]._replace(max_steer_angle=40.0), wheels()[2])
    bodies = Bodies()
    offsets = (Vector3D(0.7, 0.0, 0.0), Vector3D(-0.7, 0.0, 0.0))
    bike = bodies.add_vehicle(sedan(mass=280.0, wheels=two, moi=0.2, clutch_strength=2.0), at(), BOX, offsets)
    bodies.set_control(bike, VehicleControl(throttle=0.6, steer=0.05))
    run(bodies, 4.0)
    felt = speed_mps(bodies, bike) * float(bodies.angular_velocity[bike, 2])
    assert felt > 0.5
    assert bodies.rotation[bike, 2] == pytest.approx(math.atan(felt / G), rel=0.2)


@slow_uncompiled
def test_a_standing_car_wakes_for_throttle_and_for_a_push() -> None:
    bodies, car = one()
    run(bodies, 2.0)
    assert bodies.state["resting"][car]
    bodies.add_impulse(car, (MASS_KG * 2.0, 0.0, 0.0))
    advance(bodies, FLAT, NOTHING, 0.01)
    assert bodies.velocity[car, 0] == pytest.approx(2.0, rel=0.1)
    run(bodies, 5.0)
    bodies.set_control(car, VehicleControl(throttle=0.5))
    run(bodies, 1.0)
    assert bodies.velocity[car, 0] > 0.5


def test_the_wheels_positions_are_kept_in_the_world_in_centimetres() -> None:
    bodies, car = one(pose=at(x=10.0, y=20.0, yaw=90.0))
    echoed = bodies.physics_control(car)
    assert echoed.wheels[0].position == pytest.approx((1000.0 + 78.5, 2000.0 + 143.5, 0.0), abs=1e-6)
    bodies.set_physics_control(car, echoed._replace(mass=2000.0))
    assert bodies.mass_kg[car] == 2000.0
    again = bodies.add_vehicle(echoed, at(x=10.0, y=20.0, yaw=90.0), BOX)
    assert bodies.spec(again)["wheel_x_m"] == pytest.approx([offset.x for offset in OFFSETS])
