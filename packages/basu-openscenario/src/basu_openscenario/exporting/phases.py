"""`phases_of`: divides each actor's motion in a rehearsal into parts, each with its trigger and the trigger's time.

A behaviour tree is a program, and a storyboard is a set of events. The triggers of the tree divide the motion of each
actor into parts. A part begins when its trigger comes true, whatever the ego did before.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from py_trees.common import ParallelPolicy
from py_trees.composites import Composite, Parallel

from basu.scenarios.actions import Action, Wait
from basu.scenarios.triggers import Trigger

if TYPE_CHECKING:
    from py_trees.behaviour import Behaviour

    from basu.testing import Rehearsal


@dataclass(frozen=True, slots=True)
class Guard:
    """A trigger of the tree, or several as one; times in s of the rehearsal."""

    node: Behaviour
    since_s: float
    """When the tree first evaluates the trigger."""
    at_s: float
    """When the trigger first holds."""
    before: Guard | None
    """The one that must come true first; None: the tree asks from the beginning."""


@dataclass(frozen=True, slots=True)
class Part:
    """A part of an actor's motion: from the moment of its guard, or from the beginning."""

    actor: str
    guard: Guard | None


@dataclass(frozen=True, slots=True)
class Phases:
    """The parts of all motions, and the guard of the tree's end."""

    parts: tuple[Part, ...]
    last: Guard | None
    unreached: tuple[str, ...]
    """The actions on actors that the rehearsal did not come to, by the names of their classes."""


def phases_of(played: Rehearsal) -> Phases:
    """Return the parts of the motions of a rehearsal."""
    walk = _Walk(played)
    last = walk.through(played.tree.root.root, None)
    return Phases(tuple(dict.fromkeys(walk.parts)), last, tuple(dict.fromkeys(walk.unreached)))


class _Walk:
    """A walk through a tree in the order in which it was played."""

    def __init__(self, played: Rehearsal) -> None:
        self.spans_s = played.spans_s
        self.parts: list[Part] = []
        self.unreached: list[str] = []

    def through(self, node: Behaviour, guard: Guard | None) -> Guard | None:
        """Note the parts below a node that begins behind ``guard``; return the guard of what comes after the node."""
        if is_trigger(node):
            return self._guard(node, guard)
        if isinstance(node, Parallel):
            ends = {child: self.through(child, guard) for child in node.children}
            return ends[self._deciding(node)] if ends else guard
        if isinstance(node, Composite):
            for child in node.children:
                guard = self.through(child, guard)
            return guard
        actor = getattr(node, "actor", None)
        if isinstance(node, Action) and actor is not None and not isinstance(node, Wait):
            if node in self.spans_s:
                self.parts.append(Part(actor, guard))
            else:
                self.unreached.append(type(node).__name__)
        return guard

    def _guard(self, node: Behaviour, before: Guard | None) -> Guard | None:
        """Return a trigger as a guard; the guard before it where the rehearsal ended first."""
        since_s, at_s = self.spans_s.get(node, (0.0, None))
        return before if at_s is None else Guard(node, since_s, at_s, before)

    def _deciding(self, node: Parallel) -> Behaviour:
        """Return the child that ended a parallel node: the last where all must end, otherwise the first that may."""
        policy = node.policy
        able = policy.children if isinstance(policy, ParallelPolicy.SuccessOnSelected) else node.children
        ended = [(span[1], child) for child in able if (span := self.spans_s.get(child)) and span[1] is not None]
        choose = max if isinstance(policy, ParallelPolicy.SuccessOnAll) else min
        return choose(ended, key=lambda one: one[0])[1] if ended else node.children[0]


def is_trigger(node: Behaviour) -> bool:
    """Return whether a node is a trigger, or a parallel node of triggers alone."""
    return isinstance(node, Trigger) or (
        isinstance(node, Parallel) and bool(node.children) and all(is_trigger(child) for child in node.children)
    )
