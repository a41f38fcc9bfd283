"""Claims about table 1.1 and the 37 pre-crash scenarios as data."""

from basu.scenarios.cases import open_library
from basu.scenarios.nhtsa import (
    BURDENS,
    OTHER_THOUSANDS,
    PRE_CRASH,
    PRINTED_TOTAL,
    STANDS_FOR,
    Burden,
    Group,
    stands_for,
)


def test_there_are_nine_groups_and_the_projects_own() -> None:
    assert len(BURDENS) == 9
    assert set(Group) - set(BURDENS) == {Group.SHUTTLE}


def test_the_rows_add_up_to_the_printed_total_but_for_rounding() -> None:
    summed = Burden(*(sum(column) for column in zip(*BURDENS.values(), strict=True)))
    assert (summed.crashes, summed.fatal_crashes) == (PRINTED_TOTAL.crashes, PRINTED_TOTAL.fatal_crashes)
    assert abs(summed.cost_musd - PRINTED_TOTAL.cost_musd) <= 1
    assert abs(summed.equivalent_lives - PRINTED_TOTAL.equivalent_lives) <= 1


def test_the_printed_fatal_crashes_per_thousand_follow_from_the_rows() -> None:
    """The last column of the table, which the data leave out: a slip in a digit would show here."""
    printed = (9.5, 11.9, 0.3, 53.0, 10.8, 1.2, 32.3, 0.7, 3.5)
    for burden, per_thousand in zip(BURDENS.values(), printed, strict=True):
        assert abs(1000.0 * burden.fatal_crashes / burden.crashes - per_thousand) <= 0.051


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
