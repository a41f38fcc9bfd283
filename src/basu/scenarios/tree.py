"""A scenario as one behaviour tree: figure 4.4 of the thesis, with the five phases every scenario has."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from py_trees.composites import Sequence as Steps
from py_trees.trees import BehaviourTree

if TYPE_CHECKING:
    from py_trees.behaviour import Behaviour

    from basu.scenarios.scenario import Scenario
    from basu.scenarios.stage import Stage

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
