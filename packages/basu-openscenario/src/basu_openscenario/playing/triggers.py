"""Triggers at work: conditions with their edges and delays, in groups."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from basu.errors import ScenarioError
from basu_openscenario.playing.transition import SMALL
from basu_openscenario.reading.xml_node import at_line

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu_openscenario.reading.conditions import Condition


class Test(Protocol):
    """What a condition compares."""

    def holds(self, time_s: float) -> bool:
        """Return whether it is true at this time."""


class RunningCondition:
    """A condition with its memory: the value before, for edges, and the changes so far, for the delay."""

    def __init__(self, condition: Condition, test: Test) -> None:
        """Take the condition as its file has it, and what it compares."""
        self.condition, self.test = condition, test
        self.before = False
        self.was_checked = False
        self.changes: list[tuple[float, bool]] = []
        self.seen = 0
        """How many of the changes have come due."""

    def check(self, time_s: float) -> bool:
        """Return whether the condition is true now, after edge and delay."""
        result = self.test.holds(time_s)
        edge = self._edge(result=result)
        self.before, self.was_checked = result, True
        self._note(time_s, value=edge)
        return self._due(time_s - self.condition.delay_s)

    def _edge(self, *, result: bool) -> bool:
        """Return whether the change from the value before is the one that counts."""
        edge = self.condition.edge
        if edge == "none":
            return result
        rises, falls = result and not self.before, self.before and not result
        if not self.was_checked:
            return False
        return rises if edge == "rising" else falls if edge == "falling" else rises or falls

    def _note(self, time_s: float, *, value: bool) -> None:
        """Add a value to the changes where it differs from the one before."""
        if self.changes and time_s < self.changes[-1][0] + SMALL:
            self.changes[-1] = (self.changes[-1][0], value)
        elif not self.changes or value != self.changes[-1][1]:
            self.changes.append((time_s, value))

    def _due(self, time_s: float) -> bool:
        """Return whether a value that came due since the last check was true; otherwise the last one that is due."""
        found = False
        first = self.seen
        while self.seen < len(self.changes) and time_s > self.changes[self.seen][0] - SMALL:
            found = found or self.changes[self.seen][1]
            self.seen += 1
        if self.seen > first:
            return found
        return self.changes[self.seen - 1][1] if self.seen else False

    def reset(self) -> None:
        """Forget the changes, before another execution."""
        self.changes.clear()
        self.seen = 0


class RunningTrigger:
    """Groups of conditions: true where all conditions of one group are."""

    def __init__(self, groups: Sequence[Sequence[RunningCondition]], clock: Clock) -> None:
        """Take the groups, and the clock by which they are checked."""
        self.groups, self.clock = groups, clock

    def check(self) -> bool:
        """Return whether the trigger is true now; a trigger without groups is never true."""
        time_s = self.clock.time_s
        found = False
        for group in self.groups:
            good = bool(group)
            for one in group:
                if good or one.condition.delay_s > 0.0:  # others need not be looked at once the group is false
                    try:
                        good = one.check(time_s) and good
                    except ScenarioError as error:
                        raise at_line(one.condition.line, error) from error
            found = found or good
        if found:
            for one in (one for group in self.groups for one in group):
                one.was_checked = False
        return found

    def reset(self) -> None:
        """Forget what was seen, before another execution."""
        for one in (one for group in self.groups for one in group):
            one.reset()


class Clock(Protocol):
    """Something that knows the simulated time."""

    time_s: float
