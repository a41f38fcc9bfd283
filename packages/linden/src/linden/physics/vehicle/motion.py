"""One vehicle, one step: driver, gear, steering, loads, motion in the plane of the road, footing, in that order."""

import math

from linden.compiled import kept_part, part
from linden.maps.ground import Ground
from linden.physics.axes import turned_axes, within_turn
from linden.physics.state import SOURCES, Body, Spec, Work
from linden.physics.vehicle.chassis import move_body, push_tyres, stands, stop
from linden.physics.vehicle.driver import BRAKE, HAND_BRAKE, THROTTLE, follow_inputs
from linden.physics.vehicle.powertrain import change_gear, pedal, turn_wheels_and_engine, weigh_wheels
from linden.physics.vehicle.suspension import find_footing, settle
from linden.physics.vehicle.tyre import slip_tangent
from linden.physics.vehicle.wheels import load_wheels, prepare_wheels, steer_wheels

LONGEST_STEP_S = 0.01  # tyres and wheels are worked out in steps no longer: CARLA's own max_substep_delta_time
SLOW_MPS = 5.0  # below, each of those in three: Unreal's ThresholdLongitudinalSpeed and its substep counts
SLOW_STEPS = 3
FASTEST_TURN_RADPS = math.radians(3600.0)  # Unreal lets no body spin faster
_STILL = 1e-4  # m/s, rad/s: springs slower than this, and for longer than they could turn round in, have come to rest
_STILL_FOR_S = 0.2


@kept_part(SOURCES)
def advance_vehicle(v: Body, spec: Spec, w: Work, ground: Ground, gravity_mps2: float, dt_s: float, left: int) -> None:
    """Advance the vehicle ``v``; ``w`` is scratch, ``left`` how many of the frame's substeps come after this one.

    What is only read from outside, slips and forces, is written in the last of them.
    """
    cosine, sine = math.cos(v.rotation[1]), math.sin(v.rotation[1])
    if v.footing[3] == 0.0:
        find_footing(v, spec, w, ground, cosine, sine)
    if _goes_on_resting(v):
        return
    ahead = v.velocity[0] * cosine + v.velocity[1] * sine
    follow_inputs(v, spec, ahead, dt_s)
    change_gear(v, spec, dt_s)
    steer_wheels(v, spec)
    load_wheels(v, spec)
    prepare_wheels(v, spec, w, gravity_mps2)
    steps = math.ceil(dt_s / LONGEST_STEP_S - 1e-9) * (1 if abs(ahead) > SLOW_MPS else SLOW_STEPS)
    rise = v.velocity[2] - v.heave_mps
    gained_x, gained_y = 0.0, 0.0
    weigh_wheels(spec, w, dt_s / steps)
    on_ground = v.support_mps2 > 0.0
    pitch, roll = v.footing[1] if on_ground else 0.0, v.footing[2] if on_ground else 0.0
    tilt = math.sin(pitch), math.cos(pitch), math.sin(roll), math.cos(roll)  # of the plane: the same in all steps
    for _ in range(steps):
        rise, pushed_x, pushed_y, cosine, sine = _roll_on(
            v, spec, w, gravity_mps2, rise, dt_s / steps, tilt, cosine, sine
        )
        gained_x, gained_y = gained_x + pushed_x / steps, gained_y + pushed_y / steps
    v.felt_mps2[0], v.felt_mps2[1] = gained_x, gained_y
    if left == 0:
        _report_wheels(v, spec, w)
    find_footing(v, spec, w, ground, cosine, sine)
    settle(v, spec, w.speeds[0], w.speeds[1], gravity_mps2, dt_s)
    v.heave_mps = v.velocity[2] - rise
    write_tilt(v, cosine, sine)
    _rest_where_still(v, w, dt_s)


@part
def _roll_on(
    v: Body,
    spec: Spec,
    w: Work,
    gravity_mps2: float,
    rise_mps: float,
    dt_s: float,
    tilt: tuple[float, float, float, float],
    cosine: float,
    sine: float,
) -> tuple[float, float, float, float, float]:
    """Advance motion, place and heading in the plane of the road, wheels and engine with them.

    ``rise_mps``: the vertical speed that goes with the plane. ``tilt``: sine and cosine of the plane's pitch, then of
    its roll. ``cosine``, ``sine``: those of the yaw. Returned: the vertical speed afterwards, the tyres' force over
    the mass, forward and to the right, m/s², and cosine and sine of the new yaw.
    """
    nose, side = turned_axes(tilt[0], tilt[1], sine, cosine, tilt[2], tilt[3])
    arm_x, arm_y = _arm(v, cosine, sine)
    turn = max(-FASTEST_TURN_RADPS, min(FASTEST_TURN_RADPS, v.angular_velocity[2]))
    velocity_x, velocity_y = v.velocity[0] - turn * arm_y, v.velocity[1] + turn * arm_x  # of the centre of mass
    w.speeds[0] = velocity_x * nose[0] + velocity_y * nose[1] + rise_mps * nose[2]
    w.speeds[1] = velocity_x * side[0] + velocity_y * side[1] + rise_mps * side[2]
    w.speeds[2] = turn
    weight = v.mass_kg * gravity_mps2 if v.gravity else 0.0
    w.pull[0], w.pull[1], w.pull[2] = -weight * nose[2], -weight * side[2], 0.0
    if v.constant_velocity_on:
        w.speeds[0], w.speeds[1] = v.constant_velocity[0], v.constant_velocity[1]
    before_x, before_y = w.speeds[0], w.speeds[1]
    _push_and_turn(v, spec, w, dt_s)
    felt_x, felt_y = (w.speeds[0] - before_x) / dt_s, (w.speeds[1] - before_y) / dt_s
    if v.constant_velocity_on:
        w.speeds[0], w.speeds[1] = v.constant_velocity[0], v.constant_velocity[1]
    ahead, across, turn = w.speeds[0], w.speeds[1], w.speeds[2]
    velocity_x, velocity_y = ahead * nose[0] + across * side[0], ahead * nose[1] + across * side[1]
    v.rotation[1] = within_turn(v.rotation[1] + turn * dt_s)
    cosine, sine = math.cos(v.rotation[1]), math.sin(v.rotation[1])
    new_x, new_y = _arm(v, cosine, sine)
    v.position[0] += velocity_x * dt_s + arm_x - new_x
    v.position[1] += velocity_y * dt_s + arm_y - new_y
    v.velocity[0], v.velocity[1] = velocity_x + turn * new_y, velocity_y - turn * new_x
    v.angular_velocity[2] = turn
    return (
        ahead * nose[2] + across * side[2],
        felt_x - w.pull[0] / v.mass_kg,
        felt_y - w.pull[1] / v.mass_kg,
        cosine,
        sine,
    )


@part
def _push_and_turn(v: Body, spec: Spec, w: Work, dt_s: float) -> None:
    """Advance ``speeds`` and the spins of wheels and engine by one step."""
    throttle = pedal(v, v.given[THROTTLE])
    w.hand_braked = v.given[HAND_BRAKE] > 0.0
    w.wants_to_go = throttle > 0.0 and v.given[BRAKE] == 0.0 and not w.hand_braked and v.gear != 0
    push_tyres(v, spec, w)
    if stands(v, spec, w, dt_s) and not v.constant_velocity_on:
        stop(v, spec, w)
        turn_wheels_and_engine(v, spec, w, throttle, dt_s)
        for k in range(spec.wheel_count):
            v.wheel_omega[k] = 0.0
        return
    turn_wheels_and_engine(v, spec, w, throttle, dt_s)
    move_body(v, spec, w, dt_s)


@part
def _report_wheels(v: Body, spec: Spec, w: Work) -> None:
    """Write the columns of slips and forces."""
    for k in range(spec.wheel_count):
        v.wheel_long_slip[k] = w.slip[k]
        v.wheel_lat_slip[k] = math.atan(slip_tangent(w.across_mps[k], w.along_mps[k]))
        v.wheel_long_force[k] = w.push_x_n[k]
        v.wheel_lat_force[k] = w.push_y_n[k]


@part
def _arm(v: Body, cosine: float, sine: float) -> tuple[float, float]:
    """Return the vector (m) from origin to centre of mass along the world's x and y, by the yaw's cosine and sine."""
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
