"""Failing regions with known probabilities, in the space in which the nominal distribution is standard normal.

They stand in for a simulator where claims about the estimate of a rare failure are tested.
"""

from __future__ import annotations

from collections.abc import Callable
from statistics import NormalDist
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri
from scipy.stats import ncx2

from basu.campaigns.settings import EstimateSettings
from basu_search.proposal import guards_in, weights_of
from basu_search.rare_event import CrossEntropy, RareEvent, estimate
from basu_search.rounds import Known, Round

Gap = Callable[[NDArray[np.float64]], NDArray[np.float64]]  # (N, D) to (N,): the distance to a region, negative inside


class Region(NamedTuple):
    """A region that fails, with its probability; severity grows towards the parts in ``felt`` and is flat elsewhere."""

    dimensions: int
    gap: Gap
    felt: Gap
    exact: float

    def known(self, rounds: list[Round]) -> Known:
        """Return what drives of rounds would have shown."""
        points = np.concatenate([np.empty((0, self.dimensions)), *[made.points for made in rounds]])
        normal = ndtri(points)
        failed = self.gap(normal) < 0.0
        severity = np.where(failed, 1.0, 0.99 / (1.0 + np.maximum(self.felt(normal), 0.0)))
        return Known(points, failed.astype(np.float64), severity, np.zeros(len(points), dtype=np.bool_))

    def estimated(self, settings: EstimateSettings, seed: int) -> RareEvent:
        """Return the estimate that a campaign would make of it."""
        proposer, rounds = CrossEntropy(settings, self.dimensions, seed), list[Round]()
        for number in range(len(proposer.sizes)):
            rounds.append(proposer.propose(number, rounds, self.known(rounds)))
        final = [made for made in rounds if not made.about["learns"]]
        weights, guards = (np.concatenate([of(made) for made in final]) for of in (weights_of, guards_in))
        return estimate(self.known(final).failed > 0.5, weights, guards, settings.plain)


def beyond(depth: float, *direction: float) -> Gap:
    """Return the half space that begins so far from the middle, in a direction."""
    unit = np.array(direction) / np.linalg.norm(direction)
    return lambda normal: depth - normal @ unit


def ball(radius: float, *centre: float) -> Gap:
    """Return a ball."""
    return lambda normal: np.linalg.norm(normal - np.array(centre), axis=1) - radius


def either(*gaps: Gap) -> Gap:
    """Return the union of regions."""
    return lambda normal: np.min([each(normal) for each in gaps], axis=0)


def above(depth: float) -> float:
    """Return the probability of a half space that begins so far from the middle."""
    return NormalDist().cdf(-depth)


def inside(radius: float, *centre: float) -> float:
    """Return the probability of a ball."""
    return float(ncx2.cdf(radius**2, len(centre), np.square(centre).sum()))


def one(first: Gap, dimensions: int, exact: float) -> Region:
    """Return a region towards which severity grows from everywhere."""
    return Region(dimensions, first, first, exact)


def pair(first: Gap, second: Gap, dimensions: int, exact: float, *, is_felt: bool = True) -> Region:
    """Return two regions apart; where the second is not felt, nothing leads to it."""
    both = either(first, second)
    return Region(dimensions, both, both if is_felt else first, exact)


REGIONS = {
    "one half space": one(beyond(3.5, 3.0, 4.0), 2, above(3.5)),
    "one ball": one(ball(1.0, 3.0, 2.0), 2, inside(1.0, 3.0, 2.0)),
    "two, equal": pair(beyond(3.5, 3.0, 4.0), beyond(3.5, -3.0, -4.0), 2, 2.0 * above(3.5)),
    "two, 82 and 18 %": pair(beyond(3.3, 1.0, 0.0), beyond(3.7, -1.0, 0.0), 2, above(3.3) + above(3.7)),
    "two balls": pair(ball(1.0, 3.5, 0.0), ball(1.0, 0.0, -3.6), 2, inside(1.0, 3.5, 0.0) + inside(1.0, 0.0, -3.6)),
    "two, four dimensions": pair(
        beyond(3.5, 1.0, 1.0, 1.0, 1.0), beyond(3.5, -1.0, -1.0, -1.0, -1.0), 4, 2.0 * above(3.5)
    ),
    "two, six dimensions": pair(beyond(3.5, *[1.0] * 6), beyond(3.5, *[-1.0] * 6), 6, 2.0 * above(3.5)),
    "two, severity leads to one": pair(
        beyond(3.5, 3.0, 4.0), beyond(3.5, -3.0, -4.0), 2, 2.0 * above(3.5), is_felt=False
    ),
    "two, one a speck without a lead": pair(
        beyond(3.5, 3.0, 4.0), ball(0.3, -3.0, 0.0), 2, above(3.5) + inside(0.3, -3.0, 0.0), is_felt=False
    ),
    "none": Region(2, lambda normal: np.full(len(normal), 9.0), beyond(3.5, 1.0, 1.0), 0.0),
}
