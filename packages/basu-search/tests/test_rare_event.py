"""Claims about the estimate of a rare failure: it agrees with closed forms, and its interval covers."""

import math

import numpy as np
import pytest

from basu.campaigns.settings import EstimateSettings
from basu_search.proposal import Part, drawn_from, guarded, guards_in, parts_of, weights_of
from basu_search.rare_event import CrossEntropy, estimate
from basu_search.rounds import Known, Round
from rare_regions import REGIONS

HALF_SPACE = REGIONS["one half space"]
EXACT = HALF_SPACE.exact  # 2.33e-4, for every direction of it
SETTINGS = EstimateSettings(drives=500, learn=400, batch=100)
NOTHING = Known(np.empty((0, 2)), np.empty(0), np.empty(0), np.empty(0, dtype=np.bool_))


def drawn(count: int, *parts: Part) -> Round:
    """A round from a tenth plain, a tenth wide, and parts."""
    mixture = guarded(parts, 2, plain=0.1, wide=0.1)
    points = drawn_from(mixture, count, np.random.default_rng(1))
    return Round(points, {"mixture": [each._asdict() for each in mixture]})


def test_the_estimate_agrees_with_the_closed_form_of_a_half_space() -> None:
    found = [HALF_SPACE.estimated(SETTINGS, seed) for seed in range(60)]
    values = np.array([each.value for each in found])
    spread = values.std(ddof=1)
    assert abs(values.mean() - EXACT) < 3.0 * spread / math.sqrt(len(found))  # unbiased
    assert spread < 0.25 * EXACT
    stated = math.sqrt(float(np.mean([each.deviation**2 for each in found])))
    assert stated == pytest.approx(spread, rel=0.3)  # the variance that it says is the variance that it has
    covers = sum(each.low <= EXACT <= each.high for each in found)
    assert covers >= 52  # of 60 at 95 %: fewer than 52 have the probability 0.002
    plain_spread = math.sqrt(EXACT * (1.0 - EXACT) / SETTINGS.drives)
    assert spread < 0.1 * plain_spread  # as many plain drives know a hundredth as much
    assert np.median([each.gain for each in found]) > 50.0


def test_a_plain_sample_has_the_variance_of_a_binomial() -> None:
    failed = np.arange(1000) % 50 == 0
    found = estimate(failed, np.ones(1000), np.zeros(1000), plain=1.0)
    assert found.value == pytest.approx(0.02)
    assert found.deviation == pytest.approx(math.sqrt(0.02 * 0.98 / 999))
    assert found.gain == pytest.approx(1.0, rel=0.01)
    assert found.low < 0.02 < found.high


def test_without_a_failure_the_upper_end_is_the_rule_of_three() -> None:
    found = estimate(np.zeros(300, dtype=np.bool_), np.ones(300), np.zeros(300), plain=1.0)
    assert (found.value, found.low, found.failures) == (0.0, 0.0, 0)
    assert found.high == pytest.approx(3.0 / 300, rel=0.01)  # Hanley and Lippman-Hand 1983
    assert estimate(np.zeros(300, dtype=np.bool_), np.ones(300), np.zeros(300), plain=0.1).high == pytest.approx(
        0.1, rel=0.01
    )


@pytest.mark.parametrize("name", ["two, equal", "two, 82 and 18 %", "two balls", "two, severity leads to one"])
def test_the_interval_covers_two_regions_as_often_as_it_says(name: str) -> None:
    region = REGIONS[name]
    found = [region.estimated(SETTINGS, seed) for seed in range(40)]
    covers = sum(each.low <= region.exact <= each.high for each in found)
    assert covers >= 34  # of 40 at 95 %: fewer than 34 have the probability 0.003
    assert np.mean([each.value for each in found]) == pytest.approx(region.exact, rel=0.1)


def test_an_estimate_without_a_failing_region_stays_open_above() -> None:
    found = REGIONS["none"].estimated(SETTINGS, 3)
    assert (found.value, found.failures, found.cautions) == (0.0, 0, ())
    assert found.high == found.unseen == pytest.approx(3.0 / 50, rel=0.01)


def test_too_few_drives_are_said_and_enough_are_not() -> None:
    few = EstimateSettings(drives=60, learn=60, batch=30)
    regions = [HALF_SPACE, REGIONS["two, equal"]]
    assert all(each.estimated(few, seed).cautions for each in regions for seed in range(10))
    assert not any(each.estimated(SETTINGS, seed).cautions for each in regions for seed in range(10))


def test_failures_where_none_was_expected_are_said() -> None:
    made = drawn(4000, Part(1.0, (3.5, 0.0), (1.0, 1.0)))
    both, one = (REGIONS[name].known([made]).failed > 0.5 for name in ("two balls", "one ball"))
    said = estimate(both, weights_of(made), guards_in(made), 0.1).cautions  # the second ball is elsewhere
    assert any("where none was expected" in each for each in said)
    covered = drawn(4000, Part(1.0, (2.6, 1.8), (1.0, 1.0)))
    one = REGIONS["one ball"].known([covered]).failed > 0.5
    assert estimate(one, weights_of(covered), guards_in(covered), 0.1).cautions == ()


def test_a_plain_sample_has_no_failures_out_of_place() -> None:
    proposer = CrossEntropy(EstimateSettings(drives=2000, batch=2000, plain=1.0), 2, 1)
    made = proposer.propose(0, [], NOTHING)
    assert np.allclose(weights_of(made), 1.0)
    assert not guards_in(made).any()


def test_each_cluster_of_failures_has_a_part_however_light_it_is() -> None:
    dice = np.random.default_rng(2)
    near, far = dice.normal((3.0, 0.0), 0.3, (20, 2)), dice.normal((-4.0, 0.0), 0.3, (20, 2))
    parts = parts_of(np.concatenate([near, far]), np.repeat([1.0, 0.01], 20))
    assert sum(each.share for each in parts) == pytest.approx(1.0)
    assert sum(each.share for each in parts if each.mean[0] < -3.0) > 0.1


def test_weights_are_bounded_and_their_mean_is_one() -> None:
    weights = weights_of(drawn(20000, Part(0.6, (1.5, -1.0), (0.5, 2.0)), Part(0.4, (-2.0, 0.0), (1.0, 1.0))))
    assert weights.max() <= 1.0 / 0.1
    assert weights.mean() == pytest.approx(1.0, abs=0.05)


def test_proposals_repeat_by_their_seed() -> None:
    settings = EstimateSettings(drives=20, learn=20, batch=10)
    assert repr(HALF_SPACE.estimated(settings, 5)) == repr(HALF_SPACE.estimated(settings, 5))
    one, other = (CrossEntropy(settings, 2, seed).propose(0, [], NOTHING).points for seed in (5, 6))
    assert not np.array_equal(one, other)
