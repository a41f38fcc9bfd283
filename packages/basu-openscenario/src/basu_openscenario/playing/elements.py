"""The elements of a storyboard and their states: standby, running, complete; each transition is noted."""

from __future__ import annotations

import enum
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from basu_openscenario.playing.triggers import RunningTrigger


class State(enum.Enum):
    """The state of an element; the values are the words of the standard."""

    INIT = "initState"
    STANDBY = "standbyState"
    RUNNING = "runningState"
    COMPLETE = "completeState"


Listener = Callable[["Element", State, str], None]
"""Called with an element, its new state and the transition that leads there."""


class Element:
    """An element of the storyboard. Its state follows from triggers, from its children, and from their ends."""

    kind = "element"

    def __init__(self, name: str, children: Sequence[Element] = ()) -> None:
        """Take name and children; the element is not in standby yet."""
        self.name = name
        self.path = name
        self.children = list(children)
        self.parent: Element | None = None
        self.state = State.INIT
        self.start_trigger: RunningTrigger | None = None
        self.stop_trigger: RunningTrigger | None = None
        self.listeners: list[Listener] = []
        self.executions = 0
        for child in self.children:
            child.parent = self

    def name_paths(self, prefix: str = "") -> None:
        """Give this element and all below it their full names, with ``::`` between levels."""
        self.path = f"{prefix}{self.name}"
        inside = "" if self.kind == "storyboard" else f"{self.path}::"
        for child in self.children:
            child.name_paths(inside)

    def all(self) -> list[Element]:
        """Return this element and all below it."""
        return [self, *(inside for child in self.children for inside in child.all())]

    def change(self, state: State, transition: str) -> None:
        """Go to another state, and tell all listeners."""
        if state is self.state:
            return
        self.state = state
        for listener in self.listeners:
            listener(self, state, transition)

    def start(self) -> None:
        """Go to standby where a trigger is to be awaited, otherwise begin to run with all children."""
        if self.state is State.INIT and self.start_trigger is not None:
            self.change(State.STANDBY, "")
        else:
            self.change(State.RUNNING, "startTransition")
            self.executions += 1
        if self.state is State.RUNNING:
            self.begin()

    def begin(self) -> None:
        """Start the children; an element with its own rule overrides this."""
        for child in self.children:
            child.start()

    def check_triggers(self) -> None:
        """Check the triggers of this element and of all below it that run."""
        if self.state is State.RUNNING and self.stop_trigger is not None and self.stop_trigger.check():
            self.stop()
        if self.state is State.STANDBY and (self.start_trigger is None or self.start_trigger.check()):
            self.start()
        if self.state is State.RUNNING:
            for child in self.children:
                child.check_triggers()

    def step(self) -> None:
        """Advance the running elements by a step."""
        if self.state is State.RUNNING:
            for child in list(self.children):
                child.step()

    def stop(self) -> None:
        """Stop this element and all below it."""
        for child in self.children:
            child.stop()
        if self.state in {State.INIT, State.COMPLETE}:
            return
        self.change(State.COMPLETE, "stopTransition")
        self._tell_parent()

    def end(self) -> None:
        """End regularly: complete, or in standby again where it may be executed once more."""
        if self.state is State.COMPLETE:
            return
        for child in self.children:
            if child.state is State.RUNNING:
                child.end()
        if self.state not in {State.RUNNING, State.STANDBY}:
            return
        if self.may_repeat:
            for trigger in (self.start_trigger, self.stop_trigger):
                if trigger is not None:
                    trigger.reset()
            self.change(State.STANDBY, "endTransition")
            for child in self.children:
                child.reset()
        else:
            self.change(State.COMPLETE, "endTransition")
        self._tell_parent()

    @property
    def may_repeat(self) -> bool:
        """Whether it may be executed again."""
        return False

    def _tell_parent(self) -> None:
        """Let the parent end where all its children are complete."""
        parent = self.parent
        if parent is None or parent.kind == "storyboard" or parent.state is State.COMPLETE:
            return
        if all(child.state is State.COMPLETE for child in parent.children):
            parent.end()

    def reset(self) -> None:
        """Make ready for another execution, with all below it."""
        for child in self.children:
            child.reset()
        self.state = State.INIT
        for trigger in (self.start_trigger, self.stop_trigger):
            if trigger is not None:
                trigger.reset()


class StoryElement(Element):
    """A story, an act or a manoeuvre."""

    def __init__(self, kind: str, name: str, children: Sequence[Element]) -> None:
        """Take the kind as the standard names it."""
        super().__init__(name, children)
        self.kind = kind


class RepeatedElement(StoryElement):
    """A group of manoeuvres or an event: executed up to ``most`` times; None: without a limit."""

    def __init__(self, kind: str, name: str, children: Sequence[Element], most: int | None) -> None:
        """Take the largest number of executions."""
        super().__init__(kind, name, children)
        self.most = most

    @property
    def may_repeat(self) -> bool:
        """Whether executions are left."""
        return self.most is None or self.executions < self.most


class EventElement(RepeatedElement):
    """An event: its priority decides about other events of its manoeuvre."""

    def __init__(self, name: str, children: Sequence[Element], most: int | None, priority: str) -> None:
        """Take the priority: ``override``, ``skip`` or ``parallel``."""
        super().__init__("event", name, children, most)
        self.priority = priority

    def start(self) -> None:
        """Go to standby first; then start, unless it runs already, or another one runs and it skips."""
        if self.state is State.INIT:
            self.change(State.STANDBY, "")
            return
        assert self.parent is not None, "an event belongs to a manoeuvre"
        running = [one for one in self.parent.children if one.state is State.RUNNING]
        if self.state is State.RUNNING or (self.priority == "skip" and running):
            return
        if self.priority == "override":
            for one in running:
                one.end()
        super().start()

    def begin(self) -> None:
        """Start the actions; an event without any ends at once."""
        if not self.children:
            self.end()
        for child in list(self.children):
            child.start()
