"""One vehicle, one step: gear, steering, loads, motion in the plane of the road, place, footing, in that order."""

import math

from linden.compiled import part
from linden.ground import Ground
from linden.physics.axes import plane_axes, within_turn
from linden.physics.state import Body, Spec, Work
from linden.physics.vehicle.chassis import solve_motion
from linden.physics.vehicle.powertrain import axle_drive, change_gear, turn_engine
from linden.physics.vehicle.suspension import find_footing, settle
from linden.physics.vehicle.wheels import load_wheels, prepare_wheels, steer_wheels

FELT_LAG_S = 0.1  # the load follows the acceleration as fast as springs and dampers let it
_STILL = 1e-4  # m/s, rad/s: springs slower than this, and for longer than they could turn round in, have come to rest
_STILL_FOR_S = 0.2


@part
def advance_vehicle(v: Body, spec: Spec, w: Work, ground: Ground, gravity_mps2: float, dt_s: float, left: int) -> None:
    """Advance the vehicle ``v``; ``w`` is scratch, ``left`` how many of the frame's substeps come after this one.

    What is only read from outside, slips and forces, is written in the last of them.

    The body turns first and the motion is solved in the turned axes: that splits the step into a rotation, which keeps
    the energy, and a backward Euler step against friction, which only takes; the steady turn is met at any step.
    """
    cosine, sine = math.cos(v.rotation[1]), math.sin(v.rotation[1])
    if v.footing[3] == 0.0:
        find_footing(v, spec, w, ground, cosine, sine)
    if _goes_on_resting(v):
        return
    change_gear(v, spec, dt_s)
    arm_x, arm_y = _arm(v, cosine, sine)
    turn = v.angular_velocity[2]
    velocity_x, velocity_y = v.velocity[0] - turn * arm_y, v.velocity[1] + turn * arm_x  # of the centre of mass
    v.rotation[1] = within_turn(v.rotation[1] + turn * dt_s)
    cosine, sine = math.cos(v.rotation[1]), math.sin(v.rotation[1])
    on_ground = v.support_mps2 > 0.0
    pitch = v.footing[1] if on_ground else 0.0
    roll = v.footing[2] if on_ground else 0.0
    nose, side = plane_axes(pitch, v.rotation[1], roll)
    rise = v.velocity[2] - v.heave_mps
    w.start[0] = velocity_x * nose[0] + velocity_y * nose[1] + rise * nose[2]
    w.start[1] = velocity_x * side[0] + velocity_y * side[1] + rise * side[2]
    w.start[2] = turn
    weight = v.mass_kg * gravity_mps2 if v.gravity else 0.0
    w.pull[0], w.pull[1], w.pull[2] = -weight * nose[2], -weight * side[2], 0.0
    _move(v, spec, w, gravity_mps2, dt_s, left)
    ahead, across, turn = w.speeds[0], w.speeds[1], w.speeds[2]
    velocity_x, velocity_y = ahead * nose[0] + across * side[0], ahead * nose[1] + across * side[1]
    v.position[0] += arm_x + velocity_x * dt_s
    v.position[1] += arm_y + velocity_y * dt_s
    arm_x, arm_y = _arm(v, cosine, sine)
    v.position[0] -= arm_x
    v.position[1] -= arm_y
    v.velocity[0], v.velocity[1] = velocity_x + turn * arm_y, velocity_y - turn * arm_x
    v.angular_velocity[2] = turn
    find_footing(v, spec, w, ground, cosine, sine)
    settle(v, spec, ahead, across, gravity_mps2, dt_s)
    v.heave_mps = v.velocity[2] - ahead * nose[2] - across * side[2]
    write_tilt(v, cosine, sine)
    _rest_where_still(v, w, dt_s)


@part
def _move(v: Body, spec: Spec, w: Work, gravity_mps2: float, dt_s: float, left: int) -> None:
    """Solve the motion in the plane of the road and turn wheels and engine with it."""
    held = v.constant_velocity_on
    if held:
        w.start[0], w.start[1] = v.constant_velocity[0], v.constant_velocity[1]
    steer_wheels(v, spec, w.start[0])
    load_wheels(v, spec)
    w.drive[0], w.drive[1], w.drive[2] = axle_drive(v, spec, dt_s)
    prepare_wheels(v, spec, w, gravity_mps2, dt_s)
    solve_motion(v, spec, w, dt_s)
    if held:
        w.speeds[0], w.speeds[1] = v.constant_velocity[0], v.constant_velocity[1]
    blend = dt_s / (FELT_LAG_S + dt_s)
    for axis in range(2):
        felt = (w.speeds[axis] - w.start[axis]) / dt_s - w.pull[axis] / v.mass_kg
        v.felt_mps2[axis] += blend * (felt - v.felt_mps2[axis])
    if left == 0:
        _report_wheels(v, spec, w)
    mean = 0.0
    for k in range(spec.wheel_count):
        v.wheel_omega[k] = w.omega_radps[k]
        mean += spec.drive_share[k] * w.omega_radps[k]
    turn_engine(v, spec, mean, dt_s)


@part
def _report_wheels(v: Body, spec: Spec, w: Work) -> None:
    """Write the columns of slips, forces and torques from the solved motion, the wheels' spins being those before."""
    for k in range(spec.wheel_count):
        radius = spec.wheel_radius_m[k]
        slide = w.omega_radps[k] * radius - w.along_mps[k]
        speed = max(abs(w.along_mps[k]), 0.5)
        v.wheel_long_slip[k] = slide / speed
        v.wheel_lat_slip[k] = math.atan2(w.across_mps[k], speed)
        v.wheel_long_force[k] = w.push_x_nspm[k] * slide
        v.wheel_lat_force[k] = -w.push_y_nspm[k] * w.across_mps[k]
        gained = w.inertia_nms[k] * (w.omega_radps[k] - v.wheel_omega[k])
        v.wheel_torque[k] = gained + radius * v.wheel_long_force[k]


@part
def _arm(v: Body, cosine: float, sine: float) -> tuple[float, float]:
    """Return where the centre of mass lies from the origin, in the world's x and y, m; of the yaw's cosine and sine."""
    x, y = v.centre_of_mass[0], v.centre_of_mass[1]
    return cosine * x - sine * y, sine * x + cosine * y


@part
def write_tilt(v: Body, cosine: float, sine: float) -> None:
    """Write the angular velocity about the world's x and y that goes with the rates of pitch and roll.

    CARLA's pitch (nose up) and roll (right side down) count against its axes; only yaw counts with its own.
    """
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
def _rest_where_still(v: Body, w: Work, dt_s: float) -> None:
    """Put a vehicle to rest that is held on the road, with springs and engine still."""
    held = w.speeds[0] == 0.0 and w.speeds[1] == 0.0 and w.speeds[2] == 0.0
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
