"""What a scenario does: each RUNNING until it is done, then SUCCESS; one that is broken off lets go of what it held."""

from __future__ import annotations

from py_trees.common import Status

from basu.scenarios.node import Node


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
