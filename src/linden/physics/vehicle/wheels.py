"""The wheels of the vehicle at hand before its motion is solved: steering angles, loads, brakes, stiffnesses."""

import math

from linden.compiled import part
from linden.physics.axes import within_turn
from linden.physics.state import Body, Spec, Work
from linden.physics.vehicle.powertrain import on_curve
from linden.physics.vehicle.tyre import cornering_stiffness

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
def prepare_wheels(v: Body, spec: Spec, w: Work, gravity_mps2: float, dt_s: float) -> None:
    """Fill the scratch rows that stay fixed while the motion is solved, and those it begins with."""
    for k in range(spec.wheel_count):
        load = v.wheel_load[k]
        rest_load = spec.load_share[k] * v.mass_kg * gravity_mps2
        friction = spec.friction[k] if v.friction_here < 0.0 else v.friction_here
        w.limit_n[k] = friction * v.road_grip * load
        w.slip_n[k] = spec.slip_stiffness_n[k]
        w.cornering_n[k] = cornering_stiffness(spec.cornering_per_rad[k], spec.cornering_full_load[k], load, rest_load)
        if v.wheel_steer[k] == 0.0:
            w.cosine[k], w.sine[k] = 1.0, 0.0
        else:
            w.cosine[k], w.sine[k] = math.cos(v.wheel_steer[k]), math.sin(v.wheel_steer[k])
        arm_x, arm_y = spec.wheel_x_m[k] - v.centre_of_mass[0], spec.wheel_y_m[k] - v.centre_of_mass[1]
        w.along_turn_m[k] = arm_x * w.sine[k] - arm_y * w.cosine[k]
        w.across_turn_m[k] = arm_x * w.cosine[k] + arm_y * w.sine[k]
        w.brake_nm[k] = (
            spec.brake_nm[k] * v.brake
            + (spec.hand_brake_nm[k] if v.hand_brake else 0.0)
            + ROLLING_RESISTANCE * load * spec.wheel_radius_m[k]
        )
        w.inertia_nms[k] = spec.wheel_inertia_kgm2[k] / dt_s
        w.pushed_nm[k] = w.inertia_nms[k] * v.wheel_omega[k] + spec.drive_share[k] * w.drive[0] * w.drive[1]
        w.turns[k] = 1.0 if v.wheel_omega[k] > 0.0 else (-1.0 if v.wheel_omega[k] < 0.0 else 0.0)
        w.omega_radps[k] = v.wheel_omega[k]


@part
def turn_wheels(v: Body, spec: Spec, dt_s: float) -> None:
    """Turn the wheels on by their spin: what an onlooker sees of them."""
    if v.resting:
        return
    for k in range(spec.wheel_count):
        v.wheel_turned[k] = within_turn(v.wheel_turned[k] + v.wheel_omega[k] * dt_s)
