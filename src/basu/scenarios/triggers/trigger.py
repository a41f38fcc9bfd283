"""The base of what a scenario waits for: RUNNING until it has come true, then SUCCESS."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from basu.scenarios.stage import EGO

if TYPE_CHECKING:
    from basu.scenarios.stage import Stage

BROKEN_OFF = "broken off"  # the feedback of who was begins so


def named(who: str) -> str:
    """What the tree calls somebody."""
    return "ego" if who == EGO else who


class Trigger(Behaviour):
    """Asks ``has_come`` each frame, which says in words what has come true, or None."""

    stage: Stage

    def setup(self, **kwargs: Any) -> None:  # noqa: ANN401 - py_trees' signature
        """Take the stage."""
        self.stage = kwargs["stage"]

    def initialise(self) -> None:
        """Begin to wait."""
        self.feedback_message = ""
        self.begin()

    def begin(self) -> None:
        """What is remembered from the first frame; nothing for most."""

    def has_come(self) -> str | None:
        """What has come true, in words; None until then."""
        raise NotImplementedError

    def update(self) -> Status:
        """Ask."""
        words = self.has_come()
        if words is None:
            return Status.RUNNING
        self.feedback_message = words
        return Status.SUCCESS

    def terminate(self, new_status: Status) -> None:
        """Say so if others have put an end to the waiting."""
        if self.status == Status.RUNNING and new_status == Status.INVALID:
            self.feedback_message = f"{BROKEN_OFF} after {self.stage.time_s:.1f} s"
