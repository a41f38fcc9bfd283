"""The motion in the plane of the road: tyres, brakes and engine against the mass, solved together for the step's end.

Three unknowns, the speeds forward and to the right of the centre of mass and the yaw rate, with the spins of the wheels
and of the engine eliminated. The equations are Rajamani's (Vehicle Dynamics and Control, 2nd ed., section 8.1, four
wheels), the time step is backward Euler with the tyres' secant stiffness: stable at any speed and any step, since every
force opposes the motion that makes it. A vehicle that its brakes can stop within the step is stopped: no creeping.
"""

import math

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kernel, part
from linden.physics.state import Body, Spec
from linden.physics.vehicle.tyre import secant_stiffness
from linden.physics.vehicle.wheels import (
    ACROSS,
    ALONG,
    ARM_X,
    ARM_Y,
    BRAKE,
    CORNERING,
    COS,
    GRIP,
    LIMIT,
    OMEGA,
    OWN,
    PUSH_X,
    PUSH_Y,
    SIN,
    SLIP,
    TURNS,
)

F64 = NDArray[np.float64]

MOST_ROUNDS = 12
SETTLED_MPS = 1e-4
"""What the last round may have changed; each round leaves about a tenth of the one before (0.001 m/s² at 0.01 s)."""


@part
def solve_motion(v: Body, spec: Spec, wheels: F64, start: F64, pull: F64, drive: F64, dt_s: float, speeds: F64) -> None:
    """Write into ``speeds`` (3,) the motion at the end of the step: m/s forward, m/s to the right, rad/s.

    ``start`` (3,): the motion before; ``pull`` (3,): outer forces (N, N, N·m), gravity's part along the slope
    included; ``drive`` (3,): as :func:`powertrain.axle_drive` returns it. Spins end in the scratch row OMEGA.
    """
    for k in range(3):
        speeds[k] = start[k]
    if _can_hold(v, spec, wheels, start, pull, drive, dt_s):
        speeds[:] = 0.0
        wheels[OMEGA, :] = 0.0
        _contact_speeds(spec, wheels, speeds)
        return
    _contact_speeds(spec, wheels, speeds)
    for _ in range(MOST_ROUNDS):
        before_x, before_y, before_turn = speeds[0], speeds[1], speeds[2]
        _stiffen(spec, wheels, dt_s)
        _solve_linear(v, spec, wheels, start, pull, drive, dt_s, speeds)
        _contact_speeds(spec, wheels, speeds)
        _spin(v, spec, wheels, drive, dt_s)
        moved = abs(speeds[0] - before_x) + abs(speeds[1] - before_y) + abs(speeds[2] - before_turn)
        if moved < SETTLED_MPS:
            break


@part
def _can_hold(v: Body, spec: Spec, wheels: F64, start: F64, pull: F64, drive: F64, dt_s: float) -> bool:
    """Tell whether brakes and tyres suffice to end the step at rest: Coulomb's friction in the time-stepped form.

    Along: what is left of each brake after engine and wheel inertia, within the tyre's limit, against what drives
    wheels beyond their own brakes; across: the tyres' limit; both on one ellipse. Turning: the limits times their
    lever arms.
    """
    along, across, turning, driven = 0.0, 0.0, 0.0, 0.0
    need_x = v.mass_kg * start[0] / dt_s + pull[0]
    need_y = v.mass_kg * start[1] / dt_s + pull[1]
    need_turn = v.yaw_inertia_kgm2 * start[2] / dt_s + pull[2]
    for k in range(spec.wheel_count):
        across += wheels[LIMIT, k]
    if max(abs(need_x), abs(need_y)) >= across:
        return False
    for k in range(spec.wheel_count):
        engine = abs(spec.drive_share[k] * drive[0] * drive[1])
        inertia = spec.wheel_inertia_kgm2[k] * abs(v.wheel_omega[k]) / dt_s
        held = (wheels[BRAKE, k] - engine - inertia) / spec.wheel_radius_m[k]
        along += min(max(0.0, held), wheels[LIMIT, k])
        driven += max(0.0, -held)
        turning += wheels[LIMIT, k] * math.hypot(wheels[ARM_X, k], wheels[ARM_Y, k])
    if along <= 0.0 or abs(need_turn) > turning:
        return False
    return bool(((abs(need_x) + driven) / along) ** 2 + (need_y / across) ** 2 <= 1.0)


@part
def _contact_speeds(spec: Spec, wheels: F64, speeds: F64) -> None:
    """Write how fast each contact point travels along and across its wheel."""
    for k in range(spec.wheel_count):
        x = speeds[0] - speeds[2] * wheels[ARM_Y, k]
        y = speeds[1] + speeds[2] * wheels[ARM_X, k]
        wheels[ALONG, k] = x * wheels[COS, k] + y * wheels[SIN, k]
        wheels[ACROSS, k] = y * wheels[COS, k] - x * wheels[SIN, k]


@part
def _stiffen(spec: Spec, wheels: F64, dt_s: float) -> None:
    """Write the tyres' secant stiffness for the sliding as it now stands, and what follows for the wheels' spin."""
    for k in range(spec.wheel_count):
        radius = spec.wheel_radius_m[k]
        push_x, push_y = secant_stiffness(
            wheels[OMEGA, k] * radius - wheels[ALONG, k],
            wheels[ACROSS, k],
            wheels[ALONG, k],
            wheels[SLIP, k],
            wheels[CORNERING, k],
            wheels[LIMIT, k],
        )
        own = spec.wheel_inertia_kgm2[k] / dt_s + spec.wheel_damping_nms[k] + radius * radius * push_x
        wheels[PUSH_X, k], wheels[PUSH_Y, k], wheels[OWN, k] = push_x, push_y, own
        wheels[GRIP, k] = radius * push_x / own if wheels[TURNS, k] != 0.0 else 0.0


@part
def _coupling(v: Body, spec: Spec, wheels: F64, drive: F64, dt_s: float) -> tuple[float, float]:
    """Return how strongly the drive ties the spins together (N·m·s/rad), and its constant part (rad/s).

    The wheels obey (diag(OWN) + c q q') w = y with the shares q of the drive; Sherman-Morrison inverts it.
    """
    tie = drive[0] * drive[0] * drive[2]
    loose, constant = 0.0, 0.0
    for k in range(spec.wheel_count):
        if wheels[TURNS, k] != 0.0:
            share = spec.drive_share[k]
            loose += share * share / wheels[OWN, k]
            constant += share * _spin_push(v, spec, wheels, k, drive, dt_s) / wheels[OWN, k]
    return tie / (1.0 + tie * loose), constant


@part
def _spin_push(v: Body, spec: Spec, wheels: F64, k: int, drive: F64, dt_s: float) -> float:
    """Return the torque on a turning wheel but for the road's: inertia, engine against standing wheels, brake."""
    engine = spec.drive_share[k] * drive[0] * drive[1]
    return float(spec.wheel_inertia_kgm2[k] / dt_s * v.wheel_omega[k] + engine - wheels[TURNS, k] * wheels[BRAKE, k])


@part
def _solve_linear(
    v: Body, spec: Spec, wheels: F64, start: F64, pull: F64, drive: F64, dt_s: float, speeds: F64
) -> None:
    """Solve the equations of motion with the stiffnesses as they stand (symmetric, positive definite)."""
    inertia_x, inertia_turn = v.mass_kg / dt_s, v.yaw_inertia_kgm2 / dt_s
    xx, yy, tt = inertia_x + spec.drag_kgpm * abs(speeds[0]), inertia_x, inertia_turn
    xy, xt, yt = 0.0, 0.0, 0.0
    x, y, t = inertia_x * start[0] + pull[0], inertia_x * start[1] + pull[1], inertia_turn * start[2] + pull[2]
    tied, constant = _coupling(v, spec, wheels, drive, dt_s)
    tie_x, tie_y, tie_t = 0.0, 0.0, 0.0
    for k in range(spec.wheel_count):
        c, n, grip = wheels[COS, k], wheels[SIN, k], wheels[GRIP, k]
        along_t = wheels[ARM_X, k] * n - wheels[ARM_Y, k] * c
        across_t = wheels[ARM_X, k] * c + wheels[ARM_Y, k] * n
        along = wheels[PUSH_X, k] * (1.0 - spec.wheel_radius_m[k] * grip)
        across = wheels[PUSH_Y, k]
        xx += along * c * c + across * n * n
        xy += (along - across) * c * n
        yy += along * n * n + across * c * c
        xt += along * c * along_t - across * n * across_t
        yt += along * n * along_t + across * c * across_t
        tt += along * along_t * along_t + across * across_t * across_t
        if grip != 0.0:
            share = spec.drive_share[k]
            force = grip * (_spin_push(v, spec, wheels, k, drive, dt_s) - tied * share * constant)
            x, y, t = x + force * c, y + force * n, t + force * along_t
            tie_x, tie_y, tie_t = tie_x + share * grip * c, tie_y + share * grip * n, tie_t + share * grip * along_t
    xx, xy, yy = xx + tied * tie_x * tie_x, xy + tied * tie_x * tie_y, yy + tied * tie_y * tie_y
    xt, yt, tt = xt + tied * tie_x * tie_t, yt + tied * tie_y * tie_t, tt + tied * tie_t * tie_t
    _solve_symmetric(xx, xy, xt, yy, yt, tt, x, y, t, speeds)


@kernel
def _solve_symmetric(
    xx: float, xy: float, xt: float, yy: float, yt: float, tt: float, x: float, y: float, t: float, out: F64
) -> None:
    """Solve a symmetric positive definite system of three by elimination (LDL')."""
    xy_by, xt_by = xy / xx, xt / xx
    yy -= xy_by * xy
    yt -= xy_by * xt
    y -= xy_by * x
    tt -= xt_by * xt
    t -= xt_by * x
    yt_by = yt / yy
    out[2] = (t - yt_by * y) / (tt - yt_by * yt)
    out[1] = y / yy - yt_by * out[2]
    out[0] = x / xx - xy_by * out[1] - xt_by * out[2]


@part
def _spin(v: Body, spec: Spec, wheels: F64, drive: F64, dt_s: float) -> None:
    """Write the spins that go with the contact speeds, and whether a brake locks a wheel or which way it turns."""
    tied, constant = _coupling(v, spec, wheels, drive, dt_s)
    for k in range(spec.wheel_count):
        constant += spec.drive_share[k] * wheels[GRIP, k] * wheels[ALONG, k]
    for k in range(spec.wheel_count):
        road = spec.wheel_radius_m[k] * wheels[PUSH_X, k] * wheels[ALONG, k]
        free = _spin_push(v, spec, wheels, k, drive, dt_s) + wheels[TURNS, k] * wheels[BRAKE, k] + road
        if wheels[TURNS, k] != 0.0:
            free -= tied * spec.drive_share[k] * constant
        else:
            free -= drive[0] * drive[0] * drive[2] * spec.drive_share[k] * _mean_spin(spec, wheels)
        if abs(free) <= wheels[BRAKE, k]:
            wheels[TURNS, k], wheels[OMEGA, k] = 0.0, 0.0
        else:
            wheels[TURNS, k] = 1.0 if free > 0.0 else -1.0
            wheels[OMEGA, k] = (free - wheels[TURNS, k] * wheels[BRAKE, k]) / wheels[OWN, k]


@part
def _mean_spin(spec: Spec, wheels: F64) -> float:
    """Return the drive-weighted mean of the wheels' spins, rad/s."""
    mean = 0.0
    for k in range(spec.wheel_count):
        mean += spec.drive_share[k] * wheels[OMEGA, k]
    return mean
