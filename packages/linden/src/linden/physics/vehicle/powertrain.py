"""Engine, clutch, gearbox and differential: throttle in, spins of the wheels out, solved together for the step's end.

CARLA's vehicles are PhysX's: an engine with inertia and viscous damping, a clutch that transmits torque in proportion
to its slip, an automatic that opens the clutch while it changes, limited-slip differentials. Source: NVIDIA PhysX 3.4,
PxVehicleUpdate.cpp (processAutoBox, processGears, computeDiffTorqueRatios, solveDrive4WInternaDynamics…).
"""

import math

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kernel, part
from linden.physics.state import Body, Spec, Work
from linden.physics.vehicle.tyre import FREE_ROLL_MPS

F64 = NDArray[np.float64]

RPM_PER_RADPS = 30.0 / math.pi
NEUTRAL_UP = 0.15  # of the engine's greatest speed: from there on the automatic leaves neutral; PhysX's default
AUTOBOX_LATENCY_S = 0.5  # between two changes; recorded (docs/explanation/fidelity.md), PhysX's own default is 2.0
_LEAST_SLIDE_MPS = 1e-4
DIFFERENTIAL_BIAS = 1.3  # of two spins; from there on torque is taken from the faster wheel: PhysX's default


@kernel
def on_curve(x: float, xs: F64, ys: F64, count: int) -> float:
    """Return the value at ``x`` of a polyline of ``count`` points; its ends go on level."""
    if x <= xs[0]:
        return float(ys[0])
    for k in range(1, count):
        if x < xs[k]:
            return float(ys[k - 1] + (ys[k] - ys[k - 1]) * (x - xs[k - 1]) / (xs[k] - xs[k - 1]))
    return float(ys[count - 1])


@part
def change_gear(v: Body, spec: Spec, dt_s: float) -> None:
    """Let the driver (manual, reverse: at once) or the automatic (in ``switch_time_s``, gear 0 meanwhile) choose.

    A vehicle begins in neutral. The automatic looks again ``AUTOBOX_LATENCY_S`` after it last began to change.
    """
    if v.reverse != v.was_reverse:
        v.was_reverse = v.reverse
        _engage(v, -1 if v.reverse else 1)
    elif v.manual_gear_shift:
        _engage(v, max(-1, min(spec.gear_count, v.gear_command)))
    elif spec.autobox:
        if v.target_gear == v.gear and v.since_shift_s > AUTOBOX_LATENCY_S:
            _shift(v, spec)
        else:
            v.since_shift_s += dt_s
        if v.target_gear != v.gear:
            if v.shift_left_s < 0.0:
                _engage(v, v.target_gear)
            else:
                v.shift_left_s -= dt_s
    elif v.target_gear != v.gear:
        _engage(v, v.target_gear)


@part
def _engage(v: Body, gear: int) -> None:
    """Have a gear at once."""
    v.gear, v.target_gear, v.shift_left_s = gear, gear, 0.0


@part
def _shift(v: Body, spec: Spec) -> None:
    """Begin to change where the engine's speed asks for it; reverse stays."""
    gear = v.gear
    if gear < 0:
        return
    use = v.engine_rpm / RPM_PER_RADPS / spec.engine_max_radps
    target = gear
    if gear == 0:
        target = 1 if use > NEUTRAL_UP else 0
    elif use > spec.gear_up[gear - 1]:
        target = min(spec.gear_count, gear + 1)
    elif gear > 1 and use < spec.gear_down[gear - 1]:
        target = gear - 1
    if target != gear:
        v.gear, v.target_gear = 0, target
        v.shift_left_s, v.since_shift_s = spec.switch_time_s, 0.0


@part
def total_ratio(v: Body, spec: Spec) -> float:
    """Return engine turns per wheel turn, negative in reverse, 0 in neutral."""
    gear = v.gear
    if gear == 0:
        return 0.0
    if gear < 0:
        return float(spec.reverse_ratio)
    return float(spec.gear_ratio[gear - 1])


@part
def pedal(v: Body, throttle: float) -> float:
    """Return the throttle that the engine gets: the automatic lifts the foot while it changes."""
    return 0.0 if v.gear == 0 and v.target_gear != 0 else throttle


@part
def share_torque(v: Body, spec: Spec, w: Work) -> None:
    """Write each wheel's share of the torque at the clutch: limited-slip differentials, four driven wheels.

    With the hand brake on, only the front is driven (PhysX's rule). Two-wheelers drive their rear wheel.
    """
    if spec.wheel_count == 2:
        w.share[0], w.share[1] = 0.0, 1.0
        return
    omega = v.wheel_omega
    front = 1.0 if w.hand_braked else spec.drive_share[0] + spec.drive_share[1]
    same_front, same_rear = omega[0] * omega[1] > 0.0, omega[2] * omega[3] > 0.0
    if not w.hand_braked and same_front and same_rear and omega[0] * omega[2] > 0.0:
        front = _split(abs(omega[0] + omega[1]), abs(omega[2] + omega[3]), front)
    elif not w.hand_braked:
        same_front = same_rear = False
    left = _split(abs(omega[0]), abs(omega[1]), 0.5) if same_front else 0.5
    w.share[0], w.share[1] = front * left, front * (1.0 - left)
    left = _split(abs(omega[2]), abs(omega[3]), 0.5) if same_rear else 0.5
    w.share[2], w.share[3] = (1.0 - front) * left, (1.0 - front) * (1.0 - left)


@kernel
def _split(first_radps: float, second_radps: float, share: float) -> float:
    """Return the first output's part of a differential's torque; ``share`` is that of equal spins, which are > 0."""
    fastest, slowest = max(first_radps, second_radps), min(first_radps, second_radps)
    beyond = fastest - DIFFERENTIAL_BIAS * slowest
    taken = beyond / fastest if beyond >= 0.0 else 0.0
    if first_radps >= second_radps:
        taken = -taken
    first, second = share * (1.0 + taken), (1.0 - share) * (1.0 - taken)
    return first / (first + second)


@part
def weigh_wheels(spec: Spec, w: Work, dt_s: float) -> None:
    """Fill the scratch columns of the wheels' inertia that stay fixed for steps of ``dt_s``."""
    for k in range(spec.wheel_count):
        w.spin_nms[k] = spec.wheel_inertia_kgm2[k] / dt_s
        w.drag_nms[k] = w.spin_nms[k] + spec.wheel_damping_nms[k]


@part
def turn_wheels_and_engine(v: Body, spec: Spec, w: Work, throttle: float, dt_s: float) -> None:
    """Advance the spins of wheels and engine by one step under tyres, brakes and throttle.

    Engine, J e' = T - d e - t, and wheels, I w' = ratio share t - d w + brake + tyre, are tied by the clutch,
    t = K (e - ratio S) with the mean spin S: implicit in the spins (backward Euler). Eliminating e and the wheels
    leaves one equation for the torque t. The tyre's torque is that of the moment before where ``tyres_lag`` says so
    (then light wheels swing, and brakes lock them, as they do in CARLA), else it is solved with the spin.
    """
    share_torque(v, spec, w)
    ratio = total_ratio(v, spec)
    clutch = spec.clutch_nms if ratio != 0.0 else 0.0
    engine = v.engine_rpm / RPM_PER_RADPS
    closed = spec.damping_disengaged if ratio == 0.0 else spec.damping_engaged
    damping = closed + (spec.damping_full_throttle - closed) * throttle
    torque_nm = throttle * on_curve(engine, spec.torque_radps, spec.torque_nm, spec.torque_points)
    inertia = spec.engine_inertia_kgm2 / dt_s
    own = inertia + damping + clutch
    pushed = inertia * engine + torque_nm
    mean, eased = 0.0, 0.0
    for k in range(spec.wheel_count):
        weight = _mean_share(spec, w, k)
        w.grip_nspm[k] = 0.0 if spec.tyres_lag else _grip(v, spec, w, k)
        w.ease[k] = 1.0 / (w.drag_nms[k] + spec.wheel_radius_m[k] ** 2 * w.grip_nspm[k])
        w.free_nm[k] = _free_nm(v, spec, w, k)
        mean += weight * w.ease[k] * (w.free_nm[k] - _brake_nm(v, w, k))
        eased += weight * w.ease[k] * w.share[k]
    slipping = clutch * (pushed / own - (1.0 - clutch / own) * ratio * mean)
    clutch_nm = slipping / (1.0 + clutch * (1.0 - clutch / own) * ratio * ratio * eased)
    mean += ratio * clutch_nm * eased
    for k in range(spec.wheel_count):
        _turn_wheel(v, spec, w, k, ratio * w.share[k] * clutch_nm)
    radps = max(0.0, min(spec.engine_max_radps, (pushed + clutch * ratio * mean) / own))
    v.engine_rpm = radps * RPM_PER_RADPS if radps > 0.01 else 0.0


@part
def _mean_share(spec: Spec, w: Work, k: int) -> float:
    """Return what a wheel's spin counts in the mean at the clutch."""
    if w.hand_braked and spec.wheel_count > 2:
        return 0.5 if k < 2 else 0.0
    return float(spec.drive_share[k])


@part
def _grip(v: Body, spec: Spec, w: Work, k: int) -> float:
    """Return a tyre's push over its sliding, N·s/m: its secant, or for the smallest sliding its tangent."""
    slide = v.wheel_omega[k] * spec.wheel_radius_m[k] - w.along_mps[k]
    if abs(slide) > _LEAST_SLIDE_MPS and w.push_x_n[k] != 0.0:
        return float(w.push_x_n[k] / slide)
    return float(spec.slip_stiffness_n[k] / max(FREE_ROLL_MPS, abs(w.along_mps[k]))) if w.limit_n[k] > 0.0 else 0.0


@part
def _free_nm(v: Body, spec: Spec, w: Work, k: int) -> float:
    """Return the right side of a wheel's equation without drive and brake, N·m."""
    radius = spec.wheel_radius_m[k]
    tyre_nm = radius * (w.grip_nspm[k] * w.along_mps[k] if w.grip_nspm[k] > 0.0 else -w.push_x_n[k])
    return float(w.spin_nms[k] * v.wheel_omega[k] + tyre_nm)


@part
def _brake_nm(v: Body, w: Work, k: int) -> float:
    """Return the brake's torque against the spin; a standing wheel has none yet."""
    omega = v.wheel_omega[k]
    return float(w.brake_nm[k] if omega > 0.0 else (-w.brake_nm[k] if omega < 0.0 else 0.0))


@part
def _turn_wheel(v: Body, spec: Spec, w: Work, k: int, drive_nm: float) -> None:
    """Write a wheel's new spin, the torque of engine less brake, and the tyre's push that goes with it.

    A braked wheel that would turn back stands. It stands as long as the brake is not released where ``tyres_lag``
    says so (PhysX: a locked wheel brakes with all its friction, more than the brake's torque), else as long as the
    brake can hold it.
    """
    free_nm = w.free_nm[k] + drive_nm
    brake_nm = _brake_nm(v, w, k)
    omega = w.ease[k] * (free_nm - brake_nm)
    if w.brake_nm[k] > 0.0 and omega * v.wheel_omega[k] <= 0.0:
        held = spec.tyres_lag or v.wheel_omega[k] != 0.0 or abs(free_nm) <= w.brake_nm[k]
        omega = 0.0 if held else w.ease[k] * (free_nm - math.copysign(w.brake_nm[k], free_nm))
    v.wheel_torque[k] = drive_nm - brake_nm
    v.wheel_omega[k] = omega
    if w.grip_nspm[k] > 0.0:
        push_n = w.grip_nspm[k] * (omega * spec.wheel_radius_m[k] - w.along_mps[k])
        most_n = math.sqrt(max(0.0, w.limit_n[k] * w.limit_n[k] - w.push_y_n[k] * w.push_y_n[k]))
        w.push_x_n[k] = max(-most_n, min(most_n, push_n))
