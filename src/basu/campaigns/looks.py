"""`Looks`: stops a campaign once each agent's confidence interval is narrow enough; checked after each complete block.

A look counts the rows of the first blocks and no others. So a campaign stops at the same drive with any number of
workers. Looking several times makes an interval cover slightly less than it says. Source: Frey 2010, "Fixed-width
sequential confidence intervals for a proportion", The American Statistician 64(3). ``least`` keeps early looks out.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

from basu.intervals import wilson

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from basu.campaigns.settings import Until


class Looks:
    """The counts of complete blocks, summed as far as there is no gap."""

    def __init__(self, until: Until | None, agents: Iterable[str], confidence: float, block: int) -> None:
        """Take the rule; without one no look ever stops a campaign."""
        self._until, self._agents, self._confidence, self._block = until, tuple(agents), confidence, block
        self._waiting: dict[int, Counter[tuple[str, str]]] = {}
        self._complete: set[int] = set()
        self._sum: Counter[tuple[str, str]] = Counter()
        self._summed = 0  # blocks in the sum
        self.stopped_after: int | None = None  # blocks; None while the question is open

    def is_answered(self) -> bool:
        """Whether a look has stopped the campaign."""
        return self.stopped_after is not None

    def count(self, row: Mapping[str, Any]) -> None:
        """Count a row of an open block."""
        if self._until is not None and row["judged"]:
            counts = self._waiting.setdefault(row["number"] // self._block, Counter())
            counts[row["agent"], "judged"] += 1
            counts[row["agent"], "success"] += bool(row["success"])

    def complete(self, block: int) -> None:
        """Mark a block as complete, and look wherever all blocks before are complete as well."""
        if self._until is None:
            return
        self._complete.add(block)
        while self._summed in self._complete and self.stopped_after is None:
            self._complete.remove(self._summed)
            self._sum += self._waiting.pop(self._summed, Counter())
            self._summed += 1
            if self._is_known():
                self.stopped_after = self._summed

    def _is_known(self) -> bool:
        """Whether every interval of the sum is narrow enough."""
        until = self._until
        assert until is not None, "there is no look without a rule"
        for agent in self._agents:
            judged = self._sum[agent, "judged"]
            if judged < until.least:
                return False
            if wilson(self._sum[agent, "success"], judged, self._confidence).width > until.width:
                return False
        return True
