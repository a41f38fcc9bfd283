"""The comfort score, 0 (bad) to 1 (good), and the vibration of ISO 2631-1:1997 in it. No part of the driving score.

Equations by the standard's numbers: r.m.s. (1), running r.m.s. and its maximum MTVV (2, 4), fourth-power dose VDV (5),
vibration total value (10) with all k = 1 for the comfort of standing persons (clause 8.2); comfort reactions from annex
C.2.3; motion sickness dose from annex D.

It is a convention of this project, made of figures that are each defined by a source; the weights are adjustable.
Harm goes before comfort: a ride falls into the first of these levels that holds, and no comfort lifts it out.

    0             the vehicle touched an actor or a thing
    0 .. 0.2      the ride did not arrive: 0.2 times the share of the route, times 0.6 for each near miss
    0.2 .. 0.4    near misses: 0.2 + 0.2 x 0.6 ** (n - 1)
    0.4 .. 0.6    breaches, which are rules broken, stops passed and phantom stops: 0.4 + 0.2 x 0.8 ** n
    0.6 .. 1      none of these: 0.6 + 0.4 times the weighted mean of the parts

The parts, each in 0 .. 1:

    balance       1 - share of the moving time with balancing steps / 0.1, at least 0; 0 once a step was not enough
    harsh_stops   0.7 for each harsh stop that had a cause, 0.4 for each that had none, multiplied
    vibration     1 where the total value on the move is "not uncomfortable" (0.315 m/s²), 0 from "very uncomfortable"
                  (1.25 m/s²)
    near_misses   0.6 for each party that was nearly hit, multiplied
    service       share of the stops that were served, for long enough to board, without a person left behind, and
                  neither late nor left early by the timetable; left out, and its weight with it, without stops
    collisions    0 for any contact, else 1; it has no weight, because a contact alone decides

Below 0.6 the parts do not count, so the braking that avoids a harm never costs more than the harm itself.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.errors import UserError
from basu.metrics.passengers.filters import WD, WF, WK, weigh
from basu.metrics.passengers.service import fault_of
from basu.settings.option import Settings

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from basu.metrics.passengers.felt import Balance, Felt
    from basu.metrics.passengers.service import Visit


RUNNING_S = 1.0  # integration time of the running r.m.s., 6.3.1
# Annex C.2.3, likely reactions in public transport; the bands overlap, and a value in two of them is called both.
REACTIONS: tuple[tuple[str, float, float], ...] = (
    ("not uncomfortable", 0.0, 0.315),
    ("a little uncomfortable", 0.315, 0.63),
    ("fairly uncomfortable", 0.5, 1.0),
    ("uncomfortable", 0.8, 1.6),
    ("very uncomfortable", 1.25, 2.5),
    ("extremely uncomfortable", 2.0, math.inf),
)


class Vibration(NamedTuple):
    """Over the whole ride; accelerations in m/s²."""

    along_mps2: float  # weighted r.m.s., Wd
    across_mps2: float  # Wd
    up_mps2: float  # Wk
    total_mps2: float  # vibration total value a_v
    transient_mps2: float  # MTVV: the worst second, of all axes together
    dose_mps175: float  # VDV, m/s^1.75, of the worst axis
    crest_factor: float  # the largest of the axes; above 9 the r.m.s. alone may understate (6.2.1)
    sickness_dose_mps15: float  # MSDVz, m/s^1.5
    reactions: tuple[str, ...]  # to the total value


def vibration(felt: Felt) -> Vibration:
    """Weigh what is felt."""
    step_s = float(felt.t_s[1] - felt.t_s[0])
    weighted = np.stack(
        [
            weigh(WD, felt.along_mps2, step_s),
            weigh(WD, felt.across_mps2, step_s),
            weigh(WK, felt.up_mps2, step_s),
        ]
    )
    rms = np.sqrt(np.mean(weighted**2, axis=1))
    total = float(np.sqrt(np.sum(rms**2)))
    doses = (np.sum(weighted**4, axis=1) * step_s) ** 0.25
    crests = np.abs(weighted).max(axis=1) / np.where(rms > 0.0, rms, np.inf)
    return Vibration(
        along_mps2=float(rms[0]),
        across_mps2=float(rms[1]),
        up_mps2=float(rms[2]),
        total_mps2=total,
        transient_mps2=float(np.sqrt(_running_mean(np.sum(weighted**2, axis=0), step_s).max())),
        dose_mps175=float(doses.max()),
        crest_factor=float(crests.max()),
        sickness_dose_mps15=float(math.sqrt(np.sum(weigh(WF, felt.up_mps2, step_s) ** 2) * step_s)),
        reactions=reactions(total),
    )


def on_the_move_mps2(vibration: Vibration, felt: Felt, balance: Balance) -> float:
    """Return the total value over the time on the move alone: rests and creeping dilute no shaking."""
    whole_s = len(felt.t_s) * float(felt.t_s[1] - felt.t_s[0])
    return vibration.total_mps2 * math.sqrt(max(1.0, whole_s / balance.moving_s))


def reactions(total_mps2: float) -> tuple[str, ...]:
    """What passengers call a total value: one reaction, or two where the bands overlap."""
    return tuple(name for name, low, high in REACTIONS if low <= total_mps2 < high)


def _running_mean(values: NDArray[np.float64], step_s: float) -> NDArray[np.float64]:
    """Means over each full second; over the whole where it is shorter."""
    width = min(len(values), max(1, round(RUNNING_S / step_s)))
    total = np.concatenate([[0.0], np.cumsum(values)])
    mean: NDArray[np.float64] = (total[width:] - total[:-width]) / width
    return np.maximum(mean, 0.0)


STEP_SHARE = 0.1
CAUSED, PHANTOM, NEAR_MISS, BREACH = 0.7, 0.4, 0.6, 0.8
SMOOTH_MPS2, ROUGH_MPS2 = 0.315, 1.25
UNFINISHED_TOP, NEAR_MISS_TOP, BREACH_TOP = 0.2, 0.4, 0.6


class Harm(NamedTuple):
    """What goes before comfort."""

    contacts: int = 0
    completion: float = 1.0  # share of the route that was driven; 1 for a ride that arrived
    near_misses: int = 0
    rules_broken: int = 0  # red lights and stop signs run, speeding, driving beside the road or in the wrong lane
    stops_passed: int = 0  # service stops that were not served, or not for long enough to board
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
    balance: Balance, phantom: Sequence[bool], shaken_mps2: float, harm: Harm, visits: Sequence[Visit]
) -> dict[str, float]:
    """Each part that can be measured.

    ``phantom`` says of each harsh stop whether it had no cause, ``shaken_mps2`` is the total value on the move.
    """
    found = {
        "balance": 0.0 if balance.grip_s > 0.0 else max(0.0, 1.0 - balance.step_share / STEP_SHARE),
        "harsh_stops": math.prod(PHANTOM if nothing else CAUSED for nothing in phantom),
        "vibration": float(np.interp(shaken_mps2, [SMOOTH_MPS2, ROUGH_MPS2], [1.0, 0.0])),
        "near_misses": NEAR_MISS**harm.near_misses,
        "collisions": 0.0 if harm.contacts else 1.0,
    }
    if visits:
        found["service"] = sum(fault_of(visit) is None for visit in visits) / len(visits)
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
