"""The motion in the plane of the road: the tyres' forces on the body, and what holds a standing one.

Two speeds of the centre of mass, forward and to the right, and the yaw rate: Rajamani, Vehicle Dynamics and Control,
2nd ed., section 8.1, four wheels. The forces are those of the moment before, as in PhysX: friction bounds them, so
they cannot blow up. Without throttle, where friction can hold the vehicle, it stands: no creeping, no chatter.
"""

import math

from linden.compiled import part
from linden.physics.state import Body, Spec, Work
from linden.physics.vehicle.tyre import free_slip, slip_tangent, tyre_push, worked_slip

STICKS_BELOW_MPS = 0.2  # slower ones come to a stop: PhysX's sticky tyre
STICKS_AFTER_S = 1.0  # that a wheel has been so slow without a brake


@part
def push_tyres(v: Body, spec: Spec, w: Work) -> None:
    """Write speeds, slips and forces of the tyres for the motion in ``speeds`` and the spins as they are."""
    x, y, turn = w.speeds[0], w.speeds[1], w.speeds[2]
    for k in range(spec.wheel_count):
        c, n = w.cosine[k], w.sine[k]
        along, across = x * c + y * n + turn * w.along_turn_m[k], y * c - x * n + turn * w.across_turn_m[k]
        rolling = v.wheel_omega[k] * spec.wheel_radius_m[k]
        if w.brake_nm[k] > 0.0 or (w.wants_to_go and spec.drive_share[k] > 0.0):
            slip = worked_slip(rolling, along)
        else:
            slip = free_slip(rolling, along)
        tangent = slip_tangent(across, along)
        w.along_mps[k], w.across_mps[k], w.slip[k] = along, across, slip
        w.push_x_n[k], w.push_y_n[k] = tyre_push(
            slip, tangent, spec.slip_stiffness_n[k], w.cornering_n[k], w.limit_n[k]
        )


@part
def move_body(v: Body, spec: Spec, w: Work, dt_s: float) -> None:
    """Advance ``speeds`` by one step under the tyres' forces, the outer ones and drag."""
    force_x = w.pull[0] - spec.drag_kgpm * abs(w.speeds[0]) * w.speeds[0]
    force_y, torque = w.pull[1], w.pull[2]
    for k in range(spec.wheel_count):
        c, n = w.cosine[k], w.sine[k]
        force_x += w.push_x_n[k] * c - w.push_y_n[k] * n
        force_y += w.push_x_n[k] * n + w.push_y_n[k] * c
        torque += w.push_x_n[k] * w.along_turn_m[k] + w.push_y_n[k] * w.across_turn_m[k]
    w.speeds[0] += dt_s * force_x / v.mass_kg
    w.speeds[1] += dt_s * force_y / v.mass_kg
    w.speeds[2] += dt_s * torque / v.yaw_inertia_kgm2


@part
def stands(v: Body, spec: Spec, w: Work, dt_s: float) -> bool:
    """Tell whether friction ends the step at rest, and count for how long the wheels have been slow.

    Coulomb's law in the time-stepped form: what is left of the motion and what pulls, against the limits of the tyres.
    Along its direction a wheel holds by its brake (by its friction where a locked wheel stays locked), or where it has
    been slow for a while. What counts as slow is the contact, and the tread too unless tyres lag: then it swings.
    """
    slow = not w.wants_to_go
    for k in range(spec.wheel_count):
        slow = slow and abs(w.along_mps[k]) < STICKS_BELOW_MPS
        slow = slow and (spec.tyres_lag or abs(v.wheel_omega[k]) * spec.wheel_radius_m[k] < STICKS_BELOW_MPS)
    v.slow_s = v.slow_s + dt_s if slow else 0.0
    if not slow:
        return False
    along, across, turning = 0.0, 0.0, 0.0
    for k in range(spec.wheel_count):
        across += w.limit_n[k]
        turning += w.limit_n[k] * math.sqrt(w.along_turn_m[k] ** 2 + w.across_turn_m[k] ** 2)
        if v.slow_s > STICKS_AFTER_S or (spec.tyres_lag and w.brake_nm[k] > 0.0 and v.wheel_omega[k] == 0.0):
            along += w.limit_n[k]
        else:
            along += min(w.limit_n[k], w.brake_nm[k] / spec.wheel_radius_m[k])
    need_x = abs(v.mass_kg * w.speeds[0] / dt_s + w.pull[0])
    need_y = abs(v.mass_kg * w.speeds[1] / dt_s + w.pull[1])
    need_turn = abs(v.yaw_inertia_kgm2 * w.speeds[2] / dt_s + w.pull[2])
    if across <= 0.0 or along <= 0.0 or need_turn > turning:
        return False
    return bool((need_x / along) ** 2 + (need_y / across) ** 2 <= 1.0)


@part
def stop(v: Body, spec: Spec, w: Work) -> None:
    """Leave the vehicle standing: what the tyres push is what the slope pulls."""
    total = 0.0
    for k in range(spec.wheel_count):
        total += w.limit_n[k]
        v.wheel_omega[k], w.slip[k] = 0.0, 0.0
        w.along_mps[k], w.across_mps[k] = 0.0, 0.0
    for k in range(spec.wheel_count):
        part_of = w.limit_n[k] / total
        w.push_x_n[k] = -part_of * (w.pull[0] * w.cosine[k] + w.pull[1] * w.sine[k])
        w.push_y_n[k] = -part_of * (w.pull[1] * w.cosine[k] - w.pull[0] * w.sine[k])
    for axis in range(3):
        w.speeds[axis] = 0.0
