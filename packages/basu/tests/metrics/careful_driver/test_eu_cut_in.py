"""Claims about the table of (EU) 2022/1426 on recorded cut-ins."""

import pytest

from basu.metrics.careful_driver.counterfactual import start
from basu.metrics.careful_driver.encounters import encounters
from basu.metrics.careful_driver.eu_cut_in import DIFFERENCES_KMH, OTHERS_S, STANDING_MPS2, STANDING_S, Demand, demand
from basu.records.history import History
from fakes.lane_conflicts import braking, cut_in, meeting, steady


def demanded(history: History) -> Demand | None:
    (found,) = (each for each in encounters(history) if each.is_contact)
    return demand(history, found, *start(history, found))


def test_the_rows_follow_from_two_brakings() -> None:
    """v / (2 * 2.4) + 0.16 s and v / (2 * 6.0) + 0.25 s."""
    for kmh, standing_s, others_s in zip(DIFFERENCES_KMH, STANDING_S, OTHERS_S, strict=True):
        assert standing_s == pytest.approx(kmh / 3.6 / (2.0 * STANDING_MPS2) + 0.16, abs=0.011)
        assert others_s == pytest.approx(kmh / 3.6 / 12.0 + 0.25, abs=0.011)


@pytest.mark.parametrize(("gap_m", "standing", "others"), [(4.0, False, False), (8.0, False, True), (14.0, True, True)])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_the_farther_a_cut_in_the_more_vehicles_have_to_avoid_it(
    *, gap_m: float, standing: bool, others: bool, side: float
) -> None:
    """At 18 km/h the table has 1.20 s and 0.66 s; the other is 0.3 m within the lane after 0.69 s."""
    found = demanded(meeting(steady(10.0), cut_in(10.0, 5.0, gap_m, side=side)))
    assert found is not None
    assert found.difference_kmh == pytest.approx(18.0)
    assert (found.standing_s, found.others_s) == (pytest.approx(1.204), pytest.approx(0.664))
    assert found.ttc_s == pytest.approx(gap_m / 5.0 - 0.7, abs=0.06)
    assert (found.standing, found.others) == (standing, others)


def test_driving_faster_than_the_limit_takes_no_cut_in_out_of_the_law() -> None:
    cheat = meeting(steady(16.0), cut_in(16.0, 5.0, 14.0), limit_mps=10.0)
    honest = meeting(steady(10.0), cut_in(10.0, 5.0, 14.0), limit_mps=10.0)
    found, expected = demanded(cheat), demanded(honest)
    assert found is not None
    assert expected is not None
    assert (found.standing, found.others) == (expected.standing, expected.others) == (True, True)


def test_what_the_table_does_not_have_is_not_judged() -> None:
    assert demanded(meeting(steady(10.0), cut_in(10.0, 8.0, 4.0))) is None  # 7 km/h
    assert demanded(meeting(steady(10.0), braking(10.0, 15.0, 4.0, 6.0))) is None
