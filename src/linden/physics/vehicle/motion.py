"""One vehicle, one step: gear, steering, loads, motion in the plane of the road, place, footing, in that order."""

import math

import numpy as np
from numpy.typing import NDArray

from linden.compiled import part
from linden.ground import Ground
from linden.physics.axes import plane_axes, within_turn
from linden.physics.state import Body, Spec
from linden.physics.vehicle.chassis import solve_motion
from linden.physics.vehicle.powertrain import axle_drive, change_gear, turn_engine
from linden.physics.vehicle.suspension import find_footing, settle
from linden.physics.vehicle.wheels import (
    ACROSS,
    ALONG,
    OMEGA,
    PUSH_X,
    PUSH_Y,
    load_wheels,
    prepare_wheels,
    steer_wheels,
)

F64 = NDArray[np.float64]

FELT_LAG_S = 0.1  # the load follows the acceleration as fast as springs and dampers let it
_STILL = 1e-4  # m/s, rad/s: springs slower than this, and for longer than they could turn round in, have come to rest
_STILL_FOR_S = 0.2


@part
def advance_vehicle(
    v: Body, spec: Spec, wheels: F64, ground: Ground, work: F64, gravity_mps2: float, dt_s: float
) -> None:
    """Advance the vehicle ``v``. ``work`` (4, 3) is scratch.

    The body turns first and the motion is solved in the turned axes: that splits the step into a rotation, which keeps
    the energy, and a backward Euler step against friction, which only takes; the steady turn is met at any step.
    """
    if v.footing[3] == 0.0:
        find_footing(v, spec, wheels, ground)
    if _goes_on_resting(v):
        return
    start, pull, drive, speeds = work[0], work[1], work[2], work[3]
    change_gear(v, spec, dt_s)
    arm_x, arm_y = _arm(v)
    turn = v.angular_velocity[2]
    velocity_x, velocity_y = v.velocity[0] - turn * arm_y, v.velocity[1] + turn * arm_x  # of the centre of mass
    v.rotation[1] = within_turn(v.rotation[1] + turn * dt_s)
    on_ground = v.support_mps2 > 0.0
    pitch = v.footing[1] if on_ground else 0.0
    roll = v.footing[2] if on_ground else 0.0
    nose, side = plane_axes(pitch, v.rotation[1], roll)
    rise = v.velocity[2] - v.heave_mps
    start[0] = velocity_x * nose[0] + velocity_y * nose[1] + rise * nose[2]
    start[1] = velocity_x * side[0] + velocity_y * side[1] + rise * side[2]
    start[2] = turn
    weight = v.mass_kg * gravity_mps2 if v.gravity else 0.0
    pull[0], pull[1], pull[2] = -weight * nose[2], -weight * side[2], 0.0
    _move(v, spec, wheels, start, pull, drive, speeds, gravity_mps2, dt_s)
    velocity_x = speeds[0] * nose[0] + speeds[1] * side[0]
    velocity_y = speeds[0] * nose[1] + speeds[1] * side[1]
    v.position[0] += arm_x + velocity_x * dt_s
    v.position[1] += arm_y + velocity_y * dt_s
    arm_x, arm_y = _arm(v)
    v.position[0] -= arm_x
    v.position[1] -= arm_y
    v.velocity[0] = velocity_x + speeds[2] * arm_y
    v.velocity[1] = velocity_y - speeds[2] * arm_x
    v.angular_velocity[2] = speeds[2]
    find_footing(v, spec, wheels, ground)
    settle(v, spec, speeds[0], speeds[1], gravity_mps2, dt_s)
    v.heave_mps = v.velocity[2] - speeds[0] * nose[2] - speeds[1] * side[2]
    write_tilt(v)
    _rest_where_still(v, speeds, dt_s)


@part
def _move(
    v: Body, spec: Spec, wheels: F64, start: F64, pull: F64, drive: F64, speeds: F64, gravity_mps2: float, dt_s: float
) -> None:
    """Solve the motion in the plane of the road and turn wheels and engine with it."""
    held = v.constant_velocity_on
    if held:
        start[0], start[1] = v.constant_velocity[0], v.constant_velocity[1]
    steer_wheels(v, spec, start[0])
    load_wheels(v, spec)
    prepare_wheels(v, spec, wheels, gravity_mps2)
    drive[0], drive[1], drive[2] = axle_drive(v, spec, dt_s)
    solve_motion(v, spec, wheels, start, pull, drive, dt_s, speeds)
    if held:
        speeds[0], speeds[1] = v.constant_velocity[0], v.constant_velocity[1]
    blend = dt_s / (FELT_LAG_S + dt_s)
    for axis in range(2):
        felt = (speeds[axis] - start[axis]) / dt_s - pull[axis] / v.mass_kg
        v.felt_mps2[axis] += blend * (felt - v.felt_mps2[axis])
    _report_wheels(v, spec, wheels, dt_s)


@part
def _report_wheels(v: Body, spec: Spec, wheels: F64, dt_s: float) -> None:
    """Write the wheel columns from the solved motion, and turn the engine."""
    mean = 0.0
    for k in range(spec.wheel_count):
        radius = spec.wheel_radius_m[k]
        slide = wheels[OMEGA, k] * radius - wheels[ALONG, k]
        speed = max(abs(wheels[ALONG, k]), 0.5)
        v.wheel_long_slip[k] = slide / speed
        v.wheel_lat_slip[k] = math.atan2(wheels[ACROSS, k], speed)
        v.wheel_long_force[k] = wheels[PUSH_X, k] * slide
        v.wheel_lat_force[k] = -wheels[PUSH_Y, k] * wheels[ACROSS, k]
        gained = spec.wheel_inertia_kgm2[k] * (wheels[OMEGA, k] - v.wheel_omega[k]) / dt_s
        v.wheel_torque[k] = gained + radius * v.wheel_long_force[k]
        v.wheel_omega[k] = wheels[OMEGA, k]
        mean += spec.drive_share[k] * wheels[OMEGA, k]
    turn_engine(v, spec, mean, dt_s)


@part
def _arm(v: Body) -> tuple[float, float]:
    """Return where the centre of mass lies from the origin, in the world's x and y, m."""
    cosine, sine = math.cos(v.rotation[1]), math.sin(v.rotation[1])
    x, y = v.centre_of_mass[0], v.centre_of_mass[1]
    return cosine * x - sine * y, sine * x + cosine * y


@part
def write_tilt(v: Body) -> None:
    """Write the angular velocity about the world's x and y that goes with the rates of pitch and roll.

    CARLA's pitch (nose up) and roll (right side down) count against its axes; only yaw counts with its own.
    """
    cosine, sine = math.cos(v.rotation[1]), math.sin(v.rotation[1])
    pitching, rolling = v.tilt_radps[0], v.tilt_radps[1]
    v.angular_velocity[0] = -rolling * cosine + pitching * sine
    v.angular_velocity[1] = -rolling * sine - pitching * cosine


@part
def _inputs(v: Body, k: int) -> float:
    """Return the k-th of the inputs that can wake a resting vehicle."""
    if k == 0:
        return float(v.throttle)
    if k == 1:
        return float(v.brake)
    if k == 2:
        return float(v.steer)
    if k == 3:
        return 1.0 if v.hand_brake else 0.0
    if k == 4:
        return 1.0 if v.reverse else 0.0
    return float(v.gear_command) if v.manual_gear_shift else 0.5


@part
def _goes_on_resting(v: Body) -> bool:
    """Tell whether nothing would change: at rest, and no input or push since."""
    if not v.resting or v.constant_velocity_on:
        return False
    still = v.angular_velocity[2] == 0.0
    for axis in range(3):
        still = still and v.velocity[axis] == 0.0
    for k in range(6):
        still = still and v.rest_input[k] == _inputs(v, k)
    v.resting = still
    return bool(still)


@part
def _rest_where_still(v: Body, speeds: F64, dt_s: float) -> None:
    """Put a vehicle to rest that is held on the road, with springs and engine still."""
    held = speeds[0] == 0.0 and speeds[1] == 0.0 and speeds[2] == 0.0
    idle = v.engine_rpm == 0.0 and v.throttle == 0.0 and v.shift_left_s == 0.0
    moving = abs(v.velocity[2]) + abs(v.tilt_radps[0]) + abs(v.tilt_radps[1])
    v.still_s = v.still_s + dt_s if held and idle and moving < _STILL and v.support_mps2 > 0.0 else 0.0
    if v.still_s < _STILL_FOR_S:
        return
    for axis in range(3):
        v.velocity[axis] = 0.0
        v.angular_velocity[axis] = 0.0
    v.heave_mps = 0.0
    v.tilt_radps[0], v.tilt_radps[1] = 0.0, 0.0
    for k in range(6):
        v.rest_input[k] = _inputs(v, k)
    v.resting = True
