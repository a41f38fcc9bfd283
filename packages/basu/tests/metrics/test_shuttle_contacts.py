"""Claims about contacts between vehicles under test: counted once, in both records, and judged by each."""

from collections.abc import Sequence

import pytest

from basu.metrics.shuttle_contacts import Recorded, contacts_between
from basu.records.history import History
from fakes.drives import at, driven, hit

BUS = "vehicle.easymile.ez10"


def record(speeds_mps: Sequence[float], *contacts: tuple[int, int]) -> History:
    """A drive with contacts, each the tick and the number of the other in this record."""
    return driven(speeds_mps, collisions=tuple(hit(tick, BUS, other) for tick, other in contacts))


def test_a_contact_in_both_records_is_one_and_has_two_judgements() -> None:
    moving = Recorded(record(at(5.0, 10.0), (40, 7), (41, 7), (60, 7)), {1: 7})
    standing = Recorded(record(at(0.0, 10.0), (40, 2), (42, 2)), {0: 2})
    (contact,) = contacts_between([moving, standing])
    assert (contact.tick, contact.pair) == (40, (0, 1))
    first, second = contact.blames
    assert first is not None
    assert second is not None
    assert (first.at_fault, second.at_fault) == (True, False)


def test_contacts_are_separate_after_two_seconds_in_neither_record() -> None:
    one = Recorded(record(at(5.0, 20.0), (40, 7), (120, 7)), {1: 7})
    other = Recorded(record(at(5.0, 20.0), (80, 2)), {0: 2})
    assert [contact.tick for contact in contacts_between([one, other])] == [40]
    alone = Recorded(other.history, {})
    assert [contact.tick for contact in contacts_between([one, alone])] == [40, 120]


def test_a_record_without_the_contact_says_nothing() -> None:
    one = Recorded(record(at(5.0, 10.0), (40, 7)), {1: 7})
    (contact,) = contacts_between([one, Recorded(None, {0: 2})])
    assert contact.blames[1] is None
    assert contacts_between([Recorded(None, {1: 7}), Recorded(None, {0: 2})]) == []


@pytest.mark.parametrize("others", [{}, {1: 9}])
def test_other_parties_are_no_contact_of_the_two(others: dict[int, int]) -> None:
    one = Recorded(record(at(5.0, 10.0), (40, 7)), others)
    assert contacts_between([one, Recorded(record(at(5.0, 10.0)), {0: 2})]) == []


def test_each_pair_of_three_has_its_own_contacts_the_earliest_first() -> None:
    records = [
        Recorded(record(at(5.0, 10.0), (80, 1)), {1: 1, 2: 2}),
        Recorded(record(at(5.0, 10.0), (80, 1), (30, 2)), {0: 1, 2: 2}),
        Recorded(record(at(5.0, 10.0), (30, 5)), {0: 4, 1: 5}),
    ]
    assert [(each.tick, each.pair) for each in contacts_between(records)] == [(30, (1, 2)), (80, (0, 1))]
