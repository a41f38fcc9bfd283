"""Claims about table 1.1 as data."""

from basu.scenarios.nhtsa import PRINTED_TOTAL, TOLLS, Group, Toll


def test_there_are_nine_groups_and_the_projects_own() -> None:
    assert len(TOLLS) == 9
    assert set(Group) - set(TOLLS) == {Group.SHUTTLE}


def test_the_rows_add_up_to_the_printed_total_but_for_rounding() -> None:
    summed = Toll(*(sum(column) for column in zip(*TOLLS.values(), strict=True)))
    assert (summed.crashes, summed.fatal_crashes) == (PRINTED_TOTAL.crashes, PRINTED_TOTAL.fatal_crashes)
    assert abs(summed.cost_musd - PRINTED_TOTAL.cost_musd) <= 1
    assert abs(summed.equivalent_lives - PRINTED_TOTAL.equivalent_lives) <= 1


def test_the_printed_fatal_crashes_per_thousand_follow_from_the_rows() -> None:
    """The last column of the table, which the data leave out: a slip in a digit would show here."""
    printed = (9.5, 11.9, 0.3, 53.0, 10.8, 1.2, 32.3, 0.7, 3.5)
    for toll, per_thousand in zip(TOLLS.values(), printed, strict=True):
        assert abs(1000.0 * toll.fatal_crashes / toll.crashes - per_thousand) <= 0.051


def test_the_printed_costs_per_equivalent_life_are_one_figure() -> None:
    """Equivalent lives are the cost over the value of a life: about 9.146 million dollars in every row."""
    for toll in TOLLS.values():
        assert abs(toll.cost_musd / toll.equivalent_lives - 9.146) < 0.01
