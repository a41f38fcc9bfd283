"""The base of what a scenario waits for: RUNNING until it has come true, then SUCCESS."""

from __future__ import annotations

from basu.scenarios.node import Node
from basu.scenarios.stage import EGO


def named(who: str) -> str:
    """What the tree calls somebody."""
    return "ego" if who == EGO else who


class Trigger(Node):
    """Asks ``has_come`` each frame, which says in words what has come true, or None."""

    def has_come(self) -> str | None:
        """What has come true, in words; None until then."""
        raise NotImplementedError

    def done(self) -> str | None:
        """Ask."""
        return self.has_come()
