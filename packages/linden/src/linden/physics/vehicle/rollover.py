"""Roll-over as CARLA notices it: four stages of roll that each brake the spin, then a flag once it has lain a while.

After ``ACarlaWheeledVehicle::ApplyRolloverBehavior`` of CARLA 0.9.16: stages at 130, 140, 150 and 160 degrees of roll,
each of which takes 35 % of the spin; 5 s after the last the failure state becomes Rollover; within 30 degrees of
upright all is forgotten. CARLA looks at positive roll alone, for its angles end at 180; here either side counts. A
vehicle that lies on its side has not rolled over, as there. CARLA sets no other failure state, nor does this server.
"""

import math

from linden.compiled import part
from linden.physics.state import Body

ROLLOVER = 1  # values.enums.VehicleFailureState.ROLLOVER; a plain number, for kernels take long to recognise an enum
FIRST_STAGE_DEG = 130.0
STAGE_DEG = 10.0
STAGES = 4
SPIN_KEPT = 1.0 - 0.35
FLAG_AFTER_S = 5.0
RECOVERED_DEG = 30.0


@part
def watch_rollover(v: Body, dt_s: float) -> None:
    """Look at the roll at the end of a frame; to be called for vehicles that tumble or have begun to."""
    roll_deg = abs(math.degrees(v.rotation[2]))
    if v.rollover_stage < STAGES and roll_deg > FIRST_STAGE_DEG + STAGE_DEG * v.rollover_stage:
        for axis in range(3):
            v.angular_velocity[axis] *= SPIN_KEPT
        v.rollover_stage += 1
        v.rollover_s = 0.0
    elif v.rollover_stage == STAGES:
        v.rollover_s += dt_s
        if v.rollover_s >= FLAG_AFTER_S - 1e-9:
            v.failure = ROLLOVER
    if v.rollover_stage > 0 and roll_deg < RECOVERED_DEG:
        v.rollover_stage, v.rollover_s, v.failure = 0, 0.0, 0
