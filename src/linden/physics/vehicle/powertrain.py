"""Engine, clutch and gearbox: throttle in, torque at the wheels out, coupled to their spin without a time lag.

CARLA's vehicles are PhysX's: an engine with inertia and viscous damping, a clutch that transmits torque in proportion
to its slip, a gearbox that opens the clutch while it changes. Differentials are open: all driven wheels get one torque.
"""

import math

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kernel, part
from linden.physics.state import Body, Spec

F64 = NDArray[np.float64]

RPM_PER_RADPS = 30.0 / math.pi
_UNDO_MARGIN = 0.95  # a change down is made only where the speed after it stays this far below that of changing up


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
    """Let the driver (manual, reverse: at once) or the automatic (in ``switch_time_s``, gear 0 meanwhile) choose."""
    if v.reverse != v.was_reverse:
        v.was_reverse = v.reverse
        v.target_gear = -1 if v.reverse else 1
        v.shift_left_s = 0.0
    elif v.manual_gear_shift:
        v.target_gear = max(-1, min(spec.gear_count, v.gear_command))
        v.shift_left_s = 0.0
    elif v.shift_left_s > 0.0:
        v.shift_left_s = max(0.0, v.shift_left_s - dt_s)
    elif spec.autobox and not v.reverse:
        chosen = _automatic_choice(v, spec)
        if chosen != v.target_gear:
            v.target_gear = chosen
            v.shift_left_s = spec.switch_time_s
    v.gear = 0 if v.shift_left_s > 1e-9 else v.target_gear


@part
def _automatic_choice(v: Body, spec: Spec) -> int:
    """Return the gear that the engine's speed asks for; never one that would at once be left again."""
    gear = v.target_gear
    if gear < 1:
        return 1
    use = v.engine_rpm / RPM_PER_RADPS / spec.engine_max_radps
    if gear < spec.gear_count and use > spec.gear_up[gear - 1]:
        return int(gear + 1)
    if gear > 1 and use < spec.gear_down[gear - 1]:
        after = use * spec.gear_ratio[gear - 2] / spec.gear_ratio[gear - 1]
        if after < _UNDO_MARGIN * spec.gear_up[gear - 2]:
            return int(gear - 1)
    return int(gear)


@part
def axle_drive(v: Body, spec: Spec, dt_s: float) -> tuple[float, float, float]:
    """Return total ratio, torque T0 at the clutch against standing wheels, and its drop per rad/s of gearbox speed.

    The engine, J dw/dt = T(w) - d w - K (w - ratio * wheel), is solved by backward Euler and put into the clutch's
    torque: K (w' - ratio * wheel) = T0 - drop * ratio * wheel. N·m and N·m·s/rad; both 0 with an open clutch.
    """
    ratio = total_ratio(v, spec)
    if ratio == 0.0:
        return 0.0, 0.0, 0.0
    inertia, engine_torque, damping = _engine_terms(v, spec)
    clutch = spec.clutch_nms
    own = inertia / dt_s + damping + clutch
    torque = clutch * (inertia / dt_s * (v.engine_rpm / RPM_PER_RADPS) + engine_torque) / own
    return ratio, torque, clutch * (1.0 - clutch / own)


@part
def total_ratio(v: Body, spec: Spec) -> float:
    """Return engine turns per wheel turn, negative in reverse (first gear's ratio: CARLA names no other), 0 neutral."""
    gear = v.gear
    if gear == 0:
        return 0.0
    if gear < 0:
        return float(-spec.gear_ratio[0])
    return float(spec.gear_ratio[gear - 1])


@part
def _engine_terms(v: Body, spec: Spec) -> tuple[float, float, float]:
    """Return inertia (kg·m²), torque of the throttle (N·m) and damping (N·m·s/rad), which blends by the throttle."""
    throttle = v.throttle if v.shift_left_s <= 1e-9 else 0.0  # the automatic lifts the foot while it changes
    radps = v.engine_rpm / RPM_PER_RADPS
    torque = 0.0
    if radps < spec.engine_max_radps:
        torque = throttle * on_curve(radps, spec.torque_radps, spec.torque_nm, spec.torque_points)
    closed = spec.damping_disengaged if v.gear == 0 else spec.damping_engaged
    return spec.engine_inertia_kgm2, torque, closed + (spec.damping_full_throttle - closed) * throttle


@part
def turn_engine(v: Body, spec: Spec, wheel_radps: float, dt_s: float) -> None:
    """Advance the engine's speed, the driven wheels turning at ``wheel_radps`` on average; held in 0..max_rpm."""
    inertia, torque, damping = _engine_terms(v, spec)
    ratio = total_ratio(v, spec)
    clutch = spec.clutch_nms if ratio != 0.0 else 0.0
    push = inertia / dt_s * (v.engine_rpm / RPM_PER_RADPS) + torque + clutch * ratio * wheel_radps
    radps = push / (inertia / dt_s + damping + clutch)
    radps = max(0.0, min(spec.engine_max_radps, radps))
    v.engine_rpm = radps * RPM_PER_RADPS if radps > 0.01 else 0.0
