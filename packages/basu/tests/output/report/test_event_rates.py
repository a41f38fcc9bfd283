"""Claims about rates of events: the units, the intervals, and what no event says."""

import pytest
from scipy.stats import poisson as distribution

from basu.intervals import poisson
from basu.output.report.event_rates import rate_text


@pytest.mark.parametrize(("events", "exposure"), [(1, 2.0), (7, 0.5), (120, 3.0)])
def test_at_each_end_of_the_interval_a_result_as_extreme_has_half_the_rest(events: int, exposure: float) -> None:
    found = poisson(events, exposure)
    assert distribution.sf(events - 1, found.low * exposure) == pytest.approx(0.025)
    assert distribution.cdf(events, found.high * exposure) == pytest.approx(0.025)
    assert found.value == events / exposure


def test_no_event_leaves_a_rate_of_three_over_the_way() -> None:
    found = poisson(0, 1.0)
    assert (found.value, found.low) == (0.0, 0.0)
    assert found.high == pytest.approx(3.689, abs=1e-3)


def test_both_units_are_of_the_same_way() -> None:
    text = rate_text(2, 1_609_344.0)  # 1,000 miles
    assert text.startswith("2; 1.24 per 1,000 km (")
    assert "2,000 per million miles (242 to 7,220)" in text


def test_without_a_way_there_is_no_rate() -> None:
    assert rate_text(0, 0.0) == "0, and no way was driven"
