"""The probability of a rare failure by importance sampling, with its variance and interval.

Drives are drawn from a proposal under which failures are common, and each counts with the weight ``nominal density /
proposal density``. The cross-entropy method moves the proposal: Rubinstein and Kroese 2004, "The Cross-Entropy Method",
and de Boer et al. 2005, "A tutorial on the cross-entropy method", algorithm 3.1. A part of the drives comes from the
nominal distribution (a defensive mixture: Hesterberg 1995), so no weight exceeds ``1 / plain``.

Computations are in the space in which the nominal distribution is standard normal. The drives that move the proposal
are not in the estimate, so the estimate is unbiased.
"""

from __future__ import annotations

import math
from statistics import NormalDist
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.campaigns.search.rounds import Known, Round, round_sizes

try:
    from scipy.special import ndtr, ndtri
except ImportError as error:
    from basu.errors import UserError

    raise UserError("an estimate needs scipy; install it with `pip install linden[search]`") from error

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.campaigns.settings import Estimate

LEAST_DEVIATION = 1.0  # of a proposal: a narrower one than the nominal gives failures at its rim large weights
SMOOTHING = 0.7  # of the step from one deviation to the next: de Boer et al. 2005, remark 3.3
LEAST_ELITE = 5  # drives from which a proposal is computed
FAILED = 1.0  # severity of a failure, above that of every success
EDGE = 1e-15  # shares stay this far from 0 and 1


class Proposal(NamedTuple):
    """Independent normal distributions, in the space in which the nominal ones are standard normal."""

    mean: tuple[float, ...]
    deviation: tuple[float, ...]


class CrossEntropy:
    """Proposals of one estimate."""

    def __init__(self, settings: Estimate, dimensions: int, seed: int) -> None:
        """Take the settings; all chance comes from ``seed``."""
        self._settings, self._dimensions, self._seed = settings, dimensions, seed
        learning = round_sizes(min(settings.batch, settings.learn), settings.learn, settings.batch)
        self.learning = len(learning)  # rounds that move the proposal
        self.sizes = (
            *learning,
            *round_sizes(min(settings.batch, settings.drives), settings.drives, settings.batch),
        )

    def propose(self, number: int, rounds: list[Round], known: Known) -> Round:
        """The round of a number: from a moved proposal while it learns, then all from the last one."""
        usual = Proposal((0.0,) * self._dimensions, (1.0,) * self._dimensions)
        proposal = usual
        if number > self.learning:
            proposal = proposal_of(rounds[self.learning])
        elif number > 0:
            last = proposal_of(rounds[number - 1])
            weights = [weights_of(each, self._settings.plain) for each in rounds]
            proposal = moved(last, known, np.concatenate(weights), self._settings.elite, self.sizes[number - 1])
        dice = np.random.default_rng([self._seed, number])
        count = self.sizes[number]
        drawn = np.array(proposal.mean) + dice.standard_normal((count, self._dimensions)) * proposal.deviation
        plain = dice.random(count) < self._settings.plain
        drawn = np.where(plain[:, None], dice.standard_normal(drawn.shape), drawn)
        points = np.clip(ndtr(drawn), EDGE, 1.0 - EDGE)
        drawn_from = {"mean": list(proposal.mean), "deviation": list(proposal.deviation)}
        return Round(points, {"by": "cross-entropy", "learns": number < self.learning, **drawn_from})


def proposal_of(made: Round) -> Proposal:
    """The proposal from which a round was drawn."""
    return Proposal(tuple(made.about["mean"]), tuple(made.about["deviation"]))


def weights_of(made: Round, plain: float) -> NDArray[np.float64]:
    """(n,) the weights of a round's drives, none above ``1 / plain``."""
    proposal, normal = proposal_of(made), ndtri(made.points)
    away = (normal - np.array(proposal.mean)) / proposal.deviation
    log_ratio = 0.5 * (normal**2 - away**2).sum(axis=1) - math.fsum(math.log(each) for each in proposal.deviation)
    weights: NDArray[np.float64] = 1.0 / (plain + (1.0 - plain) * np.exp(np.minimum(log_ratio, 700.0)))
    return weights


def moved(last: Proposal, known: Known, weights: NDArray[np.float64], elite: float, newest: int) -> Proposal:
    """The next proposal, from the most severe drives of all rounds so far, each with its weight.

    The share ``elite`` of the ``newest`` drives is as severe as all that count.
    """
    judged = ~np.isnan(known.failed)
    of_last = known.severity[-newest:][judged[-newest:]]
    if len(of_last) < LEAST_ELITE:
        return last
    severity, held = known.severity[judged], weights[judged]
    normal = ndtri(known.points[judged])
    level = min(FAILED, float(np.quantile(of_last, 1.0 - elite)))
    chosen = severity >= level
    if chosen.sum() < LEAST_ELITE or float(np.ptp(severity)) == 0.0:
        return last
    share = held[chosen] / held[chosen].sum()
    mean = share @ normal[chosen]
    deviation = np.sqrt(np.maximum(share @ (normal[chosen] - mean) ** 2, LEAST_DEVIATION**2))
    deviation = SMOOTHING * deviation + (1.0 - SMOOTHING) * np.array(last.deviation)
    return Proposal(tuple(mean.tolist()), tuple(deviation.tolist()))


class RareEvent(NamedTuple):
    """A probability of failure with its interval."""

    value: float
    low: float
    high: float
    deviation: float  # standard error: the root of the estimate's variance
    drives: int
    failures: int
    gain: float  # how many plain drives one of these is worth; NaN without a failure


def estimate(
    failed: NDArray[np.bool_], weights: NDArray[np.float64], plain: float, confidence: float = 0.95
) -> RareEvent:
    """The probability of failure from weighted drives (N,), all from one proposal with a share ``plain`` of plain ones.

    Owen 2013, "Monte Carlo theory, methods and examples", section 9.1. The interval is that of the logarithm (the delta
    method), since the estimate of a small probability is skewed. Without a failure the upper end is the
    rate at which so many drives would have none with the probability ``1 - confidence``. Each fails with the
    probability ``plain * rate`` at least.
    """
    drives, failures = len(failed), int(failed.sum())
    if drives < 2 or failures == 0:
        high = 1.0 if drives == 0 else min(1.0, -math.expm1(math.log1p(-confidence) / drives) / plain)
        return RareEvent(0.0 if drives else math.nan, 0.0, high, math.nan, drives, failures, math.nan)
    terms = np.where(failed, weights, 0.0)
    value = float(terms.mean())
    deviation = float(terms.std(ddof=1)) / math.sqrt(drives)
    factor = math.exp(NormalDist().inv_cdf(0.5 + confidence / 2.0) * deviation / value)
    gain = value * max(0.0, 1.0 - value) / drives / deviation**2 if deviation > 0.0 else math.nan
    return RareEvent(value, value / factor, min(1.0, value * factor), deviation, drives, failures, gain)
