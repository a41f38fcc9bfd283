"""Bodies off their feet: a rigid box in space; its wheels, sides and roof meet the ground until it stands again.

The vehicle of ``vehicle.motion`` keeps its wheels down; what a push, a fall or a client puts on its side or roof is
moved here. Contacts are impulses in sequence, accumulated and clamped: Catto 2005, "Iterative dynamics with temporal
coherence". The spin keeps its axis between contacts: the gyroscopic term is left out, as game engines do for boxes.
"""

import math

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kept_part, part
from linden.maps.ground import Ground, surface_under
from linden.physics.axes import body_axes, within_turn
from linden.physics.state import SOURCES, TUMBLING_POINTS, Body, Spec, Work

F64 = NDArray[np.float64]

BODY_FRICTION = 0.5  # a car on its side or roof on asphalt: 0.4 to 0.6, Brach, Vehicle Accident Analysis, chapter 4
ROLLING_FRICTION = 0.02  # of a wheel along its own direction, unless a brake holds it
_ROUNDS = 12
_SLOP_M = 0.01  # depth that is left, so that lying contacts stay contacts
_PUSHED_OUT = 0.2  # of the rest, per step
_FASTEST_OUT_MPS = 1.0
_SILL, _BELT = 0.25, 0.65  # of the height: between them the sides are upright
_ROOF = 0.75  # width and length of the roof over those of the box
_STILL = 0.02  # m/s, rad/s
_STILL_FOR_S = 0.5
_UPRIGHT_COSINE = math.cos(math.radians(10.0))
_UPRIGHT_RADPS = 0.7
_UPSET_RAD = 0.6  # a vehicle put down or falling steeper than this does not land on its wheels
_UPSET_TWO_WHEELER_RAD = 1.0  # it leans into bends, up to 0.7 (vehicle.suspension)
_HALF_TRACK = 0.75  # over half the width: where wheels sit when the blueprint does not say
_NEAR_GROUND_M = 0.08


@part
def is_upset(v: Body, spec: Spec) -> bool:
    """Tell whether a vehicle that is put down or in the air leans too far to land on its wheels."""
    if v.footing[3] != 0.0 and v.support_mps2 > 0.0:
        return False
    most = _UPSET_RAD if spec.track_m > 0.0 else _UPSET_TWO_WHEELER_RAD
    return bool(abs(v.rotation[0]) > _UPSET_RAD or abs(v.rotation[2]) > most)


@part
def tripping_speed_mps(v: Body) -> float:
    """Return the sideways speed from which a vehicle with caught wheels tips over.

    The spin about the caught wheels, m v h = I w, must lift the centre of mass over them: critical sliding velocity,
    Jones 1975 (in Gillespie, Fundamentals of Vehicle Dynamics, eq. 9-17).
    """
    height, arm = v.centre_of_mass[2], _HALF_TRACK * v.half_extent[1]
    lift = math.sqrt(height * height + arm * arm) - height
    y, z = v.half_extent[1], v.half_extent[2]
    inertia = (y * y + z * z) / 3.0 + height * height + arm * arm  # over the mass
    return float(math.sqrt(2.0 * 9.81 * inertia * lift) / height)


@part
def start_tumbling(v: Body) -> None:
    """Let go of the road: from rates of pitch and roll to an angular velocity in the world."""
    if v.tumbling:
        return
    v.tumbling = True
    cosine, sine = math.cos(v.rotation[1]), math.sin(v.rotation[1])
    pitching, rolling = v.tilt_radps[0], v.tilt_radps[1]
    v.angular_velocity[0] = -rolling * cosine + pitching * sine
    v.angular_velocity[1] = -rolling * sine - pitching * cosine
    v.engine_rpm = 0.0
    for k in range(len(v.wheel_omega)):
        v.wheel_omega[k], v.wheel_load[k], v.wheel_torque[k] = 0.0, 0.0, 0.0
        v.wheel_long_force[k], v.wheel_lat_force[k] = 0.0, 0.0
        v.wheel_long_slip[k], v.wheel_lat_slip[k] = 0.0, 0.0
    v.still_s = 0.0


@kept_part(SOURCES)
def tumble(v: Body, spec: Spec, w: Work, ground: Ground, gravity_mps2: float, dt_s: float) -> None:
    """Advance a tumbling vehicle by one substep."""
    if v.resting and _is_still(v, 0.0):
        return
    v.resting = False
    axes, arm = w.axes, w.arm
    _write_axes(v, w)
    turn, speed = w.turn, w.speed
    for axis in range(3):
        turn[axis] = v.angular_velocity[axis]
    _to_mass_point(v, arm, turn, speed)
    speed[2] -= gravity_mps2 * dt_s if v.gravity else 0.0
    met = _meet_ground(v, spec, w, ground, dt_s)
    _press(v, w, met)
    _move(v, w, dt_s)
    v.still_s = v.still_s + dt_s if met > 2 and _is_still(v, _STILL) else 0.0
    if v.still_s >= _STILL_FOR_S:
        for axis in range(3):
            v.velocity[axis], v.angular_velocity[axis] = 0.0, 0.0
        v.resting = True
    if _stands(v, spec, ground, axes):
        _find_feet(v)


@part
def _is_still(v: Body, most: float) -> bool:
    """Tell whether no component of the velocities exceeds ``most``, m/s and rad/s."""
    still = True
    for axis in range(3):
        still = still and abs(v.velocity[axis]) <= most and abs(v.angular_velocity[axis]) <= most
    return still


@part
def _write_axes(v: Body, w: Work) -> None:
    """Write the axes as columns, the centre of mass from the origin (m), and the inverse of the inertia, in the world.

    The inertia is that of a uniform box.
    """
    nose, side, up = body_axes(v.rotation[0], v.rotation[1], v.rotation[2])
    x, y, z = v.half_extent[0], v.half_extent[1], v.half_extent[2]
    axes, arm, weight, ease = w.axes, w.arm, w.weight, w.turn_ease
    ease[0], ease[1], ease[2] = 3.0 / (y * y + z * z), 3.0 / (x * x + z * z), 3.0 / (x * x + y * y)
    for row in range(3):
        axes[row, 0], axes[row, 1], axes[row, 2] = nose[row], side[row], up[row]
    for row in range(3):
        arm[row] = 0.0
        for k in range(3):
            arm[row] += axes[row, k] * v.centre_of_mass[k]
        for column in range(3):
            weight[row, column] = 0.0
            for k in range(3):
                weight[row, column] += axes[row, k] * ease[k] * axes[column, k] / v.mass_kg


@part
def _to_mass_point(v: Body, arm: F64, turn: F64, speed: F64) -> None:
    """Write the velocity of the centre of mass, that of the origin and the spin being the body's."""
    speed[0] = v.velocity[0] + turn[1] * arm[2] - turn[2] * arm[1]
    speed[1] = v.velocity[1] + turn[2] * arm[0] - turn[0] * arm[2]
    speed[2] = v.velocity[2] + turn[0] * arm[1] - turn[1] * arm[0]


@part
def _local_point(v: Body, spec: Spec, k: int, point: F64) -> None:
    """Write the k-th point that can meet the ground, in the body's frame, m: wheels, sills, belt line, roof."""
    if k < 4:
        wheel = k % spec.wheel_count
        point[0], point[1], point[2] = spec.wheel_x_m[wheel], spec.wheel_y_m[wheel], 0.0
        return
    share = 1.0 if k < 12 else _ROOF
    height = _SILL if k < 8 else (_BELT if k < 12 else 1.0)
    ahead, right = 1.0 if k & 1 else -1.0, 1.0 if k & 2 else -1.0
    point[0] = v.box_centre[0] + ahead * share * v.half_extent[0]
    point[1] = v.box_centre[1] + right * share * v.half_extent[1]
    point[2] = v.box_centre[2] + (2.0 * height - 1.0) * v.half_extent[2]


@part
def _meet_ground(v: Body, spec: Spec, w: Work, ground: Ground, dt_s: float) -> int:
    """Write the points that touch the ground or may within the step, and return how many they are."""
    met = 0
    axes, arm, points, local, at = w.axes, w.arm, w.points, w.local, w.at
    braked = v.brake > 0.5 or v.hand_brake
    tyre = (spec.friction[0] if v.friction_here < 0.0 else v.friction_here) * v.road_friction
    for k in range(TUMBLING_POINTS):
        _local_point(v, spec, k, local)
        for row in range(3):
            at[row] = -arm[row]
            for column in range(3):
                at[row] += axes[row, column] * local[column]
        x, y, z = v.position[0] + arm[0] + at[0], v.position[1] + arm[1] + at[1], v.position[2] + arm[2] + at[2]
        height, normal_x, normal_y, normal_z, _ = surface_under(ground, x, y, max(z, v.position[2] + arm[2]))
        depth = (height - z) * normal_z
        if depth < -_NEAR_GROUND_M - dt_s * _speed(v):
            continue
        entry = points[met]
        for row in range(3):
            entry[row] = at[row]
        entry[3], entry[4], entry[5] = normal_x, normal_y, normal_z
        out = min(_FASTEST_OUT_MPS, _PUSHED_OUT * (depth - _SLOP_M) / dt_s) if depth > _SLOP_M else 0.0
        entry[6] = depth / dt_s if depth < 0.0 else out
        entry[7] = (tyre if braked else min(tyre, ROLLING_FRICTION)) if k < 4 else BODY_FRICTION
        entry[8] = tyre if k < 4 else BODY_FRICTION
        met += 1
    return met


@part
def _speed(v: Body) -> float:
    """Return more than what any point of the body moves at, m/s."""
    reach = v.half_extent[0] + v.half_extent[1] + v.half_extent[2]
    total = 0.0
    for axis in range(3):
        total += abs(v.velocity[axis]) + reach * abs(v.angular_velocity[axis])
    return float(total)


@part
def _press(v: Body, w: Work, met: int) -> None:
    """Change speed and spin by the impulses of all contacts: normal ones press only, friction stays in their share."""
    axes, points, given, along = w.axes, w.points, w.given_ns, w.along
    for k in range(met):
        for column in range(3):
            given[k, column] = 0.0
    for _ in range(_ROUNDS):
        for k in range(met):
            entry = points[k]
            for row in range(3):
                along[row] = entry[3 + row]
            wanted = _impulse(v, w, entry, entry[6])
            pressed = max(0.0, given[k, 0] + wanted)
            _apply(v, w, entry, pressed - given[k, 0])
            given[k, 0] = pressed
            for side in range(2):
                _write_tangent(axes, entry, side, along)
                most = entry[7 + side] * pressed
                held = max(-most, min(most, given[k, 1 + side] + _impulse(v, w, entry, 0.0)))
                _apply(v, w, entry, held - given[k, 1 + side])
                given[k, 1 + side] = held


@part
def _write_tangent(axes: F64, entry: F64, side: int, along: F64) -> None:
    """Write a direction in the ground's plane: where the nose points (the right side, if that is down), or across."""
    x, y, z = entry[3], entry[4], entry[5]
    column = 0 if abs(axes[0, 0] * x + axes[1, 0] * y + axes[2, 0] * z) < 0.95 else 1
    lean = axes[0, column] * x + axes[1, column] * y + axes[2, column] * z
    length = math.sqrt(1.0 - lean * lean)
    ahead_x, ahead_y = (axes[0, column] - lean * x) / length, (axes[1, column] - lean * y) / length
    ahead_z = (axes[2, column] - lean * z) / length
    if side == 0:
        along[0], along[1], along[2] = ahead_x, ahead_y, ahead_z
    else:
        along[0], along[1], along[2] = y * ahead_z - z * ahead_y, z * ahead_x - x * ahead_z, x * ahead_y - y * ahead_x


@part
def _impulse(v: Body, w: Work, entry: F64, wanted_mps: float) -> float:
    """Return the impulse (N·s) along a direction that gives the contact point the wanted speed along it."""
    weight, along, lever, speed, turn = w.weight, w.along, w.lever, w.speed, w.turn
    lever[0] = entry[1] * along[2] - entry[2] * along[1]
    lever[1] = entry[2] * along[0] - entry[0] * along[2]
    lever[2] = entry[0] * along[1] - entry[1] * along[0]
    ease, now = 1.0 / v.mass_kg, 0.0
    for row in range(3):
        now += speed[row] * along[row] + turn[row] * lever[row]
        for column in range(3):
            ease += lever[row] * weight[row, column] * lever[column]
    return float((wanted_mps - now) / ease)


@part
def _apply(v: Body, w: Work, entry: F64, impulse: float) -> None:
    """Apply an impulse (N·s) along a direction at a contact point."""
    weight, along, lever, speed, turn = w.weight, w.along, w.lever, w.speed, w.turn
    lever[0] = entry[1] * along[2] - entry[2] * along[1]
    lever[1] = entry[2] * along[0] - entry[0] * along[2]
    lever[2] = entry[0] * along[1] - entry[1] * along[0]
    for row in range(3):
        speed[row] += impulse * along[row] / v.mass_kg
        for column in range(3):
            turn[row] += impulse * weight[row, column] * lever[column]


@part
def _move(v: Body, w: Work, dt_s: float) -> None:
    """Move the centre of mass, turn the axes about it (Rodrigues' formula), and write the body's pose and motion."""
    axes, arm, speed, turn, middle = w.axes, w.arm, w.speed, w.turn, w.middle
    rate = math.sqrt(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2])
    if rate > 1e-12:
        x, y, z = turn[0] / rate, turn[1] / rate, turn[2] / rate
        cosine, sine = math.cos(rate * dt_s), math.sin(rate * dt_s)
        for k in range(3):
            a, b, c = axes[0, k], axes[1, k], axes[2, k]
            shared = (1.0 - cosine) * (x * a + y * b + z * c)
            axes[0, k] = cosine * a + sine * (y * c - z * b) + shared * x
            axes[1, k] = cosine * b + sine * (z * a - x * c) + shared * y
            axes[2, k] = cosine * c + sine * (x * b - y * a) + shared * z
    for row in range(3):
        middle[row] = v.position[row] + arm[row] + speed[row] * dt_s
    for row in range(3):
        arm[row] = 0.0
        for k in range(3):
            arm[row] += axes[row, k] * v.centre_of_mass[k]
        v.position[row] = middle[row] - arm[row]
        v.angular_velocity[row] = turn[row]
    v.velocity[0] = speed[0] - turn[1] * arm[2] + turn[2] * arm[1]
    v.velocity[1] = speed[1] - turn[2] * arm[0] + turn[0] * arm[2]
    v.velocity[2] = speed[2] - turn[0] * arm[1] + turn[1] * arm[0]
    v.rotation[0] = math.asin(max(-1.0, min(1.0, axes[2, 0])))
    if abs(axes[2, 0]) > 1.0 - 1e-9:  # the nose points straight up or down: the yaw says it all
        v.rotation[1], v.rotation[2] = within_turn(math.atan2(-axes[0, 1], axes[1, 1])), 0.0
    else:
        v.rotation[1] = within_turn(math.atan2(axes[1, 0], axes[0, 0]))
        v.rotation[2] = math.atan2(-axes[2, 1], axes[2, 2])


@part
def _stands(v: Body, spec: Spec, ground: Ground, axes: F64) -> bool:
    """Tell whether the wheels are on the ground again, and nothing will lift them off at once."""
    turning = abs(v.angular_velocity[0]) + abs(v.angular_velocity[1])
    across = abs(v.velocity[0] * axes[0, 1] + v.velocity[1] * axes[1, 1])
    if turning > _UPRIGHT_RADPS or across > 0.5 * tripping_speed_mps(v):
        return False
    for k in range(spec.wheel_count):
        ahead, right = spec.wheel_x_m[k], spec.wheel_y_m[k]
        x = v.position[0] + axes[0, 0] * ahead + axes[0, 1] * right
        y = v.position[1] + axes[1, 0] * ahead + axes[1, 1] * right
        z = v.position[2] + axes[2, 0] * ahead + axes[2, 1] * right
        height, normal_x, normal_y, normal_z, _ = surface_under(ground, x, y, z)
        upright = axes[0, 2] * normal_x + axes[1, 2] * normal_y + axes[2, 2] * normal_z
        if z - height > _NEAR_GROUND_M or upright < _UPRIGHT_COSINE:
            return False
    return True


@part
def _find_feet(v: Body) -> None:
    """Give the vehicle back to its wheels, with the rates of pitch and roll that go with its spin."""
    cosine, sine = math.cos(v.rotation[1]), math.sin(v.rotation[1])
    x, y = v.angular_velocity[0], v.angular_velocity[1]
    v.tilt_radps[0], v.tilt_radps[1] = x * sine - y * cosine, -x * cosine - y * sine
    v.heave_mps = v.velocity[2]
    v.footing[3] = 0.0
    v.felt_mps2[0], v.felt_mps2[1] = 0.0, 0.0
    v.still_s = 0.0
    v.resting, v.tumbling = False, False


@part
def push_tumbling(v: Body, w: Work, push: F64, spin: F64, share: float) -> None:
    """Apply a push (N·s, or N for ``share`` seconds) at the centre of mass and a turn (N·m·s, or N·m) in space."""
    arm, weight, gained = w.arm, w.weight, w.turn
    _write_axes(v, w)
    for row in range(3):
        gained[row] = 0.0
        for column in range(3):
            gained[row] += share * weight[row, column] * spin[column]
    for axis in range(3):
        v.velocity[axis] += share * push[axis] / v.mass_kg
        v.angular_velocity[axis] += gained[axis]
    v.velocity[0] -= gained[1] * arm[2] - gained[2] * arm[1]
    v.velocity[1] -= gained[2] * arm[0] - gained[0] * arm[2]
    v.velocity[2] -= gained[0] * arm[1] - gained[1] * arm[0]
    v.resting = False
