"""Collisions while a drive lasts: the same contacts as ``collisions`` finds, each message looked at once or twice."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from basu.metrics.collisions import Party, contacts

if TYPE_CHECKING:
    from collections.abc import Callable

    from basu.metrics.infraction import Evidence
    from basu.records.history import History

LATE_S = 1.0  # a message that comes later than this after its frame is judged at the end only


class CollisionsSoFar:
    """The contacts until now; ``pending`` holds those of the last second, which a late message may precede."""

    def __init__(self) -> None:
        self.settled: list[Evidence] = []
        self.pending: list[Evidence] = []
        self._latest: dict[Party, int] = {}
        self._first = 0  # messages before this tick are settled

    def look(self, window: Callable[[int], History]) -> None:
        """Take in what is new."""
        since = max(0, self._first - 1)  # the frame before a contact tells its speed
        history = window(since)
        settled = max(self._first, since + len(history.frames) - round(LATE_S / history.facts.step_s))
        fresh = [event for event in history.collisions if event.tick + since >= self._first]
        old = replace(history, collisions=tuple(event for event in fresh if event.tick + since < settled))
        new = replace(history, collisions=tuple(event for event in fresh if event.tick + since >= settled))
        self.settled += [replace(event, tick=event.tick + since) for event in contacts(old, self._latest)]
        self.pending = [replace(event, tick=event.tick + since) for event in contacts(new, dict(self._latest))]
        self._first = settled
