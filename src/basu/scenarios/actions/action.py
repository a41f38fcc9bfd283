"""What a scenario does: each RUNNING until it is done, then SUCCESS; one that is broken off lets go of what it held."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from basu.scenarios.triggers.trigger import BROKEN_OFF

if TYPE_CHECKING:
    from basu.scenarios.stage import Stage


class Action(Behaviour):
    """The base of all: ``begin`` once, ``act`` each frame until it says in words what is done, ``leave`` once."""

    stage: Stage

    def setup(self, **kwargs: Any) -> None:  # noqa: ANN401 - py_trees' signature
        """Take the stage."""
        self.stage = kwargs["stage"]

    def initialise(self) -> None:
        """Begin."""
        self.feedback_message = ""
        self.begin()

    def update(self) -> Status:
        """Act."""
        words = self.act()
        if words is None:
            return Status.RUNNING
        self.feedback_message = words
        return Status.SUCCESS

    def terminate(self, new_status: Status) -> None:
        """Leave, once: done, or broken off by others."""
        if self.status == Status.RUNNING and new_status == Status.INVALID:
            self.feedback_message = f"{BROKEN_OFF} after {self.stage.time_s:.1f} s"
        if self.status == Status.RUNNING or new_status == Status.SUCCESS:
            self.leave(broken_off=new_status == Status.INVALID)

    def begin(self) -> None:
        """What happens in the first frame before ``act``; nothing for most."""

    def act(self) -> str | None:
        """Do what belongs to this frame; say what is done, in words with figures, or None until then."""
        raise NotImplementedError

    def leave(self, *, broken_off: bool) -> None:
        """What is handed back in the last frame; nothing for most."""
