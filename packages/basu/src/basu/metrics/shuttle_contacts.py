"""Contacts between two vehicles under test: each is counted once, and judged for each by the rule of fault.

Both records hold a contact of the two. The messages of both are taken together, in the order of their frames, and
brought into contacts as `basu.metrics.collisions` does it for one record. Each record tells the responsibility of
its own vehicle (`basu.metrics.fault`), so both can be at fault, or none.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from basu.metrics.collisions import is_separate
from basu.metrics.fault import responsibility

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from basu.metrics.infraction import Responsibility
    from basu.records.history import Collision, History


class Recorded(NamedTuple):
    """The record of one vehicle under test, and the numbers of the others in it."""

    history: History | None  # None where nothing was driven
    others: Mapping[int, int]  # the other vehicle's place in the run, and the number that this record gives it


class ShuttleContact(NamedTuple):
    """One contact of two vehicles under test."""

    tick: int  # of its first frame
    pair: tuple[int, int]  # places in the run
    blames: tuple[Responsibility | None, Responsibility | None]  # in this order; None where the drive was over before


def contacts_between(records: Sequence[Recorded]) -> list[ShuttleContact]:
    """Return the contacts of all pairs, the earliest first; the places in the run count from 0.

    Ticks count from the first frame of the run, which all its records share.
    """
    pairs = [(one, other) for one in range(len(records)) for other in range(one + 1, len(records))]
    found = [contact for pair in pairs for contact in _of_pair(records, pair)]
    return sorted(found, key=lambda contact: (contact.tick, contact.pair))


def _of_pair(records: Sequence[Recorded], pair: tuple[int, int]) -> Iterator[ShuttleContact]:
    """Yield the contacts of two vehicles."""
    one, other = pair
    events = (_events(records[one], other), _events(records[other], one))
    step_s = next((record.history.facts.step_s for record in records if record.history is not None), 0.0)
    contact: list[int] = []  # the ticks of the present one
    for tick in [*sorted({event.tick for side in events for event in side}), None]:
        if contact and (tick is None or is_separate(tick - contact[-1], step_s)):
            first, second = (
                _blame(records[place].history, [event for event in side if contact[0] <= event.tick <= contact[-1]])
                for place, side in zip(pair, events, strict=True)
            )
            yield ShuttleContact(contact[0], pair, (first, second))
            contact = []
        if tick is not None:
            contact.append(tick)


def _events(record: Recorded, other: int) -> list[Collision]:
    """Return the messages of contact with another vehicle under test in one record."""
    if record.history is None or other not in record.others:
        return []
    return [event for event in record.history.collisions if event.other_id == record.others[other]]


def _blame(history: History | None, events: Sequence[Collision]) -> Responsibility | None:
    """Return the responsibility for a contact by one record; None where it holds no message of it."""
    return None if history is None or not events else responsibility(history, events[0])
