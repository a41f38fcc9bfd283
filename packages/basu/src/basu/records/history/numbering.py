"""`Numbering`: numbers of the other actors in a record, which do not depend on the ids that the simulator gave them.

A simulator counts its ids for as long as it lives, as CARLA does. So the second run on one server has other ids
than the first. A record counts actors from 1, in the order in which it first names them.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from basu.records.history.model import History

SCENERY = 0
"""The id of what is no actor, in CARLA's events and in the record."""


class Numbering:
    """The numbers of one run's actors."""

    def __init__(self) -> None:
        self._numbers: dict[int, int] = {SCENERY: SCENERY}

    def of(self, actor_id: int) -> int:
        """Return the number of an actor by the simulator's id; an actor without one gets the next."""
        return self._numbers.setdefault(actor_id, len(self._numbers))

    def applied(self, history: History) -> History:
        """Return a record with numbers in the place of the simulator's ids: others first, then collisions."""
        others = history.others.copy()
        others["id"] = np.array([self.of(actor_id) for actor_id in others["id"].tolist()], dtype=np.uint32)
        collisions = [replace(event, other_id=self.of(event.other_id)) for event in history.collisions]
        facts = replace(
            history.facts,
            actor_types={self.of(key): value for key, value in history.facts.actor_types.items()},
            actor_sizes={self.of(key): value for key, value in history.facts.actor_sizes.items()},
        )
        ordered = sorted(collisions, key=lambda event: (event.tick, event.other_id, event.other_type, event.impulse_ns))
        return replace(history, facts=facts, others=others, collisions=tuple(ordered))
