"""The base of actions at work, and the domains that they control."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

from basu.errors import ScenarioError
from basu_openscenario.playing.elements import Element, State
from basu_openscenario.reading.xml_node import at_line

if TYPE_CHECKING:
    from basu_openscenario.playing.mover import Mover
    from basu_openscenario.playing.world import World

ALONG, ASIDE = frozenset({"longitudinal"}), frozenset({"lateral"})
BOTH, NEITHER = ALONG | ASIDE, frozenset[str]()


class RunningAction(Element, ABC):
    """An action of one entity or of the world. It controls domains of an entity's motion while it runs."""

    kind = "action"
    domains: frozenset[str] = NEITHER

    def __init__(self, name: str, world: World, mover: Mover | None) -> None:
        """Take the world and the entity; None: an action on the world."""
        super().__init__(name)
        self.world, self._mover = world, mover
        self.line = str(world.network.path)
        """The file and the line of the action, for sentences."""

    @property
    def mover(self) -> Mover:
        """The entity of a private action."""
        assert self._mover is not None, "a private action has an entity"
        return self._mover

    @property
    def is_running(self) -> bool:
        """Whether it runs."""
        return self.state is State.RUNNING

    def begin(self) -> None:
        """End what controls the same domains of the same entity, then begin."""
        if self._mover is not None:
            for other in self.world.running(self._mover):
                if other is not self and other.domains & self.domains:
                    other.end()
            self.world.acting.setdefault(self._mover.name, []).append(self)
        try:
            self.prepare()
        except ScenarioError as error:
            raise at_line(self.line, error) from error

    def step(self) -> None:
        """Work for a step, and end where that was the last."""
        if self.state is State.RUNNING and self.work(self.world.step_s):
            self.end()

    def prepare(self) -> None:
        """Take what is true when the action begins."""

    @abstractmethod
    def work(self, step_s: float) -> bool:
        """Do a step; return whether the action is over."""


class AtOnce(RunningAction, ABC):
    """An action that is done when it begins, and over in the same step."""

    @abstractmethod
    def prepare(self) -> None:
        """Do it."""

    def work(self, step_s: float) -> bool:
        """Return that the action is over."""
        del step_s
        return True
