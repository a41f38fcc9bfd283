"""The share of failures around a point in the space of two parameters, and how well it predicts a verdict.

Nadaraya 1964 and Watson 1964: a mean of the cases around, weighted by their nearness; the width of the weights is the
distance of the so-many-th neighbour, so it adapts to how densely cases lie. No shape of the boundary is assumed. How
much it can be trusted is measured on the cases themselves, each foretold from all others, and held against what the
same cases with their verdicts dealt out anew would do (a permutation test).
"""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.output.report.scenarios.sweep.study import Axis, Study


LEAST_NEIGHBOURS = 3
MOST_CASES = 400  # that a pair of parameters is tried on; among more of them, every so-many-th
MOST_AXES = 10  # parameters tried in pairs: the first ones declared
DEALS, BY_CHANCE = (
    199,
    0.05,
)  # how often verdicts are dealt out anew; a pair that is this likely by chance tells nothing
HALF = 0.5
CERTAIN = 1e-3  # a share stays this far from 0 and 1, so that one mistake does not outweigh all


class ParameterPair(NamedTuple):
    """Two parameters, and how well they predict verdicts."""

    x: Axis
    y: Axis
    right: int  # verdicts foretold, each from all others
    used: int
    commoner: int  # that one would have right by always saying the commoner verdict
    loss: float  # mean logarithmic loss, by which pairs are compared
    chance: float  # of the best of all pairs being as good with the same verdicts dealt out anew

    @property
    def tells(self) -> bool:
        """Whether there is a boundary to draw."""
        return self.chance <= BY_CHANCE and self.right >= self.commoner


def neighbours_of(count: int) -> int:
    """Return how many neighbours weigh: about half the square root of all, 7 of 200."""
    return max(LEAST_NEIGHBOURS, round(math.sqrt(count) / 2.0))


def best_pair(study: Study) -> ParameterPair | None:
    """Return the two parameters that predict the verdicts best by neighbourhood; None where fewer than two vary.

    What chance would do is known from the same cases with their verdicts dealt out anew, so many times: each time the
    best of all pairs counts, as it does here.
    """
    chosen = _chosen(len(study.failed))
    failed = study.failed[chosen]
    dice = np.random.default_rng(DEALS)
    verdicts = np.column_stack([failed, *(dice.permutation(failed) for _ in range(DEALS))])  # (n, 1 + DEALS)
    pairs: list[ParameterPair] = []
    least = np.full(DEALS, np.inf)
    commoner = int(max(failed.sum(), (~failed).sum()))
    for x, y in itertools.combinations(study.axes[:MOST_AXES], 2):
        cases = _scaled(x, y)[chosen]
        apart = _apart(cases, cases, x, y)
        np.fill_diagonal(apart, np.inf)
        share = _weighted(apart, verdicts, neighbours_of(len(study.failed)))
        share = np.clip(share, CERTAIN, 1.0 - CERTAIN)
        losses = -np.where(verdicts, np.log(share), np.log1p(-share)).mean(axis=0)
        right = int(((share[:, 0] > HALF) == failed).sum())
        pairs.append(ParameterPair(x, y, right, len(failed), commoner, float(losses[0]), 1.0))
        least = np.minimum(least, losses[1:])
    if not pairs:
        return None
    best = min(pairs, key=lambda pair: pair.loss)
    return best._replace(chance=(1.0 + float((least <= best.loss).sum())) / (1.0 + DEALS))


def shares(study: Study, x: Axis, y: Axis, at: NDArray[np.float64]) -> NDArray[np.float64]:
    """(M,) the share of failures around places (M, 2), given as shares of both axes."""
    chosen = _chosen(len(study.failed))
    cases = _scaled(x, y)[chosen]
    share = _weighted(_apart(at, cases, x, y), study.failed[chosen][:, None], neighbours_of(len(study.failed)))
    return share[:, 0]


def _chosen(count: int) -> NDArray[np.int64]:
    """Return which cases are looked at."""
    return np.arange(0, count, max(1, -(-count // MOST_CASES)))


def _scaled(x: Axis, y: Axis) -> NDArray[np.float64]:
    return np.column_stack([x.share(x.values), y.share(y.values)])


def _apart(at: NDArray[np.float64], cases: NDArray[np.float64], x: Axis, y: Axis) -> NDArray[np.float64]:
    """(M, N) distances: along a choice, two options are as far apart as the ends of a number."""
    parts = np.abs(at[:, None, :] - cases[None, :, :])
    for column, axis in enumerate((x, y)):
        if axis.options:
            parts[..., column] = parts[..., column] > 0.5 / len(axis.options)
    away: NDArray[np.float64] = np.hypot(parts[..., 0], parts[..., 1])
    return away


def _weighted(apart: NDArray[np.float64], failed: NDArray[np.bool_], count: int) -> NDArray[np.float64]:
    """(M, K) the means of (N, K) verdicts over (M, N) neighbours, weighted by nearness."""
    nth = min(count, apart.shape[1] - 1) - 1
    width = np.maximum(np.partition(apart, nth, axis=1)[:, nth], 1e-6)
    weights = np.exp(-0.5 * (apart / width[:, None]) ** 2)
    share: NDArray[np.float64] = (weights @ failed.astype(np.float64)) / np.maximum(weights.sum(axis=1), 1e-300)[
        :, None
    ]
    return share
