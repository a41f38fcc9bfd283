"""Could one keep standing? The share of the ride above what standing volunteers answered without falling.

Krašna, Keller, Linder, Silvano, Xu, Thomson and Klug 2021, "Human Response to Longitudinal Perturbations of Standing
Passengers on Public Transport During Regular Operation", Frontiers in Bioengineering and Biotechnology 9:680883, put 24
healthy volunteers of 34 +- 9 years, who held on to nothing, through two brakings of a bus: "For the two braking pulses
(1.0 and 2.5 m/s2), only the lower magnitude pulse allowed balance recovery without compensatory stepping." Karekla and
Tyler 2018, Safety Science 105, 128-133, chose 1.0, 1.5 and 2.5 m/s² as low, medium and high of what London's bus
passengers live through, and found control of balance to fall with each.

So above 1.0 a passenger who holds on to nothing has to take a step, for which there has to be room; above 2.5 not
even a step is vouched for, and only a grip helps. How strong a grip has to be neither study tells: no share is claimed
for those who hold on. Old people fall sooner than these volunteers.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from basu.metrics.passengers.felt import Felt

STEP_MPS2, GRIP_MPS2 = 1.0, 2.5
MOVING_MPS = 0.1


class Balance(NamedTuple):
    """Times and shares count filtered horizontal acceleration at the passenger's place, in any direction."""

    moving_s: float  # the ride without its rests
    step_s: float  # above STEP_MPS2
    step_share: float  # of the moving time
    grip_s: float  # above GRIP_MPS2
    grip_share: float
    worst_mps2: float
    worst_t_s: float


def balance(felt: Felt) -> Balance:
    """Count the time in which a passenger who holds on to nothing has to step, and in which that is not enough."""
    size_mps2 = felt.horizontal_mps2()
    tick_s = float(felt.t_s[1] - felt.t_s[0])
    # a stop throws people when the vehicle stands already: what is felt at rest belongs to the ride
    moving_s = max(tick_s, float(np.count_nonzero(np.abs(felt.speed_mps) > MOVING_MPS)) * tick_s)
    step_s, grip_s = (float(np.count_nonzero(size_mps2 > limit)) * tick_s for limit in (STEP_MPS2, GRIP_MPS2))
    worst = int(np.argmax(size_mps2))
    return Balance(
        moving_s=moving_s,
        step_s=step_s,
        step_share=min(1.0, step_s / moving_s),
        grip_s=grip_s,
        grip_share=min(1.0, grip_s / moving_s),
        worst_mps2=float(size_mps2[worst]),
        worst_t_s=float(felt.t_s[worst]),
    )
