"""The wheels of the vehicle at hand before its motion is worked out: steering angles, loads, grip, brakes.

Where a rule is PhysX's, its source is NVIDIA PhysX 3.4, PxVehicleUpdate.cpp and PxVehicleComponents.h.
"""

import math

from linden.compiled import kernel, part
from linden.physics.axes import within_turn
from linden.physics.state import Body, Spec, Work
from linden.physics.vehicle.driver import BRAKE, HAND_BRAKE, STEER
from linden.physics.vehicle.suspension import BOUNCE_RADPS, DAMPING
from linden.physics.vehicle.tyre import cornering_stiffness

ROAD_FRICTION = 0.7
"""What a tyre's friction is multiplied with on any dry ground: Unreal's default physical material."""

WHEEL_MASS_KG = 20.0
"""Of a wheel as PhysX has it by default, a uniform disc; CARLA's physics control has no field for it."""

_LEAST_GRIP_LOAD = 0.2308  # of the load at rest: what grips where nothing presses; PhysX's tyre load filter
_MOST_GRIP_LOAD = 3.0


@part
def steer_wheels(v: Body, spec: Spec) -> None:
    """Set the steering angles: what the driver's hands give times the axle's greatest angle.

    The inner wheel takes that angle. The outer wheel turns around the same centre (Ackermann):
    cot(outer) = cot(inner) + track / wheelbase. Rajamani, Vehicle Dynamics and Control, 2nd ed., section 2.2.
    Rear wheels that steer turn the other way (PhysX).
    """
    half = spec.wheel_count // 2
    for axle in range(2):
        most = 0.0
        for k in range(axle * half, axle * half + half):
            most = max(most, spec.steer_max_rad[k])
        inner = v.given[STEER] * most
        for k in range(axle * half, axle * half + half):
            angle = inner
            if inner * spec.wheel_y_m[k] < 0.0:
                tangent = math.tan(abs(inner))
                outer = math.atan(tangent / (1.0 + tangent * spec.track_m / spec.wheelbase_m))
                angle = math.copysign(outer, inner)
            v.wheel_steer[k] = angle if axle == 0 else -angle


@part
def load_wheels(v: Body, spec: Spec) -> None:
    """Set the wheels' loads: shares of the ground's support, moved by the springs' pitch and roll, none below zero.

    After a wheel has lifted, the others carry its share.
    """
    stiff, slow = BOUNCE_RADPS * BOUNCE_RADPS, 2.0 * DAMPING * BOUNCE_RADPS
    pitching = stiff * (v.rotation[0] - v.footing[1]) + slow * v.tilt_radps[0]
    rolling = stiff * (v.rotation[2] - v.footing[2]) + slow * v.tilt_radps[1]
    carried = 0.0
    for k in range(spec.wheel_count):
        ahead, right = spec.wheel_x_m[k] - v.centre_of_mass[0], spec.wheel_y_m[k] - v.centre_of_mass[1]
        moved = rolling * right - pitching * ahead
        load = max(0.0, spec.load_share[k] * (v.support_mps2 + moved)) * v.mass_kg
        v.wheel_load[k] = load
        carried += load
    scale = v.support_mps2 * v.mass_kg / carried if carried > 0.0 else 0.0
    for k in range(spec.wheel_count):
        v.wheel_load[k] *= scale


@kernel
def grip_load(load_n: float, rest_n: float) -> float:
    """Return the load that counts for friction: PhysX lifts small ones (its PxVehicleTireLoadFilterData)."""
    if load_n <= 0.0 or rest_n <= 0.0:
        return 0.0
    use = min(load_n / rest_n, _MOST_GRIP_LOAD)
    return rest_n * (_LEAST_GRIP_LOAD + use * (1.0 - _LEAST_GRIP_LOAD / _MOST_GRIP_LOAD))


@part
def prepare_wheels(v: Body, spec: Spec, w: Work, gravity_mps2: float) -> None:
    """Fill the scratch columns that stay fixed for a substep."""
    for k in range(spec.wheel_count):
        rest_n = (spec.load_share[k] * v.mass_kg + WHEEL_MASS_KG) * gravity_mps2
        load = grip_load(v.wheel_load[k], rest_n)
        friction = spec.friction[k] if v.friction_here < 0.0 else v.friction_here
        w.limit_n[k] = ROAD_FRICTION * friction * v.road_friction * load
        w.cornering_n[k] = cornering_stiffness(spec.cornering_per_rad[k], spec.cornering_full_load[k], load, rest_n)
        if v.wheel_steer[k] == 0.0:
            w.cosine[k], w.sine[k] = 1.0, 0.0
        else:
            w.cosine[k], w.sine[k] = math.cos(v.wheel_steer[k]), math.sin(v.wheel_steer[k])
        arm_x, arm_y = spec.wheel_x_m[k] - v.centre_of_mass[0], spec.wheel_y_m[k] - v.centre_of_mass[1]
        w.along_turn_m[k] = arm_x * w.sine[k] - arm_y * w.cosine[k]
        w.across_turn_m[k] = arm_x * w.cosine[k] + arm_y * w.sine[k]
        w.brake_nm[k] = spec.brake_nm[k] * v.given[BRAKE] + spec.hand_brake_nm[k] * v.given[HAND_BRAKE]


@part
def turn_wheels(v: Body, spec: Spec, dt_s: float) -> None:
    """Turn the wheels on by their spin: what an onlooker sees of them."""
    if v.resting:
        return
    for k in range(spec.wheel_count):
        v.wheel_turned[k] = within_turn(v.wheel_turned[k] + v.wheel_omega[k] * dt_s)
