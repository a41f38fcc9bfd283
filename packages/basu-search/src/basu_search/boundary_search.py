"""The search for the boundary of failure: space-filling first, then where the surrogate is the least sure.

The learning function is that of Echard, Gayton, Lemaire 2011, "AK-MCS: an active learning reliability method combining
Kriging and Monte Carlo simulation". There ``|mean| / deviation`` of the latent function is the least where the side of
the boundary is the least sure. Here the probability of a side counts, times the distance to the nearest drive. Every
fourth proposal is the candidate that is the farthest from all drives, so that a second region of failures is met too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from basu_search.rounds import Known, Round, round_sizes, space_filling
from basu_search.surrogate import SeveritySurrogate, Surrogate

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.campaigns.settings import Search

CANDIDATE_BITS = 12  # 4,096 candidates for proposals, the same in every round
EXPLORES = 4  # every so-many-th proposal is the farthest from all drives
APART = 0.01  # of the cube's side: least distance from one drive to the next
NEAR = 0.1  # of the cube's side: a drive nearer than this makes a candidate worth less
NEIGHBOURS = 5  # their judgement says whether a candidate will be judged
LEAST_JUDGED = 0.1  # the weight of a candidate among drives that were not judged


class BoundarySearch:
    """Proposals of one search."""

    def __init__(self, settings: Search, dimensions: int, seed: int) -> None:
        """Take the settings; all chance comes from ``seed``."""
        self._settings, self._dimensions, self._seed = settings, dimensions, seed
        self.sizes = round_sizes(settings.space_filling, settings.drives, settings.batch)

    def propose(self, number: int, rounds: list[Round], known: Known) -> Round:  # noqa: ARG002 - as a Proposer's
        """The round of a number: a Sobol sequence, then candidates one after the other."""
        size = self.sizes[number]
        if number == 0:
            return Round(space_filling(size, self._dimensions, self._seed), {"by": "space-filling"})
        choice = _Choice(known, space_filling(2**CANDIDATE_BITS, self._dimensions, self._seed + 1))
        points = np.array([choice.next(place) for place in range(size)])
        return Round(points, {"by": choice.by})


class _Choice:
    """Chooses candidates of one round."""

    def __init__(self, known: Known, candidates: NDArray[np.float64]) -> None:
        judged = ~np.isnan(known.failed)
        failed = known.failed[judged] > 0.5
        self._candidates = candidates
        self._away = _nearest(candidates, known.points)
        self._judged = _judged_share(candidates, known.points, judged)
        self._surrogate: Surrogate | None = None
        self._upper: NDArray[np.float64] | None = None
        self.by = "space-filling"
        if failed.any() and not failed.all():
            self._surrogate, self.by = Surrogate(known.points[judged], failed), "boundary"
        elif judged.any() and not failed.any() and np.ptp(known.severity[judged]) > 0.0:
            self._upper = SeveritySurrogate(known.points[judged], known.severity[judged]).upper(candidates)
            self.by = "severity"

    def next(self, place: int) -> NDArray[np.float64]:
        """The next candidate of the round, (D,)."""
        scores = self._scores(explores=place % EXPLORES == EXPLORES - 1)
        scores = np.where(self._away >= APART, scores, -np.inf)
        chosen: NDArray[np.float64] = self._candidates[
            int(np.argmax(scores if np.isfinite(scores).any() else self._away))
        ]
        self._away = np.minimum(self._away, np.linalg.norm(self._candidates - chosen, axis=1))
        if self._surrogate is not None:
            self._surrogate = self._surrogate.believing(chosen)
        return chosen

    def _scores(self, *, explores: bool) -> NDArray[np.float64]:
        """(M,) the worth of every candidate."""
        if explores or (self._surrogate is None and self._upper is None):
            return self._away * self._judged
        if self._surrogate is None:
            assert self._upper is not None, "one of the two is there"
            severe: NDArray[np.float64] = (self._upper - self._upper.min()) * np.minimum(self._away, NEAR)
            return severe * self._judged
        side = self._surrogate.failing(self._candidates)
        unsure: NDArray[np.float64] = side * (1.0 - side) * np.minimum(self._away, NEAR)
        return unsure * self._judged


def _nearest(candidates: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """(M,) the distance from every candidate to the nearest of points (N, D)."""
    away = np.full(len(candidates), np.inf)
    for point in points:
        away = np.minimum(away, np.linalg.norm(candidates - point, axis=1))
    return away


def _judged_share(
    candidates: NDArray[np.float64], points: NDArray[np.float64], judged: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """(M,) the share of judged drives among the nearest, at least ``LEAST_JUDGED``.

    A case without a conflict tells nothing, so a search avoids such places.
    """
    if judged.all():
        return np.ones(len(candidates))
    count = min(NEIGHBOURS, len(points))
    distances = np.linalg.norm(candidates[:, None, :] - points[None, :, :], axis=2)
    nearest = np.argsort(distances, axis=1, kind="stable")[:, :count]
    share: NDArray[np.float64] = np.maximum(judged[nearest].mean(axis=1), LEAST_JUDGED)
    return share
