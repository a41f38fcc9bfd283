"""`CrossEntropy` proposes drives for a rare failure; `estimate` gives its probability, an interval, and cautions.

Drives are drawn from a mixture under which failures are common (``proposal``), and each counts with the weight
``nominal density / density of the mixture``. The cross-entropy method moves the mixture: Rubinstein and Kroese 2004,
"The Cross-Entropy Method", and de Boer et al. 2005, "A tutorial on the cross-entropy method", algorithm 3.1.

The drives that move the mixture are not in the estimate, so the estimate is unbiased.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.special import gammaincinv, ndtri

from basu_search.proposal import drawn_from, guarded, mixture_of, parts_of, weights_of
from basu_search.rounds import Known, Round, round_sizes

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.campaigns.settings import EstimateSettings
    from basu_search.proposal import Mixture

LOOK_AROUND = 0.4  # share of the wide guard while the mixture learns
LOOK_ON = 0.1  # and of the drives of the estimate
LEAST_ELITE = 5  # drives from which a mixture is computed
FAILED = 1.0  # severity of a failure, above that of every success
FEW = 30.0  # effective failures below which an estimate says that it rests on few
HEAVY = 0.08  # of an estimate: a larger part from one drive gets a caution
STRAY = 0.1  # of an estimate: a larger part from failures outside of the proposal's regions gets a caution


class CrossEntropy:
    """Proposals of one estimate."""

    def __init__(self, settings: EstimateSettings, dimensions: int, seed: int) -> None:
        """Take the settings; all chance comes from ``seed``."""
        self._settings, self._dimensions, self._seed = settings, dimensions, seed
        learning = round_sizes(min(settings.batch, settings.learn), settings.learn, settings.batch)
        self.learning = len(learning)  # rounds that move the mixture
        self.sizes = (
            *learning,
            *round_sizes(min(settings.batch, settings.drives), settings.drives, settings.batch),
        )

    def propose(self, number: int, rounds: list[Round], known: Known) -> Round:
        """The round of a number: from a moved mixture while it learns, then all from the last one."""
        plain, is_learning = self._settings.plain, number < self.learning
        if number > self.learning:
            mixture = mixture_of(rounds[self.learning])
        else:
            parts: Mixture = ()
            if number > 0:
                weights = np.concatenate([weights_of(each) for each in rounds])
                parts = parts_from(known, weights, self._settings.elite, self.sizes[number - 1])
            wide = (LOOK_AROUND if is_learning else LOOK_ON) * (1.0 - plain)
            mixture = guarded(parts, self._dimensions, plain, wide)
        points = drawn_from(mixture, self.sizes[number], np.random.default_rng([self._seed, number]))
        said = [{"share": each.share, "mean": list(each.mean), "deviation": list(each.deviation)} for each in mixture]
        return Round(points, {"by": "cross-entropy", "learns": is_learning, "mixture": said})


def parts_from(known: Known, weights: NDArray[np.float64], elite: float, newest: int) -> Mixture:
    """Return the parts of the next mixture, from the most severe drives of all rounds so far, each with its weight.

    The share ``elite`` of the ``newest`` drives is as severe as all that count, or some drives more where these are
    too few. Where all drives are equally severe there is no part.
    """
    judged = ~np.isnan(known.failed)
    severity = known.severity[judged]
    of_last = known.severity[-newest:][judged[-newest:]]
    if len(of_last) < LEAST_ELITE or float(np.ptp(severity)) == 0.0:
        return ()
    level = min(FAILED, float(np.quantile(of_last, 1.0 - elite)), float(np.sort(severity)[-LEAST_ELITE]))
    chosen = (severity >= level) & (severity > severity.min())
    return parts_of(ndtri(known.points[judged][chosen]), weights[judged][chosen])


class RareEvent(NamedTuple):
    """A probability of failure with its interval."""

    value: float
    low: float
    high: float
    deviation: float  # standard error: the root of the estimate's variance
    drives: int
    failures: int
    gain: float  # how many plain drives one of these is worth; NaN without a failure
    unseen: float  # the upper end of what a region may add in which no drive lies, whatever its place and size
    cautions: tuple[str, ...] = ()  # why it is not to be trusted as it stands


def estimate(
    failed: NDArray[np.bool_],
    weights: NDArray[np.float64],
    guards: NDArray[np.float64],
    plain: float,
    confidence: float = 0.95,
) -> RareEvent:
    """The probability of failure from weighted drives (N,), all from one mixture with a share ``plain`` of plain ones.

    ``guards`` is (N,), the probability of each drive to come from a guard. Value and variance: Owen 2013, "Monte
    Carlo theory, methods and examples", section 9.1. The interval is that of a weighted sum of Poisson counts, with
    the heaviest failure as the one that may be missing (Fay and Feuer 1997, "Confidence intervals for directly
    standardized rates: a method based on the gamma distribution", equation 3). It holds for the regions in which drives
    lie. Without a failure, and for any other region, the upper end is the rate that so many drives miss with the
    probability ``1 - confidence``. Each drive meets such a region with the probability ``plain * rate`` at least.
    """
    drives, failures = len(failed), int(failed.sum())
    unseen = 1.0 if drives == 0 else min(1.0, -math.expm1(math.log1p(-confidence) / drives) / plain)
    if drives < 2 or failures == 0:
        return RareEvent(0.0 if drives else math.nan, 0.0, unseen, math.nan, drives, failures, math.nan, unseen)
    terms = np.where(failed, weights, 0.0)
    value = float(terms.mean())
    variance = float(terms.var(ddof=1)) / drives
    heaviest, tail = float(terms.max()) / drives, (1.0 - confidence) / 2.0
    low = _gamma_quantile(value, variance, tail)
    high = _gamma_quantile(value + heaviest, variance + heaviest**2, 1.0 - tail)
    gain = value * max(0.0, 1.0 - value) / drives / variance if variance > 0.0 else math.nan
    cautions = _cautions(terms, guards)
    return RareEvent(value, low, min(1.0, high), math.sqrt(variance), drives, failures, gain, unseen, cautions)


def _gamma_quantile(mean: float, variance: float, share: float) -> float:
    """The value below which so large a share of a gamma distribution lies."""
    return mean if variance == 0.0 else float(gammaincinv(mean**2 / variance, share)) * variance / mean


def _cautions(terms: NDArray[np.float64], guards: NDArray[np.float64]) -> tuple[str, ...]:
    """What speaks against an estimate: few effective failures, one heavy drive, failures where none was expected."""
    whole = terms.sum()
    effective, heavy = whole**2 / (terms**2).sum(), terms.max() / whole
    stray = terms[guards > 0.5].sum() / whole
    said = []
    if effective < FEW:
        said.append(f"its failures are worth {effective:.0f} of equal weight, fewer than {FEW:.0f}")
    if heavy > HEAVY:
        said.append(f"one drive makes up {100.0 * heavy:.0f} % of it")
    if stray > STRAY:
        said.append(f"{100.0 * stray:.0f} % of it is from failures where none was expected, so a region may be unknown")
    return tuple(said)
