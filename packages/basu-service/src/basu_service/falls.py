"""A model of standing passengers that lose their balance, from the accelerations that a drive's record holds.

A passenger loses balance when the filtered horizontal acceleration at the place of standing
(`basu.metrics.passengers.felt`) exceeds a value of its own. The values of persons are log-normal. Their median and
spread are uncertain, so each figure comes with an interval: 95 % of draws of both, with the persons' own chance.

Brackets of the median, m/s²:

- Free standing: from 1.62 to 2.5. Hirshfeld 1932 ("Disturbing effects of horizontal acceleration", Electric Railway
  Presidents' Conference Committee, Bulletin 3) found a mean of 0.165 g at which unsupported standing persons lost
  balance. 24 volunteers of Krašna et al. 2021 (Frontiers in Bioengineering and Biotechnology 9:680883) were put through
  a braking of 2.5, which none of them bore without a step. No study was found that vouches for a step above that.
- Holding on: from 2.26 to 2.65, Hirshfeld's 0.23 g at an overhead strap and 0.27 g at a vertical pole.

Hirshfeld's figures are quoted from memory of J. L. Hoberock's survey (1976); neither work was accessible. The table
of Regulation (EU) 2022/1426 for standing passengers fits a braking of 2.4, which is of the same size. The spread
between persons, 0.15 to 0.35 of the logarithm, is an assumption of this project. Losing balance is not yet an injury,
and some that lose it are caught: the figures are an upper bound of falls. The model leaves out warnings, age and the
jerk beyond the filter.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.passengers.balance import FREE_MPS2, HOLDING_MPS2, SPREAD, STANDARD, share_that_falls

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

DRAWS, SEED = 2000, 20_200_220


class Stander(NamedTuple):
    """A standing passenger while it stands."""

    holds_on: bool
    steadiness: float  # quantile in (0, 1) among persons
    strongest_mps2: float  # felt while standing


class Falls(NamedTuple):
    """How many standing passengers lose their balance."""

    standing: int
    value: float  # with the middle of the brackets
    low: float  # 2.5 % of the draws have fewer
    high: float


def threshold_mps2(holds_on: bool, steadiness: float) -> float:  # noqa: FBT001 - as the record has it
    """Return the acceleration at which a person loses balance, by the middle of the brackets."""
    low, high = HOLDING_MPS2 if holds_on else FREE_MPS2
    spread = 0.5 * (SPREAD[0] + SPREAD[1])
    return float(np.sqrt(low * high) * np.exp(spread * STANDARD.inv_cdf(steadiness)))


def falls(standers: Sequence[Stander]) -> Falls:
    """Count the passengers that lose balance, with the interval of the model's parameters."""
    if not standers:
        return Falls(0, 0.0, 0.0, 0.0)
    felt = np.array([each.strongest_mps2 for each in standers])
    holds = np.array([each.holds_on for each in standers])
    scores = np.array([STANDARD.inv_cdf(each.steadiness) for each in standers])
    value = sum(each.strongest_mps2 > threshold_mps2(each.holds_on, each.steadiness) for each in standers)
    medians, spreads = _draws()
    limit = medians[:, holds.astype(int)] * np.exp(spreads[:, None] * scores)
    low, high = np.quantile((felt > limit).sum(axis=1), [0.025, 0.975])
    return Falls(len(standers), float(value), float(low), float(high))


def of_hundred(strongest_mps2: float, *, holds_on: bool) -> Falls:
    """Return how many of 100 standing passengers lose balance at one push, persons drawn anew in each draw."""
    medians, spreads = _draws()
    low, high = HOLDING_MPS2 if holds_on else FREE_MPS2
    middle = share_that_falls(
        strongest_mps2, np.array([np.sqrt(low * high)]), np.array([0.5 * (SPREAD[0] + SPREAD[1])])
    )[0]
    shares = share_that_falls(strongest_mps2, medians[:, int(holds_on)], spreads)
    counts = np.random.default_rng(SEED + 1).binomial(100, shares)
    ends = np.quantile(counts, [0.025, 0.975])
    return Falls(100, 100.0 * float(middle), float(ends[0]), float(ends[1]))


def _draws() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return draws of the medians, (DRAWS, 2) free standing and holding on, and of the spread, (DRAWS,)."""
    rng = np.random.default_rng(SEED)
    free, holding = (rng.uniform(*bracket, DRAWS) for bracket in (FREE_MPS2, HOLDING_MPS2))
    return np.column_stack([free, holding]), rng.uniform(*SPREAD, DRAWS)
