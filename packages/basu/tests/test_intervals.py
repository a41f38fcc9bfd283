"""Claims about intervals and tests: published values, and coverage by simulation."""

import math

import numpy as np
import pytest

from basu.intervals import binomial_tail, bootstrap, clopper_pearson, fair_coin, mcnemar, sign_test, wilson


@pytest.mark.parametrize(
    ("successes", "trials", "low", "high"),
    [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)],
)
def test_wilson_agrees_with_newcombe_1998_table_1(successes: int, trials: int, low: float, high: float) -> None:
    found = wilson(successes, trials)
    assert (found.low, found.high) == (pytest.approx(low, abs=5e-5), pytest.approx(high, abs=5e-5))


@pytest.mark.parametrize(
    ("successes", "trials", "low", "high"),
    [(81, 263, 0.2527, 0.3676), (15, 148, 0.0578, 0.1617), (0, 20, 0.0, 0.1684), (1, 29, 0.0009, 0.1776)],
)
def test_clopper_pearson_agrees_with_newcombe_1998_table_1(
    successes: int, trials: int, low: float, high: float
) -> None:
    found = clopper_pearson(successes, trials)
    assert (found.low, found.high) == (pytest.approx(low, abs=5e-5), pytest.approx(high, abs=5e-5))


@pytest.mark.parametrize("rate", [0.02, 0.3, 0.9])
def test_the_exact_interval_covers_at_least_as_often_as_it_says(rate: float) -> None:
    trials = 40
    covers = [clopper_pearson(k, trials).low <= rate <= clopper_pearson(k, trials).high for k in range(trials + 1)]
    share = sum(
        binomial_tail(k, trials, rate) - binomial_tail(k + 1, trials, rate) for k in range(trials + 1) if covers[k]
    )
    assert share >= 0.95


def test_no_trials_say_nothing() -> None:
    for interval in (wilson(0, 0), clopper_pearson(0, 0)):
        assert math.isnan(interval.value)
        assert (interval.low, interval.high) == (0.0, 1.0)


def test_the_bootstrap_finds_the_standard_error_of_a_mean() -> None:
    values = np.random.default_rng(4).normal(3.0, 2.0, 400)
    found = bootstrap(np.append(values, np.nan))
    assert found.value == pytest.approx(values.mean())
    assert found.width == pytest.approx(2.0 * 1.96 * values.std() / 20.0, rel=0.1)
    assert found == bootstrap(np.append(values, np.nan))


def test_mcnemar_and_the_sign_test_count_discordant_pairs() -> None:
    first = np.array([True] * 9 + [False] * 2 + [True] * 5)
    second = np.array([False] * 8 + [True] * 3 + [True] * 5)
    found = mcnemar(first, second)
    assert (found.pairs, found.first_only, found.second_only) == (16, 8, 2)
    assert found.p_value == pytest.approx(2 * (45 + 10 + 1) / 1024)  # binomial coefficients of 10
    scores = sign_test(np.array([1.0, 2.0, 3.0, np.nan, 5.0]), np.array([0.0, 2.0, 1.0, 1.0, 1.0]))
    assert (scores.pairs, scores.first_only, scores.second_only) == (4, 3, 0)
    assert scores.p_value == pytest.approx(0.25)


def test_a_fair_coin_is_never_surprised_by_nothing() -> None:
    assert fair_coin(0, 0) == fair_coin(5, 5) == 1.0


@pytest.mark.parametrize(
    ("trials", "caution", "is_shown"),
    [(0, "", False), (1, "one drive: no interval", False), (19, "only 19 drives", True), (20, "", True)],
)
def test_few_trials_carry_a_caution_and_one_has_no_interval(trials: int, caution: str, is_shown: object) -> None:
    for found in (wilson(trials, trials), clopper_pearson(trials, trials), bootstrap(np.ones(trials))):
        assert (found.caution, found.is_shown) == (caution, is_shown)
