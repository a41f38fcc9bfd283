"""Claims about the intervals of the crash-cost share: they cover as often as they say, with the library's cases."""

import numpy as np
import pytest
from numpy.typing import NDArray

from basu.intervals import Stratum, weighted
from basu.scenarios.cases import cases_of
from basu.scenarios.nhtsa import Group
from basu.scenarios.shares import CountedCase, crash_shares
from basu.scenarios.verdict import Verdict

DRAWS = 200


@pytest.fixture(scope="module")
def cases() -> list[CountedCase]:
    """All cases of the library, as passed ones."""
    playables = cases_of(("all",), ())
    return [
        CountedCase(each.case.name, each.case.type, Group(each.scenario.group), Verdict.SUCCESS, "", {})
        for each in playables
    ]


def covered(cases: list[CountedCase], rates: NDArray[np.float64], seed: int) -> float:
    """The share of draws in which the interval of the crash-cost share holds what the rates (N,) of the cases make."""
    dice, hits = np.random.default_rng(seed), 0
    truth = expected(cases, rates)
    for _ in range(DRAWS):
        passed = dice.random(len(cases)) < rates
        drawn = [
            case if is_passed else case._replace(verdict=Verdict.FAILURE)
            for case, is_passed in zip(cases, passed, strict=True)
        ]
        cost = crash_shares(drawn).cost
        assert cost is not None
        hits += cost.low <= truth + 1e-12 and truth <= cost.high + 1e-12
    return hits / DRAWS


def expected(cases: list[CountedCase], rates: NDArray[np.float64]) -> float:
    """The crash-cost share that the rates (N,) of the cases make: it is linear in them."""
    none = [case._replace(verdict=Verdict.FAILURE) for case in cases]
    if np.ptp(rates) == 0.0:
        return float(rates[0])
    names = [case.scenario for case in cases]
    total = 0.0
    for name in dict.fromkeys(names):
        inside = np.array([each == name for each in names])
        alone = [case if here else lost for case, lost, here in zip(cases, none, inside, strict=True)]
        cost = crash_shares(alone).cost
        assert cost is not None
        total += cost.share * float(rates[inside].mean())
    return total


@pytest.mark.parametrize("rate", [0.5, 0.8, 0.9, 0.95])
def test_intervals_cover_where_every_case_has_the_same_rate(cases: list[CountedCase], rate: float) -> None:
    assert len(cases) > 150
    assert covered(cases, np.full(len(cases), rate), seed=1) >= 0.94


@pytest.mark.parametrize("rate", [0.5, 0.8, 0.9, 0.95])
def test_intervals_cover_where_scenarios_have_rates_of_their_own(cases: list[CountedCase], rate: float) -> None:
    dice = np.random.default_rng(7)
    own = {name: dice.beta(4.0 * rate, 4.0 * (1.0 - rate)) for name in dict.fromkeys(case.scenario for case in cases)}
    assert covered(cases, np.array([own[case.scenario] for case in cases]), seed=2) >= 0.94


def test_a_scenario_without_a_failure_widens_the_interval() -> None:
    alone = weighted([Stratum(0.5, 50, 100), Stratum(0.5, 100_000, 100_000)])
    small = weighted([Stratum(0.5, 50, 100), Stratum(0.5, 2, 2)])
    assert small.value == alone.value == 0.75
    assert small.high - small.value > 1.5 * (alone.high - alone.value)


def test_what_is_not_covered_by_strata_counts_as_failed_for_certain() -> None:
    whole, half = weighted([Stratum(1.0, 8, 10)]), weighted([Stratum(0.5, 8, 10)])
    assert half[:3] == pytest.approx([end / 2.0 for end in whole[:3]])
    assert weighted([])[:3] == (0.0, 0.0, 0.0)
