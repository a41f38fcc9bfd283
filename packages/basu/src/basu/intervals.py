"""Intervals of rates, weighted rates and means, and exact tests of pairs (McNemar, sign test).

The binomial distribution and the quantiles of the beta and gamma distributions are scipy's. It is imported by the
first call that needs it: the import takes 0.5 s of processor time, which most commands do without.
"""

from __future__ import annotations

import math
from statistics import NormalDist
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

RESAMPLES = 2_000  # of a bootstrap: Efron and Tibshirani 1993, section 13.3, name 1,000 for percentiles
CHUNK = 4_000_000  # numbers drawn at once by a bootstrap, for the memory
FEW = 20  # trials below which an interval is shown with a caution; from one trial none is shown


class Interval(NamedTuple):
    """An estimate with its interval."""

    value: float
    low: float
    high: float
    trials: float = math.inf  # from which it comes

    @property
    def caution(self) -> str:
        """What a reader must know beside the interval: "" from ``FEW`` trials on."""
        if self.trials >= FEW or self.trials == 0:
            return ""
        return "one drive: no interval" if self.trials <= 1 else f"only {self.trials:g} drives"

    @property
    def is_shown(self) -> bool:
        """Whether there is an interval to show: from two trials on."""
        return self.trials > 1

    @property
    def width(self) -> float:
        """From the low end to the high end."""
        return self.high - self.low


def wilson(successes: int, trials: int, confidence: float = 0.95) -> Interval:
    """The rate of successes with its score interval: Wilson 1927; Brown, Cai, DasGupta 2001, equation 4.

    Without trials the interval is all of [0, 1] and the value NaN.
    """
    if trials == 0:
        return Interval(math.nan, 0.0, 1.0, 0)
    z = NormalDist().inv_cdf(0.5 + confidence / 2.0)
    share, squared = successes / trials, z * z
    centre = (share + squared / (2.0 * trials)) / (1.0 + squared / trials)
    half = z / (1.0 + squared / trials) * math.sqrt(share * (1.0 - share) / trials + squared / (4.0 * trials**2))
    low = 0.0 if successes == 0 else max(0.0, centre - half)
    return Interval(share, low, 1.0 if successes == trials else min(1.0, centre + half), trials)


def clopper_pearson(successes: float, trials: float, confidence: float = 0.95) -> Interval:
    """Return the rate of successes with its exact interval, which is never too narrow: Clopper and Pearson 1934.

    Each end is the rate at which a result as extreme has the probability ``(1 - confidence) / 2``: a quantile of the
    beta distribution. Effective numbers (see ``weighted``) need not be whole.
    """
    if trials == 0:
        return Interval(math.nan, 0.0, 1.0, 0)
    from scipy.special import betaincinv  # noqa: PLC0415 - see the module

    tail = (1.0 - confidence) / 2.0
    low = float(betaincinv(successes, trials - successes + 1.0, tail)) if successes > 0 else 0.0
    high = float(betaincinv(successes + 1.0, trials - successes, 1.0 - tail)) if successes < trials else 1.0
    return Interval(successes / trials, low, high, trials)


def poisson(events: int, exposure: float, confidence: float = 0.95) -> Interval:
    """Return the events for each unit of ``exposure`` with their exact interval: Garwood 1936.

    Each end is a rate at which so many events have the probability ``(1 - confidence) / 2``: a quantile of the gamma
    distribution. It holds for events that are independent of each other. Without exposure the value is NaN.
    """
    if not exposure > 0.0:
        return Interval(math.nan, 0.0, math.inf, 0)
    from scipy.special import gammaincinv  # noqa: PLC0415 - see the module

    tail = (1.0 - confidence) / 2.0
    low = float(gammaincinv(events, tail)) / exposure if events > 0 else 0.0
    return Interval(events / exposure, low, float(gammaincinv(events + 1.0, 1.0 - tail)) / exposure)


class Stratum(NamedTuple):
    """Trials of one kind, with the weight of their rate in a sum."""

    weight: float
    successes: int
    trials: int  # 1 or more


def weighted(strata: Iterable[Stratum], confidence: float = 0.95) -> Interval:
    """Return the weighted sum of the strata's rates with its interval; weights sum to 1 at most.

    The interval is that of Clopper and Pearson at the effective number of trials (Kish 1965, section 11.7; Korn and
    Graubard 1998, "Confidence intervals for proportions with small expected number of positive counts"). A stratum
    without a failure widens it as well, because failures elsewhere say how uncertain a stratum of so few trials is.
    What is missing from a sum of 1 counts as failed for certain.
    """
    known = [each for each in strata if each.weight > 0.0]
    whole = sum(each.weight for each in known)
    if not known:
        return Interval(0.0, 0.0, 0.0, 0)
    effective = whole**2 / sum(each.weight**2 / each.trials for each in known)
    rate = sum(each.weight * (each.successes / each.trials) for each in known) / whole
    failures = sum(each.trials - each.successes for each in known)
    successes = effective * rate if failures else effective  # all of them, whatever the rounding
    found = clopper_pearson(min(successes, effective), effective, confidence)
    part = min(1.0, whole)  # 1 but for rounding
    return Interval(part * found.value, part * found.low, part * found.high, sum(each.trials for each in known))


def binomial_tail(least: int, trials: int, rate: float) -> float:
    """Return the probability of at least so many successes in independent trials, each with ``rate``."""
    if least <= 0:
        return 1.0
    from scipy.special import bdtrc  # noqa: PLC0415 - see the module

    return float(bdtrc(least - 1, trials, rate)) if least <= trials else 0.0


def bootstrap(values: NDArray[np.float64], confidence: float = 0.95, seed: int = 0) -> Interval:
    """The mean with its percentile interval: Efron and Tibshirani 1993, "An Introduction to the Bootstrap", chapter 13.

    ``values`` is (N,); NaN in it is left out. All chance comes from ``seed``.
    """
    known = values[np.isfinite(values)]
    if len(known) == 0:
        return Interval(math.nan, math.nan, math.nan, 0)
    rng, means = np.random.default_rng(seed), np.empty(RESAMPLES)
    step = max(1, CHUNK // len(known))
    for begin in range(0, RESAMPLES, step):
        count = min(step, RESAMPLES - begin)
        means[begin : begin + count] = known[rng.integers(0, len(known), (count, len(known)))].mean(axis=1)
    tail = (1.0 - confidence) / 2.0
    low, high = np.quantile(means, [tail, 1.0 - tail])
    return Interval(float(known.mean()), float(low), float(high), len(known))


class Paired(NamedTuple):
    """Two agents on the same conditions."""

    pairs: int
    first_only: int  # pairs in which only the first succeeded
    second_only: int
    p_value: float  # exact McNemar test, two-sided


def mcnemar(first: NDArray[np.bool_], second: NDArray[np.bool_]) -> Paired:
    """The exact McNemar test: under equal rates each discordant pair is a fair coin.

    McNemar 1947; the exact form: Agresti 2002, "Categorical Data Analysis", section 10.1.4.
    Both are (N,), a row for each condition.
    """
    first_only, second_only = int((first & ~second).sum()), int((second & ~first).sum())
    return Paired(len(first), first_only, second_only, fair_coin(first_only, second_only))


def sign_test(first: NDArray[np.float64], second: NDArray[np.float64]) -> Paired:
    """The sign test on scores: how often either is higher. Ties are left out: Conover 1999, section 3.4.

    Both are (N,), a row for each condition; pairs with NaN are left out.
    """
    known = np.isfinite(first) & np.isfinite(second)
    more, less = int((first > second)[known].sum()), int((first < second)[known].sum())
    return Paired(int(known.sum()), more, less, fair_coin(more, less))


def fair_coin(heads: int, tails: int) -> float:
    """The two-sided probability of a split as uneven as this, or more so, by a fair coin; 1 without a throw."""
    throws = heads + tails
    if throws == 0:
        return 1.0
    return min(1.0, 2.0 * binomial_tail(max(heads, tails), throws, 0.5))
