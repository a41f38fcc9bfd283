"""`Looks`: stops a campaign once each agent's confidence interval is narrow enough; checked after each complete block.

A look counts the distinct drives of the first blocks and no others (`basu.campaigns.evidence`). So a campaign stops at
the same drive with any number of workers. Looking several times makes an interval cover slightly less than it says.
Source: Frey 2010, "Fixed-width sequential confidence intervals for a proportion", The American Statistician 64(3).
``least`` keeps early looks out.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from basu.campaigns.evidence import AgentEvidence
from basu.intervals import wilson

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from basu.campaigns.settings import Until


class Looks:
    """The counts of complete blocks, summed as far as there is no gap."""

    def __init__(
        self,
        until: Until | None,
        agents: Iterable[str],
        confidence: float,
        rows_of: Callable[[int], Iterable[Mapping[str, Any]]],
    ) -> None:
        """Take the rule; without one no look ever stops a campaign. ``rows_of`` gives the rows of a complete block."""
        self._until, self._agents, self._confidence, self._rows_of = until, tuple(agents), confidence, rows_of
        self._complete: set[int] = set()
        self._evidence = AgentEvidence()
        self._summed = 0  # blocks in the evidence
        self.stopped_after: int | None = None  # blocks; None while the question is open

    def is_answered(self) -> bool:
        """Whether a look has stopped the campaign."""
        return self.stopped_after is not None

    def complete(self, block: int) -> None:
        """Mark a block as complete, and look wherever all blocks before are complete as well."""
        if self._until is None:
            return
        self._complete.add(block)
        while self._summed in self._complete and self.stopped_after is None:
            self._complete.remove(self._summed)
            for row in self._rows_of(self._summed):
                self._evidence.add(row)
            self._summed += 1
            if self._is_known():
                self.stopped_after = self._summed

    def _is_known(self) -> bool:
        """Whether every interval of the sum is narrow enough."""
        until = self._until
        assert until is not None, "there is no look without a rule"
        for agent in self._agents:
            judged, successes = self._evidence.of(agent)
            if judged < until.least or wilson(successes, judged, self._confidence).width > until.width:
                return False
        return True
