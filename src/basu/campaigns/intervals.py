"""Intervals and tests: rates (Wilson, Clopper and Pearson), means (bootstrap), pairs (McNemar and sign test, exact).

All are small closed forms or sums of binomial terms, so that a report needs no further library.
"""

from __future__ import annotations

import math
from statistics import NormalDist
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

RESAMPLES = 2_000  # of a bootstrap: Efron and Tibshirani 1993, section 13.3, name 1,000 for percentiles
BISECTIONS = 60  # halvings of [0, 1]: down to the last digit of a float
CHUNK = 4_000_000  # numbers drawn at once by a bootstrap, for the memory


class Interval(NamedTuple):
    """An estimate with its interval."""

    value: float
    low: float
    high: float

    @property
    def width(self) -> float:
        """From the low end to the high end."""
        return self.high - self.low


def wilson(successes: int, trials: int, confidence: float = 0.95) -> Interval:
    """The rate of successes with its score interval: Wilson 1927; Brown, Cai, DasGupta 2001, equation 4.

    Without trials the interval is all of [0, 1] and the value NaN.
    """
    if trials == 0:
        return Interval(math.nan, 0.0, 1.0)
    z = NormalDist().inv_cdf(0.5 + confidence / 2.0)
    share, squared = successes / trials, z * z
    centre = (share + squared / (2.0 * trials)) / (1.0 + squared / trials)
    half = z / (1.0 + squared / trials) * math.sqrt(share * (1.0 - share) / trials + squared / (4.0 * trials**2))
    low = 0.0 if successes == 0 else max(0.0, centre - half)
    return Interval(share, low, 1.0 if successes == trials else min(1.0, centre + half))


def clopper_pearson(successes: int, trials: int, confidence: float = 0.95) -> Interval:
    """The rate of successes with its exact interval, which is never too narrow: Clopper and Pearson 1934.

    Each end is the rate at which a result as extreme has the probability ``(1 - confidence) / 2``.
    """
    if trials == 0:
        return Interval(math.nan, 0.0, 1.0)
    tail = (1.0 - confidence) / 2.0
    low, high = 0.0, 1.0
    if successes > 0:
        low = _rate_where(lambda rate: binomial_tail(successes, trials, rate) < tail)
    if successes < trials:
        high = _rate_where(lambda rate: 1.0 - binomial_tail(successes + 1, trials, rate) > tail)
    return Interval(successes / trials, low, high)


def binomial_tail(least: int, trials: int, rate: float) -> float:
    """The probability of at least so many successes in independent trials, each with ``rate``."""
    if least <= 0:
        return 1.0
    if rate <= 0.0 or least > trials:
        return 0.0
    if rate >= 1.0:
        return 1.0
    return min(1.0, math.fsum(_terms(least, trials, trials, rate)))


def bootstrap(values: NDArray[np.float64], confidence: float = 0.95, seed: int = 0) -> Interval:
    """The mean with its percentile interval: Efron and Tibshirani 1993, "An Introduction to the Bootstrap", chapter 13.

    ``values`` is (N,); NaN in it is left out. All chance comes from ``seed``.
    """
    known = values[np.isfinite(values)]
    if len(known) == 0:
        return Interval(math.nan, math.nan, math.nan)
    rng, means = np.random.default_rng(seed), np.empty(RESAMPLES)
    step = max(1, CHUNK // len(known))
    for begin in range(0, RESAMPLES, step):
        count = min(step, RESAMPLES - begin)
        means[begin : begin + count] = known[rng.integers(0, len(known), (count, len(known)))].mean(axis=1)
    tail = (1.0 - confidence) / 2.0
    low, high = np.quantile(means, [tail, 1.0 - tail])
    return Interval(float(known.mean()), float(low), float(high))


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


def _terms(least: int, most: int, trials: int, rate: float) -> list[float]:
    """The binomial probabilities of least to most successes."""
    log_rate, log_rest = math.log(rate), math.log1p(-rate)
    whole = math.lgamma(trials + 1)
    return [
        math.exp(whole - math.lgamma(k + 1) - math.lgamma(trials - k + 1) + k * log_rate + (trials - k) * log_rest)
        for k in range(least, most + 1)
    ]


def _rate_where(is_below: Callable[[float], bool]) -> float:
    """The rate in [0, 1] at which a function turns from true to false."""
    low, high = 0.0, 1.0
    for _ in range(BISECTIONS):
        middle = (low + high) / 2.0
        low, high = (middle, high) if is_below(middle) else (low, middle)
    return (low + high) / 2.0
