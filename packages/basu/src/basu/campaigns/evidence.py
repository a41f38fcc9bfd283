"""Which drives of a campaign are independent evidence: equal drives under several seeds count once.

`AgentEvidence` counts rows one by one while a campaign runs. `basu.campaigns.conclusions.distinct` filters a whole
table of a finished one by the same columns; a test holds that both count alike.
"""

from __future__ import annotations

from collections import Counter
from hashlib import blake2b
from typing import TYPE_CHECKING, Any

from basu.campaigns.columns import VOLATILE

if TYPE_CHECKING:
    from collections.abc import Mapping

OWN = frozenset({"number", "id", "seed", "records_bytes", *VOLATILE})  # columns in which equal drives may differ
DIGEST_BYTES = 16


class AgentEvidence:
    """Judged drives and successes of each agent, without the repetitions of a drive under another seed."""

    def __init__(self) -> None:
        """Begin without a drive."""
        self._seen: set[bytes] = set()
        self._counts: Counter[tuple[str, str]] = Counter()

    def add(self, row: Mapping[str, Any]) -> None:
        """Count a row of the table of drives, unless the drive was not judged or an equal one is counted already."""
        if not row["judged"]:
            return
        key = _condition_and_outcome(row)
        if key not in self._seen:
            self._seen.add(key)
            self._counts[row["agent"], "judged"] += 1
            self._counts[row["agent"], "success"] += bool(row["success"])

    def of(self, agent: str) -> tuple[int, int]:
        """Return the numbers of distinct judged drives and of successes among them."""
        return self._counts[agent, "judged"], self._counts[agent, "success"]


def _condition_and_outcome(row: Mapping[str, Any]) -> bytes:
    """Return a digest of all columns in which equal drives agree; an absent column equals an empty one."""
    values = sorted((name, _plain(value)) for name, value in row.items() if name not in OWN and value is not None)
    return blake2b(repr(values).encode(), digest_size=DIGEST_BYTES).digest()


def _plain(value: object) -> str:
    """Return a value as text; a whole number equals its float, as a journal and a table of Parquet may differ in it."""
    return repr(float(value) if isinstance(value, int) and not isinstance(value, bool) else value)
