"""The manner of driving: comfortable changes of speed, speed against the limit, distances, gaps, patience.

The manoeuvre is the classic one of bounded jerk: acceleration falls at ``-jerk`` to a plateau, stays, and rises back to
zero exactly when the new speed is reached (Biagiotti and Melchiorri, Trajectory Planning for Automatic Machines and
Robots, 2008, section 3.4, "double S").

``BASIC`` is the basic agent's, with nothing of the behavioral ones. The other three are named as CARLA's BehaviorAgent
names its profiles. The profiles' figures (in km/h and metres of its own controller) are the model for their order, not
for their values.
"""

from __future__ import annotations

import math
from typing import NamedTuple


class ComfortLimits(NamedTuple):
    """What a change of speed may feel like."""

    accel_mps2: float
    jerk_mps3: float


def slowing_distance_m(speed_mps: float, accel_mps2: float, target_mps: float, limits: ComfortLimits) -> float:
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


def approach_accel_mps2(excess_mps: float, limits: ComfortLimits) -> float:
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


# Critical headways in s, Highway Capacity Manual, 6th ed., exhibit 20-11 (two-lane major street) and equation 22-21
# with its default parameters (single-lane roundabout)
LEFT_FROM_MAJOR_S, RIGHT_FROM_MINOR_S, THROUGH_FROM_MINOR_S, LEFT_FROM_MINOR_S = 4.1, 6.2, 6.5, 7.1
ROUNDABOUT_S = 4.98


class Following(NamedTuple):
    """Parameters of the intelligent driver model, Treiber, Hennecke and Helbing 2000, equations 2 and 3."""

    headway_s: float  # T
    standoff_m: float  # s0
    accel_mps2: float  # a
    brake_mps2: float  # b


class Gaps(NamedTuple):
    """Which gaps in the traffic of others are taken; never one shorter than the time that the crossing takes."""

    factor: float  # of the critical headway
    margin_s: float  # on top of the time that the crossing takes
    patience_s: float  # waited so long at the line, the time of the crossing alone will do


class Passing(NamedTuple):
    """How what stands in the lane is gone round."""

    patience_s: float  # it has to have stood for so long
    top_mps: float
    beside_m: float  # kept to its side
    margin_s: float  # between being back in the lane and the next one coming the other way


class Manner(NamedTuple):
    """One way to drive."""

    name: str
    comfort: ComfortLimits  # of changes of speed, where nothing demands more
    lateral_accel_mps2: float  # in bends …
    lateral_jerk_mps3: float  # … and on the way into them
    above_limit_mps: float  # kept to the posted limit; negative: below it
    following: Following | None = None  # None: keeps the distance in which comfort can stop
    gaps: Gaps | None = None  # None: the rules' own
    passing: Passing | None = None  # None: waits behind whatever stands there
    tailgated_s: float = 0.0  # an actor behind nearer than this is a tailgater; 0: never


# basic: below the passengers' 1.0 m/s² and 1.0 m/s³ by what tracking adds
BASIC = Manner("basic", ComfortLimits(0.85, 0.8), 0.9, 0.9, -0.25)
CAUTIOUS = Manner(
    "cautious",
    ComfortLimits(0.85, 0.8),
    0.9,
    0.9,
    -6.0 / 3.6,
    Following(2.2, 3.0, 0.85, 1.0),
    Gaps(1.2, 2.0, 90.0),
    Passing(8.0, 3.5, 1.0, 4.0),
    1.2,
)
NORMAL = Manner(
    "normal",
    ComfortLimits(1.1, 1.1),
    1.3,
    1.3,
    -0.25,
    Following(1.6, 2.0, 1.1, 1.67),
    Gaps(1.0, 1.0, 60.0),
    Passing(5.0, 4.5, 0.8, 3.0),
    0.9,
)
AGGRESSIVE = Manner(
    "aggressive",
    ComfortLimits(1.8, 2.0),
    2.0,
    2.0,
    0.6,
    Following(1.0, 2.0, 1.8, 2.0),
    Gaps(0.8, 0.5, 30.0),
    Passing(3.0, 5.5, 0.6, 2.0),
)
