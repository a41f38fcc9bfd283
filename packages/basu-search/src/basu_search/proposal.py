"""Mixtures of normal distributions from which an estimate's drives come, and the weights of these drives.

A mixture begins with two guards: the nominal distribution (a defensive mixture: Hesterberg 1995, "Weighted average
importance sampling and defensive mixture distributions"), and one twice as wide, which reaches failing regions of which
nothing was known. The other parts are where failures were found, several of them since there may be several regions
(Kurtz and Song 2013, "Cross-entropy-based adaptive importance sampling using Gaussian mixture"). A drive's weight has
the density of the whole mixture in it, whichever part it came from (the balance heuristic: Veach and Guibas 1995).

Computations are in the space in which the nominal distribution is standard normal.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.special import logsumexp, ndtr, ndtri
from sklearn.cluster import KMeans
from threadpoolctl import ThreadpoolController

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu_search.rounds import Round

WIDE = 2.0  # standard deviation of the wide guard
GUARDS = 2  # parts at the beginning of a mixture that know nothing of failures
PARTS = 4  # of a mixture, beside its guards
LEAST_OF_PART = 3  # drives from which a part is computed
LEAST_DEVIATION = 1.0  # of a part: a narrower one than the nominal gives failures at its rim large weights
EVEN = 0.5  # of the parts' shares is divided evenly, so that a region with a small probability keeps its part
THREADS = ThreadpoolController()
EDGE = 1e-15  # shares of the unit cube stay this far from 0 and 1


class Part(NamedTuple):
    """Independent normal distributions with their share of a mixture."""

    share: float
    mean: tuple[float, ...]
    deviation: tuple[float, ...]


Mixture = tuple[Part, ...]


def guarded(parts: Mixture, dimensions: int, plain: float, wide: float) -> Mixture:
    """Return a mixture of the guards, with their shares, and parts that share the rest."""
    middle, rest = (0.0,) * dimensions, 1.0 - plain - wide
    guards = (Part(plain, middle, (1.0,) * dimensions), Part(wide, middle, (WIDE,) * dimensions))
    if not parts:
        return (guards[0]._replace(share=1.0 - wide), guards[1])
    return (*guards, *(each._replace(share=each.share * rest) for each in parts))


def drawn_from(mixture: Mixture, count: int, dice: np.random.Generator) -> NDArray[np.float64]:
    """(count, D) independent points of the unit cube."""
    shares = np.array([each.share for each in mixture])
    chosen = dice.choice(len(mixture), size=count, p=shares / shares.sum())
    means, deviations = (np.array([getattr(each, name) for each in mixture]) for name in ("mean", "deviation"))
    normal = means[chosen] + dice.standard_normal((count, means.shape[1])) * deviations[chosen]
    points: NDArray[np.float64] = np.clip(ndtr(normal), EDGE, 1.0 - EDGE)
    return points


def mixture_of(made: Round) -> Mixture:
    """The mixture from which a round was drawn."""
    return tuple(Part(each["share"], tuple(each["mean"]), tuple(each["deviation"])) for each in made.about["mixture"])


def weights_of(made: Round) -> NDArray[np.float64]:
    """Return the importance weight (n,) of each drive of a round: nominal density divided by the mixture's density.

    No weight is above 1 divided by the plain share.
    """
    weights: NDArray[np.float64] = np.exp(-logsumexp(_log_ratios(made), axis=0))
    return weights


def guards_in(made: Round) -> NDArray[np.float64]:
    """(n,) the probability that a drive came from a guard; 0 where the mixture has nothing else."""
    if not any(each.share for each in mixture_of(made)[GUARDS:]):
        return np.zeros(len(made.points))
    ratios = _log_ratios(made)
    found: NDArray[np.float64] = np.exp(logsumexp(ratios[:GUARDS], axis=0) - logsumexp(ratios, axis=0))
    return found


def parts_of(normal: NDArray[np.float64], weights: NDArray[np.float64]) -> Mixture:
    """Return parts at the clusters of weighted points (N, D): the weighted mean and deviation of each.

    The clusters are those of k-means with the weights. The shares sum to 1.
    """
    count = max(1, min(PARTS, len(normal) // LEAST_OF_PART))
    with THREADS.limit(limits=1):  # a sum over several threads has another rounding from run to run
        clusters = KMeans(count, n_init=5, random_state=0).fit(normal, sample_weight=weights / weights.max()).labels_
    parts = []
    for cluster in np.unique(clusters):
        held, at = weights[clusters == cluster], normal[clusters == cluster]
        mean = held @ at / held.sum()
        deviation = np.sqrt(np.maximum(held @ (at - mean) ** 2 / held.sum(), LEAST_DEVIATION**2))
        parts.append(Part(float(held.sum() / weights.sum()), tuple(mean.tolist()), tuple(deviation.tolist())))
    return tuple(each._replace(share=EVEN / len(parts) + (1.0 - EVEN) * each.share) for each in parts)


def _log_ratios(made: Round) -> NDArray[np.float64]:
    """(parts, n) the logarithm of each part's share times its density over the nominal one, at a round's drives."""
    normal = ndtri(made.points)
    rows = []
    for part in mixture_of(made):
        away = (normal - np.array(part.mean)) / part.deviation
        scale = math.fsum(math.log(each) for each in part.deviation)
        with np.errstate(divide="ignore"):
            rows.append(np.log(part.share) + 0.5 * (normal**2 - away**2).sum(axis=1) - scale)
    return np.array(rows)
