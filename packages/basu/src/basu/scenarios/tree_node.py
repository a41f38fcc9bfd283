"""The base of all leaves of a scenario's behaviour tree: triggers and actions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from py_trees.behaviour import Behaviour
from py_trees.common import Status

if TYPE_CHECKING:
    from basu.scenarios.stage import Stage


BROKEN_OFF = "broken off"  # the first words of an aborted node's feedback


class Node(Behaviour):
    """The base of triggers and actions: a stage, a first frame, and an end with a feedback message."""

    stage: Stage

    def setup(self, **kwargs: Any) -> None:  # noqa: ANN401 - py_trees' signature
        """Take the stage."""
        self.stage = kwargs["stage"]

    def initialise(self) -> None:
        """Begin."""
        self.feedback_message = ""
        self.begin()

    def update(self) -> Status:
        """Ask what has come about."""
        words = self.done()
        if words is None:
            return Status.RUNNING
        self.feedback_message = words
        return Status.SUCCESS

    def terminate(self, new_status: Status) -> None:
        """Say so if others have put an end to it."""
        if self.status == Status.RUNNING and new_status == Status.INVALID:
            self.feedback_message = f"{BROKEN_OFF} after {self.stage.time_s:.1f} s"

    def begin(self) -> None:
        """What happens, or is remembered, in the first frame; nothing for most."""

    def done(self) -> str | None:
        """What has come about in this frame, in words with figures; None until then."""
        raise NotImplementedError
