"""Ackermann control: a target of steering angle and speed becomes pedals, by the two PID controllers of CARLA.

After CARLA 0.9.16's AckermannController: from speed error to wanted acceleration, from acceleration error to pedal,
both accumulating; its limits, its full stop below 0.1 m/s and its filter of the measured acceleration are kept.
"""

import math

import numpy as np
from numpy.typing import NDArray

from linden.compiled import part
from linden.physics.state import Body, Spec

F64 = NDArray[np.float64]

_STEER, _STEER_SPEED, _SPEED, _ACCELERATION = range(4)  # of the target; its jerk is stored and unused, as in CARLA
_LAST_SPEED, _MEASURED, _SPEED_SUM, _SPEED_INPUT, _ACCEL_SUM, _ACCEL_INPUT, _WANTED, _PEDAL = range(8)
_MOST_ACCEL_MPS2 = 3.0
_MOST_DECEL_MPS2 = 8.0
_STANDING_MPS = 0.1


@part
def drive_to_target(v: Body, spec: Spec, dt_s: float) -> None:
    """Set throttle, brake, steer and reverse once a frame."""
    memory, target = v.ackermann_memory, v.ackermann
    cosine, sine = math.cos(v.rotation[1]), math.sin(v.rotation[1])
    speed = v.velocity[0] * cosine + v.velocity[1] * sine
    memory[_MEASURED] = (4.0 * memory[_MEASURED] + (speed - memory[_LAST_SPEED]) / dt_s) / 5.0
    memory[_LAST_SPEED] = speed
    _steer(v, spec, dt_s)
    if abs(speed) < _STANDING_MPS and abs(target[_SPEED]) < _STANDING_MPS:
        v.throttle, v.brake = 0.0, 1.0
        return
    wanted_mps = target[_SPEED]
    if abs(speed) < _STANDING_MPS:
        v.reverse = wanted_mps < 0.0
    elif speed * wanted_mps < 0.0:
        wanted_mps = 0.0
    low, high = -abs(target[_ACCELERATION]), abs(target[_ACCELERATION])
    if high < 1e-4:
        low, high = -_MOST_DECEL_MPS2, _MOST_ACCEL_MPS2
    gain = _pid(v.ackermann_gains[0:3], memory[_SPEED_SUM : _SPEED_INPUT + 1], wanted_mps, speed, dt_s)
    memory[_WANTED] = max(low, min(high, memory[_WANTED] + gain))
    gains, sums = v.ackermann_gains[3:6], memory[_ACCEL_SUM : _ACCEL_INPUT + 1]
    gain = _pid(gains, sums, memory[_WANTED], memory[_MEASURED], dt_s)
    memory[_PEDAL] = max(-1.0, min(1.0, memory[_PEDAL] + gain))
    ahead = -memory[_PEDAL] if v.reverse else memory[_PEDAL]
    v.throttle, v.brake = max(0.0, ahead), max(0.0, -ahead)


@part
def _pid(gains: F64, memory: F64, target: float, measured: float, dt_s: float) -> float:
    """Return the controller's output in [-1, 1]; ``memory``: integral, last input (the derivative is of the input)."""
    error = target - measured
    memory[0] = max(-1.0, min(1.0, memory[0] + gains[1] * error * dt_s))
    slope = (measured - memory[1]) / dt_s
    memory[1] = measured
    return float(max(-1.0, min(1.0, gains[0] * error + memory[0] - gains[2] * slope)))


@part
def _steer(v: Body, spec: Spec, dt_s: float) -> None:
    """Move the steering towards the target angle, at the target's speed where it names one."""
    most = 0.0
    for k in range(spec.wheel_count):
        most = max(most, abs(spec.steer_max_rad[k]))
    if most == 0.0:
        return
    wanted = max(-most, min(most, v.ackermann[_STEER]))
    step = abs(v.ackermann[_STEER_SPEED]) * dt_s
    now = v.steer * most
    if abs(v.ackermann[_STEER_SPEED]) >= 1e-3 and abs(wanted - now) > step:
        wanted = now + math.copysign(step, wanted - now)
    v.steer = wanted / most
