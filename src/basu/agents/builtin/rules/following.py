"""Keeps the distance to a moving leader: the intelligent driver model for comfort, a hard floor under it for safety.

The model is Treiber, Hennecke and Helbing 2000, "Congested traffic states in empirical observations and microscopic
simulations", equations 2 and 3, without its term for the free road, which is the planner's own affair; so a leader is
followed at exactly ``standoff + headway * speed``. The model does not promise to avoid collisions where a leader brakes
harder than anybody expects; the floor does (Gipps 1981; "responsibility-sensitive safety", Shalev-Shwartz et al. 2017,
definition 1): the leader may at any moment brake as hard as tyres allow, and there is still room to stop behind it.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from basu.agents.builtin.scene import Restriction, Urgency

if TYPE_CHECKING:
    from basu.agents.builtin.driving.manner import Following

MOVING_MPS = 0.5  # slower than this a body is stopped for, not followed
LEADER_LIMIT_MPS2 = 8.0  # the most that a leader brakes: a car on dry asphalt, 0.8 g
CLOSEST_M = 1.0  # what is left between the bumpers when it does
LEAST_GAP_M = 0.1  # nearer than this the model's quotient means nothing any more


def follow_mps2(gap_m: float, speed_mps: float, leader_mps: float, following: Following) -> float:
    """The most acceleration behind a leader; ``gap_m`` is from bumper to bumper."""
    closing_mps = speed_mps - leader_mps
    root = 2.0 * math.sqrt(following.accel_mps2 * following.brake_mps2)
    wanted_m = following.standoff_m + max(0.0, following.headway_s * speed_mps + speed_mps * closing_mps / root)
    return following.accel_mps2 * (1.0 - (wanted_m / max(gap_m, LEAST_GAP_M)) ** 2)


def floor(gap_m: float, leader_mps: float) -> Restriction:
    """Stop behind where the leader would come to rest if it braked from now on as hard as it can."""
    rests_m = leader_mps * leader_mps / (2.0 * LEADER_LIMIT_MPS2)
    return Restriction(gap_m - CLOSEST_M + rests_m, 0.0, Urgency.RESERVE, "leader braking hard", CLOSEST_M / 2)
