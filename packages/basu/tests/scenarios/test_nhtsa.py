"""Claims about table 1.1 and the 37 pre-crash scenarios as data."""

import pytest

from basu.scenarios.cases import open_library
from basu.scenarios.nhtsa import (
    BURDENS,
    OTHER_THOUSANDS,
    PRE_CRASH,
    PRINTED_SUMS,
    STANDS_FOR,
    TABLE_1_1,
    Group,
    YearlyStatistics,
    stands_for,
)


def test_there_are_nine_groups_and_the_projects_own() -> None:
    assert len(BURDENS) == 9
    assert set(Group) - set(BURDENS) == {Group.SHUTTLE}


def test_the_rows_of_table_1_1_add_up_to_its_printed_sums_but_for_rounding() -> None:
    """Four printed sums are off by 1: both columns of involved crashes, the costs, and the equivalent lives."""
    summed = YearlyStatistics(*(sum(column) for column in zip(*TABLE_1_1.values(), strict=True)))
    exact = ("fatal_crashes", "crashes", "per_1e9_miles")
    assert {name: getattr(summed, name) for name in exact} == {name: getattr(PRINTED_SUMS, name) for name in exact}
    for name in ("involved_fatal_crashes", "involved_crashes", "cost_musd", "equivalent_lives"):
        assert abs(getattr(summed, name) - getattr(PRINTED_SUMS, name)) <= 1
    assert summed.fatal_per_1e9_miles == pytest.approx(PRINTED_SUMS.fatal_per_1e9_miles)


@pytest.mark.parametrize("row", [*TABLE_1_1.values(), PRINTED_SUMS])
def test_the_rates_of_table_1_1_follow_from_its_counts(row: YearlyStatistics) -> None:
    """A slip in a digit would show here. The miles are those by which all crashes have their rate: 2.706e12 a year."""
    assert abs(1000.0 * row.fatal_crashes / row.crashes - row.fatal_per_thousand) <= 0.051
    assert abs(row.fatal_crashes / 2_706.0 - row.fatal_per_1e9_miles) <= 0.051
    assert abs(row.crashes / 2_706.0 - row.per_1e9_miles) <= 0.51


@pytest.mark.parametrize("row", [*TABLE_1_1.values(), PRINTED_SUMS])
def test_a_light_vehicle_makes_the_critical_action_in_some_of_the_crashes_that_involve_one(
    row: YearlyStatistics,
) -> None:
    assert row.fatal_crashes <= row.involved_fatal_crashes
    assert row.crashes <= row.involved_crashes


def test_the_printed_costs_per_equivalent_life_are_one_figure() -> None:
    """Equivalent lives are the cost over the value of a life: about 9.146 million dollars in every row."""
    for burden in BURDENS.values():
        assert abs(burden.cost_musd / burden.equivalent_lives - 9.146) < 0.01


def test_the_37_pre_crash_scenarios_sum_to_the_crashes_of_2004() -> None:
    assert sorted(PRE_CRASH) == list(range(1, 37))
    assert sum(kind.thousands for kind in PRE_CRASH.values()) + OTHER_THOUSANDS == 5_942


def test_the_printed_percentages_follow_from_the_counts() -> None:
    """The percentages of table 13, which the data leave out: a slip in a digit would show here."""
    printed = {2: 1.73, 3: 8.9, 4: 4.27, 10: 5.13, 12: 0.66, 18: 5.69, 21: 2.08, 25: 7.2, 26: 16.41, 30: 4.44, 31: 7.32}
    for number, percent in printed.items():
        assert abs(100.0 * PRE_CRASH[number].thousands / 5_942 - percent) < 0.02


def test_every_scenario_of_basu_stands_for_scenarios_of_its_own_group() -> None:
    for scenario in open_library().scenarios:
        if scenario.group is Group.SHUTTLE:
            assert scenario.__name__ not in STANDS_FOR
            continue
        kinds = stands_for(scenario.__name__, scenario.group, scenario.pre_crash)
        assert kinds, scenario.__name__
        assert len(kinds) == len(scenario.pre_crash or STANDS_FOR[scenario.__name__])


def test_each_group_has_the_pre_crash_scenarios_of_the_typology() -> None:
    for group in BURDENS:
        assert any(kind.group is group for kind in PRE_CRASH.values())
