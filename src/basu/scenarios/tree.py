"""The behaviour tree of a scenario (figure 4.4 of the thesis) and the base of its leaves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from py_trees.behaviour import Behaviour
from py_trees.common import Status
from py_trees.composites import Sequence as Steps
from py_trees.trees import BehaviourTree

if TYPE_CHECKING:
    from basu.scenarios.scenario import Scenario
    from basu.scenarios.stage import Stage


BROKEN_OFF = "broken off"  # the feedback of who was begins so


class Node(Behaviour):
    """What triggers and actions share: a stage, a first frame, and an end that is told in words."""

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


PHASES = ("setup", "trigger", "conflict", "resolution", "end")


class Composed(NamedTuple):
    """A scenario's tree and its phases by name, in the order in which they are passed."""

    root: BehaviourTree
    phases: dict[str, Behaviour]


def compose(scenario: Scenario) -> Composed:
    """The tree of a scenario, not yet set on a stage."""
    phases: dict[str, Behaviour] = {}
    for phase in PHASES:
        node = getattr(scenario, phase)()
        step = Steps(phase, memory=True, children=[] if node is None else [node])
        phases[phase] = step
    root = Steps(type(scenario).__name__, memory=True, children=list(phases.values()))
    return Composed(BehaviourTree(root), phases)


def set_on(composed: Composed, stage: Stage) -> None:
    """Give every node of a tree its stage."""
    composed.root.setup(stage=stage)
