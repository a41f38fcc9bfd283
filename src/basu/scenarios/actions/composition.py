"""How behaviours are put together: in turn, together, whichever comes first, meanwhile; and waiting."""

from __future__ import annotations

from typing import TYPE_CHECKING

from py_trees.common import ParallelPolicy
from py_trees.composites import Parallel, Sequence

from basu.scenarios.actions.action import Action

if TYPE_CHECKING:
    from py_trees.behaviour import Behaviour


class Wait(Action):
    """Let some seconds go by."""

    def __init__(self, seconds: float) -> None:
        super().__init__(f"wait {seconds:.3g} s")
        self.seconds = seconds

    def begin(self) -> None:
        """Look at the clock."""
        self.until_s = self.stage.time_s + self.seconds

    def act(self) -> str | None:
        """When the time is over."""
        return f"{self.seconds:.3g} s over" if self.stage.time_s >= self.until_s - 1e-6 else None


class InTurn(Sequence):
    """One after another, each from the frame in which the one before it is done."""

    def __init__(self, *steps: Behaviour, name: str = "in turn") -> None:
        super().__init__(name, memory=True, children=list(steps))


class Together(Parallel):
    """All at once, until all are done."""

    def __init__(self, *parts: Behaviour, name: str = "together") -> None:
        super().__init__(name, ParallelPolicy.SuccessOnAll(synchronise=True), children=list(parts))


class Either(Parallel):
    """All at once, until one is done; the others are broken off."""

    def __init__(self, *parts: Behaviour, name: str = "whichever comes first") -> None:
        super().__init__(name, ParallelPolicy.SuccessOnOne(), children=list(parts))


class Meanwhile(Parallel):
    """All at once, until the first of them is done; the others are broken off then, or are done before."""

    def __init__(self, until: Behaviour, *others: Behaviour, name: str = "") -> None:
        super().__init__(
            name or f"until {until.name}",
            ParallelPolicy.SuccessOnSelected([until], synchronise=True),
            children=[until, *others],
        )
