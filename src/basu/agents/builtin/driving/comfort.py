"""Changes of speed that passengers hardly feel: how far one takes, and the most acceleration that keeps all promises.

The manoeuvre is the classic one of bounded jerk: acceleration falls at ``-jerk`` to a plateau, stays, and rises back to
zero exactly when the new speed is reached (Biagiotti and Melchiorri, Trajectory Planning for Automatic Machines and
Robots, 2008, section 3.4, "double S").
"""

from __future__ import annotations

import math
from typing import NamedTuple


class Limits(NamedTuple):
    """What a change of speed may feel like."""

    accel_mps2: float
    jerk_mps3: float


def slowing_distance_m(speed_mps: float, accel_mps2: float, target_mps: float, limits: Limits) -> float:
    """Metres from here until the speed is ``target_mps``, braking as late and as hard as ``limits`` allow.

    ``accel_mps2`` is that of now; where it already lies below what the limits allow, it is held rather than deepened.
    """
    jerk = limits.jerk_mps3
    excess_mps = speed_mps - target_mps
    peak_squared = jerk * excess_mps + 0.5 * accel_mps2 * accel_mps2
    if excess_mps <= 0.0 and accel_mps2 <= 0.0:
        return 0.0
    if peak_squared <= 0.0:
        return 0.0
    if accel_mps2 < 0.0 and jerk * excess_mps < 0.5 * accel_mps2 * accel_mps2:
        # even letting go of the brake at once undershoots: the target is met on the way
        time_s = (-accel_mps2 - math.sqrt(accel_mps2 * accel_mps2 - 2.0 * jerk * excess_mps)) / jerk
        return time_s * (speed_mps + time_s * (0.5 * accel_mps2 + time_s * jerk / 6.0))
    plateau = min(math.sqrt(peak_squared), max(limits.accel_mps2, -accel_mps2))
    onset_s = (accel_mps2 + plateau) / jerk
    release_s = plateau / jerk
    onset_end_mps = speed_mps + onset_s * (accel_mps2 - 0.5 * jerk * onset_s)
    hold_end_mps = target_mps + 0.5 * plateau * release_s
    hold_s = max(0.0, (onset_end_mps - hold_end_mps) / plateau) if plateau > 0.0 else 0.0
    onset_m = onset_s * (speed_mps + onset_s * (0.5 * accel_mps2 - onset_s * jerk / 6.0))
    hold_m = hold_s * 0.5 * (onset_end_mps + hold_end_mps)
    release_m = release_s * (hold_end_mps - 0.5 * plateau * release_s) + plateau * release_s * release_s / 6.0
    return onset_m + hold_m + release_m


def approach_accel_mps2(excess_mps: float, limits: Limits) -> float:
    """The acceleration with which to near a speed that is ``excess_mps`` away, so that it ends with bounded jerk.

    Linear close by and along the square root farther off, joined smoothly; negative where one is too fast.
    """
    gain_1ps = 2.0  # of the linear part: a difference of speed dies out within a second or so
    join_mps = limits.jerk_mps3 / gain_1ps**2
    size_mps = abs(excess_mps)
    if size_mps <= join_mps:
        return gain_1ps * excess_mps
    wanted = math.sqrt(2.0 * limits.jerk_mps3 * (size_mps - 0.5 * join_mps))
    return math.copysign(min(wanted, limits.accel_mps2), excess_mps)
