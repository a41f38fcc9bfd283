"""The comfort score: a ride as its standing passengers found it, 0 (bad) to 1 (good). No part of the driving score.

It is a convention of this project, made of figures that are each defined by a source; the weights are adjustable.
Harm goes before comfort: a ride falls into the first of these levels that holds, and no comfort lifts it out.

    0             the vehicle touched somebody or something
    0 .. 0.2      the ride did not arrive: 0.2 times the share of the route, times 0.6 for each near miss
    0.2 .. 0.4    near misses: 0.2 + 0.2 x 0.6 ** (n - 1)
    0.4 .. 0.6    breaches, which are rules broken, stops passed and phantom stops: 0.4 + 0.2 x 0.8 ** n
    0.6 .. 1      none of these: 0.6 + 0.4 times the weighted mean of the parts

The parts, each in 0 .. 1:

    balance       1 - share of the moving time in which one has to step / 0.1, at least 0; 0 once a step was not enough
    harsh_stops   0.7 for each harsh stop that had a cause, 0.4 for each that had none, multiplied
    vibration     1 where the total value is "not uncomfortable" (0.315 m/s²), 0 from "very uncomfortable" (1.25 m/s²)
    near_misses   0.6 for each party that was nearly hit, multiplied
    service       share of the stops that were served and, where the route has a timetable, on time; left out, and its
                  weight with it, where the route has no stops
    collisions    0 for any contact, else 1; it has no weight, because a contact alone decides

Below 0.6 the parts do not count, so the braking that avoids a harm never costs more than the harm itself.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.errors import UserError
from basu.settings.option import Settings

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from basu.metrics.passengers.balance import Balance
    from basu.metrics.passengers.service import Visit
    from basu.metrics.passengers.vibration import Vibration

STEP_SHARE = 0.1
CAUSED, PHANTOM, NEAR_MISS, BREACH = 0.7, 0.4, 0.6, 0.8
SMOOTH_MPS2, ROUGH_MPS2 = 0.315, 1.25
UNFINISHED_TOP, NEAR_MISS_TOP, BREACH_TOP = 0.2, 0.4, 0.6


class Harm(NamedTuple):
    """What goes before comfort."""

    contacts: int = 0
    completion: float = 1.0  # share of the route that was driven; 1 for a ride that arrived
    near_misses: int = 0
    rules_broken: int = 0  # red lights and stop signs run, speeding, driving beside the road
    stops_passed: int = 0  # service stops that were not served
    phantom_stops: int = 0  # harsh stops without a cause


@dataclass(frozen=True, slots=True, kw_only=True)
class ComfortWeights(Settings):
    """How much each part counts; they need not sum to 1, only their proportions matter."""

    balance: float = 0.3
    harsh_stops: float = 0.3  # with 0, phantom stops are no breach
    vibration: float = 0.1
    near_misses: float = 0.2
    service: float = 0.1  # with 0, stops that were passed are no breach

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
    balance: Balance, phantom: Sequence[bool], vibration: Vibration, harm: Harm, visits: Sequence[Visit]
) -> dict[str, float]:
    """Each part that can be measured; ``phantom`` says of each harsh stop whether it had no cause."""
    found = {
        "balance": 0.0 if balance.grip_s > 0.0 else max(0.0, 1.0 - balance.step_share / STEP_SHARE),
        "harsh_stops": math.prod(PHANTOM if nothing else CAUSED for nothing in phantom),
        "vibration": float(np.interp(vibration.total_mps2, [SMOOTH_MPS2, ROUGH_MPS2], [1.0, 0.0])),
        "near_misses": NEAR_MISS**harm.near_misses,
        "collisions": 0.0 if harm.contacts else 1.0,
    }
    if visits:
        good = sum(visit.served and visit.on_time is not False for visit in visits)
        found["service"] = good / len(visits)
    return found


def comfort_score(measured: Mapping[str, float], weights: ComfortWeights, harm: Harm) -> float | None:
    """The score; None for a ride without harm in which only parts without weight could be measured."""
    passed = harm.stops_passed if weights.service > 0.0 else 0
    breaches = harm.rules_broken + passed + (harm.phantom_stops if weights.harsh_stops > 0.0 else 0)
    if harm.contacts:
        return 0.0
    if harm.completion < 1.0:
        return UNFINISHED_TOP * harm.completion * NEAR_MISS**harm.near_misses
    if harm.near_misses:
        return UNFINISHED_TOP + (NEAR_MISS_TOP - UNFINISHED_TOP) * NEAR_MISS ** (harm.near_misses - 1)
    if breaches:
        return NEAR_MISS_TOP + (BREACH_TOP - NEAR_MISS_TOP) * BREACH**breaches
    named = {name: weight for name, weight in weights.named().items() if name in measured}
    total = sum(named.values())
    if total == 0.0:
        return None
    return BREACH_TOP + (1.0 - BREACH_TOP) * sum(named[name] * measured[name] for name in named) / total
