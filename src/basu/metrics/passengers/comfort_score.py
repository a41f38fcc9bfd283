"""The comfort score: five parts in 0 (bad) .. 1 (good) and their weighted mean. It is no part of the driving score.

It is a convention of this project, made of figures that are each defined by a source; the weights are adjustable.

    balance       1 - share of the moving time in which one has to step / 0.1, at least 0; 0 once a step was not enough
    harsh_stops   0.7 for each harsh stop that had a cause, 0.4 for each that had none, multiplied
    vibration     1 where the total value is "not uncomfortable" (0.315 m/s²), 0 from "very uncomfortable" (1.25 m/s²)
    near_misses   0.6 for each party that was nearly hit, multiplied
    service       share of the stops that were served and, where the route has a timetable, on time; left out, and its
                  weight with it, where the route has no stops
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

from basu.errors import UserError
from basu.settings.option import Settings

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from basu.metrics.passengers.balance import Balance
    from basu.metrics.passengers.near_misses import Party
    from basu.metrics.passengers.service import Visit
    from basu.metrics.passengers.vibration import Vibration

STEP_SHARE = 0.1
CAUSED, PHANTOM, NEAR_MISS = 0.7, 0.4, 0.6
SMOOTH_MPS2, ROUGH_MPS2 = 0.315, 1.25


@dataclass(frozen=True, slots=True, kw_only=True)
class ComfortWeights(Settings):
    """How much each part counts; they need not sum to 1, only their proportions matter."""

    balance: float = 0.3
    harsh_stops: float = 0.3
    vibration: float = 0.1
    near_misses: float = 0.2
    service: float = 0.1

    def check(self) -> None:
        """Check that something counts.

        Raises:
            UserError: a weight is negative, or all are 0.
        """
        for name, weight in self.named().items():
            if not (math.isfinite(weight) and weight >= 0.0):
                raise UserError(f"the comfort weight of {name} is {weight}; it must be 0 or more")
        if sum(self.named().values()) == 0.0:
            raise UserError("all comfort weights are 0; at least one must be positive")

    def named(self) -> dict[str, float]:
        """The weights by name."""
        return {field.name: float(getattr(self, field.name)) for field in fields(self)}


def parts(
    balance: Balance,
    phantom: Sequence[bool],
    vibration: Vibration,
    parties: Sequence[Party],
    visits: Sequence[Visit],
) -> dict[str, float]:
    """Each part that can be measured; ``phantom`` says of each harsh stop whether it had no cause."""
    found = {
        "balance": 0.0 if balance.grip_s > 0.0 else max(0.0, 1.0 - balance.step_share / STEP_SHARE),
        "harsh_stops": math.prod(PHANTOM if nothing else CAUSED for nothing in phantom),
        "vibration": float(np.interp(vibration.total_mps2, [SMOOTH_MPS2, ROUGH_MPS2], [1.0, 0.0])),
        "near_misses": NEAR_MISS ** sum(party.is_near_miss for party in parties),
    }
    if visits:
        good = sum(visit.served and visit.on_time is not False for visit in visits)
        found["service"] = good / len(visits)
    return found


def comfort_score(measured: Mapping[str, float], weights: ComfortWeights) -> float | None:
    """The weighted mean of what could be measured; None where only unweighted parts could be."""
    named = weights.named()
    total = sum(named[name] for name in measured)
    return sum(named[name] * value for name, value in measured.items()) / total if total > 0.0 else None
