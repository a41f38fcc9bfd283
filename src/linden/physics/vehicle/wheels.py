"""The wheels of the vehicle at hand before its motion is solved: steering angles, loads, brakes, stiffnesses."""

import math

import numpy as np
from numpy.typing import NDArray

from linden.compiled import part
from linden.physics.state import Body, Spec
from linden.physics.vehicle.powertrain import on_curve
from linden.physics.vehicle.tyre import cornering_stiffness

F64 = NDArray[np.float64]

LIMIT, SLIP, CORNERING, COS, SIN, ARM_X, ARM_Y, BRAKE, TURNS, ALONG, ACROSS, OMEGA, PUSH_X, PUSH_Y, OWN, GRIP = range(
    16
)
"""Rows of the scratch array ``wheels`` (16, 4): friction limit (N), stiffness to slip and to slip angle (N, N/rad),
cosine and sine of the steering angle, place from the centre of mass (m), braking torque (N·m), which way it turns
(-1, 0 locked, 1), speed of the contact along and across the wheel (m/s), spin (rad/s), secant stiffnesses (N·s/m),
resistance to a change of spin (N·m·s/rad), and how much of it the road's grip passes on (1/m)."""

ROLLING_RESISTANCE = 0.012
"""Rolling resistance over load: car tyres on good asphalt, Gillespie, Fundamentals of Vehicle Dynamics, table 4.1."""


@part
def steer_wheels(v: Body, spec: Spec, speed_mps: float) -> None:
    """Set the steering angles: CARLA's steer times the wheel's greatest angle times the speed's fraction.

    The inner front wheel takes that angle, the outer the one whose circle has the same centre (Ackermann):
    cot(outer) = cot(inner) + track / wheelbase. Rajamani, Vehicle Dynamics and Control, 2nd ed., section 2.2.
    """
    fraction = on_curve(abs(speed_mps), spec.steering_mps, spec.steering_fraction, spec.steering_points)
    for k in range(spec.wheel_count):
        angle = v.steer * spec.steer_max_rad[k] * fraction
        if 2 * k < spec.wheel_count and angle * spec.wheel_y_m[k] < 0.0:
            tangent = math.tan(abs(angle))
            angle = math.copysign(math.atan(tangent / (1.0 + tangent * spec.track_m / spec.wheelbase_m)), angle)
        v.wheel_steer[k] = angle


@part
def load_wheels(v: Body, spec: Spec) -> None:
    """Set the wheels' loads: shares of the ground's support, moved by the acceleration felt, none below zero.

    Quasi-static: Gillespie, eqs. 1-6 and 1-7. After a wheel has lifted, the others carry its share.
    """
    carried = 0.0
    for k in range(spec.wheel_count):
        moved = spec.load_per_ax[k] * v.felt_mps2[0] + spec.load_per_ay[k] * v.felt_mps2[1]
        load = max(0.0, spec.load_share[k] * v.support_mps2 + moved) * v.mass_kg
        v.wheel_load[k] = load
        carried += load
    scale = v.support_mps2 * v.mass_kg / carried if carried > 0.0 else 0.0
    for k in range(spec.wheel_count):
        v.wheel_load[k] *= scale


@part
def prepare_wheels(v: Body, spec: Spec, wheels: F64, gravity_mps2: float) -> None:
    """Fill the scratch rows that stay fixed while the motion is solved."""
    for k in range(spec.wheel_count):
        load = v.wheel_load[k]
        rest_load = spec.load_share[k] * v.mass_kg * gravity_mps2
        wheels[LIMIT, k] = spec.friction[k] * load
        wheels[SLIP, k] = spec.slip_stiffness_n[k]
        wheels[CORNERING, k] = cornering_stiffness(
            spec.cornering_per_rad[k], spec.cornering_full_load[k], load, rest_load
        )
        if v.wheel_steer[k] == 0.0:
            wheels[COS, k], wheels[SIN, k] = 1.0, 0.0
        else:
            wheels[COS, k], wheels[SIN, k] = math.cos(v.wheel_steer[k]), math.sin(v.wheel_steer[k])
        wheels[ARM_X, k] = spec.wheel_x_m[k] - v.centre_of_mass[0]
        wheels[ARM_Y, k] = spec.wheel_y_m[k] - v.centre_of_mass[1]
        wheels[BRAKE, k] = (
            spec.brake_nm[k] * v.brake
            + (spec.hand_brake_nm[k] if v.hand_brake else 0.0)
            + ROLLING_RESISTANCE * load * spec.wheel_radius_m[k]
        )
        wheels[TURNS, k] = 1.0 if v.wheel_omega[k] > 0.0 else (-1.0 if v.wheel_omega[k] < 0.0 else 0.0)
        wheels[OMEGA, k] = v.wheel_omega[k]
