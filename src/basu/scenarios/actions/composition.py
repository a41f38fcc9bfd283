"""The base of actions, waiting, and the ways to put behaviours together: in turn, together, either, meanwhile."""

from __future__ import annotations

from typing import TYPE_CHECKING

from py_trees.common import ParallelPolicy, Status
from py_trees.composites import Parallel, Sequence

from basu.scenarios.tree import Node

if TYPE_CHECKING:
    from py_trees.behaviour import Behaviour


class Action(Node):
    """The base of all: ``begin`` once, ``act`` each frame until it says in words what is done, ``leave`` once."""

    def act(self) -> str | None:
        """Do what belongs to this frame; say what is done, in words with figures, or None until then."""
        raise NotImplementedError

    def leave(self, *, broken_off: bool) -> None:
        """What is handed back in the last frame; nothing for most."""

    def done(self) -> str | None:
        """Act."""
        return self.act()

    def terminate(self, new_status: Status) -> None:
        """Leave, once: done, or broken off by others."""
        super().terminate(new_status)
        if self.status == Status.RUNNING or new_status == Status.SUCCESS:
            self.leave(broken_off=new_status == Status.INVALID)


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
