"""Lane invasions: how often a marking was crossed. Reported, never scored (section 5.2.2 of the thesis)."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from basu.records.history import History


class LaneInvasions(NamedTuple):
    """The count, and the count by what was crossed."""

    total: int
    by_marking: tuple[tuple[str, int], ...]  # `type/colour` and number, by name


def lane_invasions(history: History) -> LaneInvasions:
    """Count events, not corners: two corners over one line in one frame are one invasion."""
    by_marking = Counter(marking for event in history.lane_invasions for marking in sorted(set(event.markings)))
    return LaneInvasions(len(history.lane_invasions), tuple(sorted(by_marking.items())))
