"""How a driver drives: comfort, speed against the limit, distance, gaps, patience. `docs/agents.md` tables the sources.

``BASIC`` is the basic agent's, with nothing of the behavioral ones. The other three are named as CARLA's BehaviorAgent
names its profiles, whose figures (in km/h and metres of its own controller) are the model for their order, not for
their values.
"""

from __future__ import annotations

from typing import NamedTuple

from basu.agents.builtin.driving.comfort import Limits

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
    comfort: Limits  # of changes of speed, where nothing demands more
    lateral_accel_mps2: float  # in bends …
    lateral_jerk_mps3: float  # … and on the way into them
    above_limit_mps: float  # kept to the posted limit; negative: below it
    following: Following | None = None  # None: keeps the distance in which comfort can stop
    gaps: Gaps | None = None  # None: the rules' own
    passing: Passing | None = None  # None: waits behind whatever stands there
    tailgated_s: float = 0.0  # somebody behind nearer than this is a tailgater; 0: never


# basic: below the passengers' 1.0 m/s² and 1.0 m/s³ by what tracking adds
BASIC = Manner("basic", Limits(0.85, 0.8), 0.9, 0.9, -0.25)
CAUTIOUS = Manner(
    "cautious",
    Limits(0.85, 0.8),
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
    Limits(1.1, 1.1),
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
    Limits(1.8, 2.0),
    2.0,
    2.0,
    0.6,
    Following(1.0, 2.0, 1.8, 2.0),
    Gaps(0.8, 0.5, 30.0),
    Passing(3.0, 5.5, 0.6, 2.0),
)
