"""Claims about the estimate of a rare failure: it agrees with closed forms, and its interval covers."""

import math
from statistics import NormalDist

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.special import ndtri

from basu.campaigns.search.rare_event import CrossEntropy, RareEvent, estimate, weights_of
from basu.campaigns.search.rounds import Known, Round
from basu.campaigns.settings import Estimate

BETA = 3.5  # a half space this far from the middle of a standard normal distribution fails
EXACT = NormalDist().cdf(-BETA)  # 2.33e-4, for every direction of it


def depth(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far points of the unit cube lie along the half space's direction, in standard deviations."""
    normal = ndtri(points)
    direction = np.array([3.0, 4.0]) / 5.0
    along: NDArray[np.float64] = normal @ direction
    return along


def known_of(rounds: list[Round]) -> Known:
    points = np.concatenate([made.points for made in rounds]) if rounds else np.empty((0, 2))
    along = depth(points)
    severity = np.where(along > BETA, 1.0, 0.99 / (1.0 + np.maximum(BETA - along, 0.0)))
    return Known(points, (along > BETA).astype(np.float64), severity, np.zeros(len(points), dtype=np.bool_))


def estimated(settings: Estimate, seed: int) -> RareEvent:
    proposer, rounds = CrossEntropy(settings, 2, seed), list[Round]()
    for number in range(len(proposer.sizes)):
        rounds.append(proposer.propose(number, rounds, known_of(rounds)))
    final = [made for made in rounds if not made.about["learns"]]
    points = np.concatenate([made.points for made in final])
    weights = np.concatenate([weights_of(made, settings.plain) for made in final])
    return estimate(depth(points) > BETA, weights, settings.plain)


def test_the_estimate_agrees_with_the_closed_form_of_a_half_space() -> None:
    settings = Estimate(drives=500, learn=400, batch=100)
    found = [estimated(settings, seed) for seed in range(60)]
    values = np.array([each.value for each in found])
    spread = values.std(ddof=1)
    assert abs(values.mean() - EXACT) < 3.0 * spread / math.sqrt(len(found))  # unbiased
    assert spread < 0.25 * EXACT
    stated = math.sqrt(float(np.mean([each.deviation**2 for each in found])))
    assert stated == pytest.approx(spread, rel=0.3)  # the variance that it says is the variance that it has
    covers = sum(each.low <= EXACT <= each.high for each in found)
    assert covers >= 52  # of 60 at 95 %: fewer than 52 have the probability 0.002
    plain_spread = math.sqrt(EXACT * (1.0 - EXACT) / settings.drives)
    assert spread < 0.1 * plain_spread  # as many plain drives know a hundredth as much
    assert np.median([each.gain for each in found]) > 50.0


def test_a_plain_sample_has_the_variance_of_a_binomial() -> None:
    failed = np.arange(1000) % 50 == 0
    found = estimate(failed, np.ones(1000), plain=1.0)
    assert found.value == pytest.approx(0.02)
    assert found.deviation == pytest.approx(math.sqrt(0.02 * 0.98 / 999))
    assert found.gain == pytest.approx(1.0, rel=0.01)
    assert found.low < 0.02 < found.high


def test_without_a_failure_the_upper_end_is_the_rule_of_three() -> None:
    found = estimate(np.zeros(300, dtype=np.bool_), np.ones(300), plain=1.0)
    assert (found.value, found.low, found.failures) == (0.0, 0.0, 0)
    assert found.high == pytest.approx(3.0 / 300, rel=0.01)  # Hanley and Lippman-Hand 1983
    assert estimate(np.zeros(300, dtype=np.bool_), np.ones(300), plain=0.1).high == pytest.approx(0.1, rel=0.01)


def test_weights_are_bounded_and_their_mean_is_one() -> None:
    settings = Estimate(drives=4000, batch=4000, learn=10, plain=0.2)
    proposer = CrossEntropy(settings, 2, 1)
    rounds = [Round(np.full((10, 2), 0.5), {"learns": True, "mean": [1.5, -1.0], "deviation": [0.5, 2.0]})]
    made = proposer.propose(1, rounds, known_of(rounds))
    made = Round(made.points, {**made.about, "mean": [0.0, 0.0], "deviation": [1.0, 1.0]})
    assert np.allclose(weights_of(made, 0.2), 1.0)  # the nominal distribution as proposal
    weights = weights_of(Round(made.points, {"mean": [1.5, -1.0], "deviation": [0.5, 2.0]}), 0.2)
    assert weights.max() <= 1.0 / 0.2


def test_proposals_repeat_by_their_seed() -> None:
    settings = Estimate(drives=20, learn=20, batch=10)
    assert estimated(settings, 5) == pytest.approx(estimated(settings, 5), nan_ok=True)
    one, other = (CrossEntropy(settings, 2, seed).propose(0, [], known_of([])).points for seed in (5, 6))
    assert not np.array_equal(one, other)
