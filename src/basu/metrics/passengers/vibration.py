"""How much a ride shakes: the weighted r.m.s. of ISO 2631-1:1997 for standing persons, and what people call it.

Equations by the standard's numbers: r.m.s. (1), running r.m.s. and its maximum MTVV (2, 4), fourth-power dose VDV (5),
vibration total value (10) with all k = 1 for the comfort of standing persons (clause 8.2); comfort reactions from annex
C.2.3; motion sickness dose from annex D.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.passengers.filters import WD, WF, WK, weigh

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.metrics.passengers.felt import Felt

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


def reactions(total_mps2: float) -> tuple[str, ...]:
    """What passengers call a total value: one reaction, or two where the bands overlap."""
    return tuple(name for name, low, high in REACTIONS if low <= total_mps2 < high)


def _running_mean(values: NDArray[np.float64], step_s: float) -> NDArray[np.float64]:
    """Means over each full second; over the whole where it is shorter."""
    width = min(len(values), max(1, round(RUNNING_S / step_s)))
    total = np.concatenate([[0.0], np.cumsum(values)])
    mean: NDArray[np.float64] = (total[width:] - total[:-width]) / width
    return np.maximum(mean, 0.0)
