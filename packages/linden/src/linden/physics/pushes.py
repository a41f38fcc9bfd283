"""Impulses, forces and torques that a client gives: impulses once, forces for as long as a frame lasts."""

import math

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kept_part, part
from linden.physics.state import SOURCES, VEHICLE, Body, Work
from linden.physics.tumble import push_tumbling, start_tumbling, tripping_speed_mps

F64 = NDArray[np.float64]

_SPRING_RADPS = 10.0  # vehicle.suspension.BOUNCE_RADPS
_OVERSHOOT = 0.36  # how far a rate swings a spring of 1.05 of critical damping, over rate / SPRING_RADPS
_LIFTED = 1.5  # of the lean at which one side carries all
_CAUGHT = 0.8  # of the tripping speed, from which on the fall is worked out in space


@part
def _turn(v: Body, yaw_radps: float, roll_push: float, pitch_push: float) -> None:
    """Add to the rates: yaw about the centre of mass; roll and pitch pushes in N·m·s about a vehicle's own axes."""
    cosine, sine = math.cos(v.rotation[1]), math.sin(v.rotation[1])
    ahead, right = v.centre_of_mass[0], v.centre_of_mass[1]
    v.angular_velocity[2] += yaw_radps
    v.velocity[0] += yaw_radps * (sine * ahead + cosine * right)
    v.velocity[1] -= yaw_radps * (cosine * ahead - sine * right)
    if v.kind == VEHICLE and (roll_push != 0.0 or pitch_push != 0.0):
        x, y, z = v.half_extent[0], v.half_extent[1], v.half_extent[2]
        v.tilt_radps[0] -= 3.0 * pitch_push / (v.mass_kg * (x * x + z * z))
        v.tilt_radps[1] -= 3.0 * roll_push / (v.mass_kg * (y * y + z * z))


@part
def _push(v: Body, w: Work, push: F64, spin: F64, share: float) -> None:
    """Apply a push and a turn (3,), whole or for ``share`` seconds; wakes a body at rest."""
    if push[0] == 0.0 and push[1] == 0.0 and push[2] == 0.0 and spin[0] == 0.0 and spin[1] == 0.0 and spin[2] == 0.0:
        return
    if v.tumbling:
        push_tumbling(v, w, push, spin, share)
        return
    for axis in range(3):
        v.velocity[axis] += share * push[axis] / v.mass_kg
    v.heave_mps += share * push[2] / v.mass_kg
    cosine, sine = math.cos(v.rotation[1]), math.sin(v.rotation[1])
    about_nose = share * (spin[0] * cosine + spin[1] * sine)
    about_side = share * (spin[1] * cosine - spin[0] * sine)
    _turn(v, share * spin[2] / v.yaw_inertia_kgm2, about_nose, about_side)
    v.resting = False
    if v.kind == VEHICLE and v.footing[3] != 0.0 and (_wheels_lift(v) or _trips(v)):
        start_tumbling(v)


@part
def _wheels_lift(v: Body) -> bool:
    """Tell whether a push has given more roll or pitch than the vehicle's weight can hold on its wheels.

    The springs hold up to the angle at which one side carries all, g / (bounce² l/2) with the wheels l/2 away. A rate
    r swings the body as far as r / bounce times the overshoot of a second-order system.
    """
    fall = 9.81 / _SPRING_RADPS**2
    for axis in range(2):
        reach = 0.75 * v.half_extent[1] if axis == 1 else 0.6 * v.half_extent[0]
        limit_rad = fall / reach
        lean = v.rotation[2 * axis] - v.footing[1 + axis]
        rate = v.tilt_radps[axis]
        if abs(rate) > limit_rad * _SPRING_RADPS / _OVERSHOOT:
            return True
        if abs(lean) > _LIFTED * limit_rad and lean * rate > 0.0:
            return True
    return False


@part
def _trips(v: Body) -> bool:
    """Tell whether a push has made the vehicle slide sideways so fast that caught wheels may throw it over."""
    across = v.velocity[1] * math.cos(v.rotation[1]) - v.velocity[0] * math.sin(v.rotation[1])
    return bool(abs(across) > _CAUGHT * tripping_speed_mps(v))


@kept_part(SOURCES)
def apply_impulses(v: Body, w: Work) -> None:
    """Apply what was given once: N·s and N·m·s."""
    _push(v, w, v.impulse, v.angular_impulse, 1.0)


@kept_part(SOURCES)
def apply_forces(v: Body, w: Work, dt_s: float) -> None:
    """Apply for one substep what acts throughout the frame: N and N·m."""
    _push(v, w, v.force, v.torque, dt_s)


@part
def clear_pushes(v: Body) -> None:
    """Forget all pushes: the frame is over."""
    for axis in range(3):
        v.impulse[axis], v.angular_impulse[axis] = 0.0, 0.0
        v.force[axis], v.torque[axis] = 0.0, 0.0


@part
def hold_velocity(v: Body) -> None:
    """Give a walker or prop the constant velocity that was asked for, in its own frame."""
    cosine, sine = math.cos(v.rotation[1]), math.sin(v.rotation[1])
    ahead, right = v.constant_velocity[0], v.constant_velocity[1]
    v.velocity[0] = cosine * ahead - sine * right
    v.velocity[1] = sine * ahead + cosine * right
