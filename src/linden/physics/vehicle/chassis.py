"""The motion in the plane of the road: tyres, brakes and engine against the mass, solved together for the step's end.

Three unknowns, the speeds forward and to the right of the centre of mass and the yaw rate, with the spins of the wheels
and of the engine eliminated. The equations are Rajamani's (Vehicle Dynamics and Control, 2nd ed., section 8.1, four
wheels), the time step is backward Euler with the tyres' secant stiffness: stable at any speed and any step, since every
force opposes the motion that makes it. A vehicle that its brakes can stop within the step is stopped: no creeping.
"""

import math

from linden.compiled import kernel, part
from linden.physics.state import Body, Spec, Work
from linden.physics.vehicle.tyre import secant_stiffness

MOST_ROUNDS = 12
SETTLED_MPS = 1e-4
"""What the last round may have changed; each round leaves about a tenth of the one before (0.001 m/s² at 0.01 s)."""


@part
def solve_motion(v: Body, spec: Spec, w: Work, dt_s: float) -> None:
    """Write into ``speeds`` the motion at the end of the step; the spins end in ``omega_radps``.

    ``start``, ``pull``, ``drive`` and the wheels' columns of the scratch are to be filled before.
    """
    for k in range(3):
        w.speeds[k] = w.start[k]
    if _can_hold(v, spec, w, dt_s):
        for axis in range(3):
            w.speeds[axis] = 0.0
        for k in range(spec.wheel_count):
            w.omega_radps[k] = 0.0
        _contact_speeds(spec, w)
        return
    _contact_speeds(spec, w)
    for _ in range(MOST_ROUNDS):
        before_x, before_y, before_turn = w.speeds[0], w.speeds[1], w.speeds[2]
        _stiffen(spec, w)
        tied, constant = _coupling(spec, w)
        _solve_linear(v, spec, w, tied, constant, dt_s)
        _contact_speeds(spec, w)
        _spin(spec, w, tied, constant)
        moved = abs(w.speeds[0] - before_x) + abs(w.speeds[1] - before_y) + abs(w.speeds[2] - before_turn)
        if moved < SETTLED_MPS:
            break


@part
def _can_hold(v: Body, spec: Spec, w: Work, dt_s: float) -> bool:
    """Tell whether brakes and tyres suffice to end the step at rest: Coulomb's friction in the time-stepped form.

    Along: what is left of each brake after engine and wheel inertia, within the tyre's limit, against what drives
    wheels beyond their own brakes; across: the tyres' limit; both on one ellipse. Turning: the limits times their
    lever arms.
    """
    along, across, turning, driven = 0.0, 0.0, 0.0, 0.0
    need_x = v.mass_kg * w.start[0] / dt_s + w.pull[0]
    need_y = v.mass_kg * w.start[1] / dt_s + w.pull[1]
    need_turn = v.yaw_inertia_kgm2 * w.start[2] / dt_s + w.pull[2]
    for k in range(spec.wheel_count):
        across += w.limit_n[k]
    if max(abs(need_x), abs(need_y)) >= across:
        return False
    for k in range(spec.wheel_count):
        engine = abs(spec.drive_share[k] * w.drive[0] * w.drive[1])
        inertia = w.inertia_nms[k] * abs(v.wheel_omega[k])
        held = (w.brake_nm[k] - engine - inertia) / spec.wheel_radius_m[k]
        along += min(max(0.0, held), w.limit_n[k])
        driven += max(0.0, -held)
        turning += w.limit_n[k] * math.hypot(w.along_turn_m[k], w.across_turn_m[k])
    if along <= 0.0 or abs(need_turn) > turning:
        return False
    return bool(((abs(need_x) + driven) / along) ** 2 + (need_y / across) ** 2 <= 1.0)


@part
def _contact_speeds(spec: Spec, w: Work) -> None:
    """Write how fast each contact point travels along and across its wheel."""
    x, y, turn = w.speeds[0], w.speeds[1], w.speeds[2]
    for k in range(spec.wheel_count):
        c, n = w.cosine[k], w.sine[k]
        w.along_mps[k] = x * c + y * n + turn * w.along_turn_m[k]
        w.across_mps[k] = y * c - x * n + turn * w.across_turn_m[k]


@part
def _stiffen(spec: Spec, w: Work) -> None:
    """Write the tyres' secant stiffness for the sliding as it now stands, and what follows for the wheels' spin."""
    for k in range(spec.wheel_count):
        radius = spec.wheel_radius_m[k]
        push_x, push_y = secant_stiffness(
            w.omega_radps[k] * radius - w.along_mps[k],
            w.across_mps[k],
            w.along_mps[k],
            w.slip_n[k],
            w.cornering_n[k],
            w.limit_n[k],
        )
        ease = 1.0 / (w.inertia_nms[k] + spec.wheel_damping_nms[k] + radius * radius * push_x)
        w.push_x_nspm[k], w.push_y_nspm[k], w.ease[k] = push_x, push_y, ease
        w.grip_per_m[k] = radius * push_x * ease if w.turns[k] != 0.0 else 0.0


@part
def _coupling(spec: Spec, w: Work) -> tuple[float, float]:
    """Return how strongly the drive ties the spins together (N·m·s/rad), and its constant part (rad/s).

    The wheels obey (diag(1 / EASE) + c q q') w = y with the shares q of the drive; Sherman-Morrison inverts it.
    """
    tie = w.drive[0] * w.drive[0] * w.drive[2]
    loose, constant = 0.0, 0.0
    for k in range(spec.wheel_count):
        if w.turns[k] != 0.0:
            eased = spec.drive_share[k] * w.ease[k]
            loose += spec.drive_share[k] * eased
            constant += eased * (w.pushed_nm[k] - w.turns[k] * w.brake_nm[k])
    return tie / (1.0 + tie * loose), constant


@part
def _solve_linear(v: Body, spec: Spec, w: Work, tied: float, constant: float, dt_s: float) -> None:
    """Solve the equations of motion with the stiffnesses as they stand (symmetric, positive definite)."""
    inertia_x, inertia_turn = v.mass_kg / dt_s, v.yaw_inertia_kgm2 / dt_s
    xx, yy, tt = inertia_x + spec.drag_kgpm * abs(w.speeds[0]), inertia_x, inertia_turn
    xy, xt, yt = 0.0, 0.0, 0.0
    x, y, t = (
        inertia_x * w.start[0] + w.pull[0],
        inertia_x * w.start[1] + w.pull[1],
        inertia_turn * w.start[2] + w.pull[2],
    )
    tie_x, tie_y, tie_t = 0.0, 0.0, 0.0
    for k in range(spec.wheel_count):
        c, n, grip, share = w.cosine[k], w.sine[k], w.grip_per_m[k], spec.drive_share[k]
        along_t, across_t = w.along_turn_m[k], w.across_turn_m[k]
        along = w.push_x_nspm[k] * (1.0 - spec.wheel_radius_m[k] * grip)
        across = w.push_y_nspm[k]
        xx += along * c * c + across * n * n
        xy += (along - across) * c * n
        yy += along * n * n + across * c * c
        xt += along * c * along_t - across * n * across_t
        yt += along * n * along_t + across * c * across_t
        tt += along * along_t * along_t + across * across_t * across_t
        # what turns the wheel turns the body, as far as the road grips
        force = grip * (w.pushed_nm[k] - w.turns[k] * w.brake_nm[k] - tied * share * constant)
        x, y, t = x + force * c, y + force * n, t + force * along_t
        tie_x, tie_y, tie_t = tie_x + share * grip * c, tie_y + share * grip * n, tie_t + share * grip * along_t
    xx, xy, yy = xx + tied * tie_x * tie_x, xy + tied * tie_x * tie_y, yy + tied * tie_y * tie_y
    xt, yt, tt = xt + tied * tie_x * tie_t, yt + tied * tie_y * tie_t, tt + tied * tie_t * tie_t
    w.speeds[0], w.speeds[1], w.speeds[2] = _solve_symmetric(xx, xy, xt, yy, yt, tt, x, y, t)


@kernel
def _solve_symmetric(
    xx: float, xy: float, xt: float, yy: float, yt: float, tt: float, x: float, y: float, t: float
) -> tuple[float, float, float]:
    """Solve a symmetric positive definite system of three by elimination (LDL')."""
    xy_by, xt_by = xy / xx, xt / xx
    yy -= xy_by * xy
    yt -= xy_by * xt
    y -= xy_by * x
    tt -= xt_by * xt
    t -= xt_by * x
    yt_by = yt / yy
    t_now = (t - yt_by * y) / (tt - yt_by * yt)
    y_now = y / yy - yt_by * t_now
    return x / xx - xy_by * y_now - xt_by * t_now, y_now, t_now


@part
def _spin(spec: Spec, w: Work, tied: float, constant: float) -> None:
    """Write the spins that go with the contact speeds, and whether a brake locks a wheel or which way it turns."""
    for k in range(spec.wheel_count):
        constant += spec.drive_share[k] * w.grip_per_m[k] * w.along_mps[k]
    for k in range(spec.wheel_count):
        free = w.pushed_nm[k] + spec.wheel_radius_m[k] * w.push_x_nspm[k] * w.along_mps[k]
        if w.turns[k] != 0.0:
            free -= tied * spec.drive_share[k] * constant
        else:
            free -= w.drive[0] * w.drive[0] * w.drive[2] * spec.drive_share[k] * _mean_spin(spec, w)
        if abs(free) <= w.brake_nm[k]:
            w.turns[k], w.omega_radps[k] = 0.0, 0.0
        else:
            w.turns[k] = 1.0 if free > 0.0 else -1.0
            w.omega_radps[k] = (free - w.turns[k] * w.brake_nm[k]) * w.ease[k]


@part
def _mean_spin(spec: Spec, w: Work) -> float:
    """Return the drive-weighted mean of the wheels' spins, rad/s."""
    mean = 0.0
    for k in range(spec.wheel_count):
        mean += spec.drive_share[k] * w.omega_radps[k]
    return mean
