"""What conditions compare: time, variables, signals, and the states of the storyboard's elements."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu_openscenario.playing.elements import State
from basu_openscenario.playing.transition import SMALL

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu_openscenario.playing.elements import Element
    from basu_openscenario.playing.world import World
    from basu_openscenario.reading.conditions import ByElement, BySignal, BySignalController, ByTime, ByVariable
    from basu_openscenario.reading.scenario_file import SignalController


def compared(value: float, rule: str, limit: float) -> bool:
    """Return whether a number stands in a relation to a limit; numbers closer than 1e-6 are equal, as in esmini."""
    if rule == "greaterThan":
        return value > limit + SMALL
    if rule == "greaterOrEqual":
        return value >= limit - SMALL
    if rule == "lessThan":
        return value < limit - SMALL
    if rule == "lessOrEqual":
        return value <= limit + SMALL
    return (abs(value - limit) < SMALL) == (rule == "equalTo")


class TimeTest:
    """Compares the simulated time."""

    def __init__(self, test: ByTime) -> None:
        """Take rule and time in s."""
        self.test = test

    def holds(self, time_s: float) -> bool:
        """Return whether the time stands in the relation."""
        return compared(time_s, self.test.rule, self.test.value)


class VariableTest:
    """Compares a variable or a parameter: as numbers where both are numbers, otherwise as words."""

    def __init__(self, test: ByVariable, world: World) -> None:
        """Take name, rule and value."""
        self.test, self.world = test, world

    def holds(self, _: float) -> bool:
        """Return whether the variable stands in the relation."""
        rule, left, right = self.test.rule, self.world.variables[self.test.name], self.test.value
        try:
            return compared(float(left), rule, float(right))
        except ValueError:
            results = {
                "equalTo": left == right,
                "notEqualTo": left != right,
                "greaterThan": left > right,
                "lessThan": left < right,
                "greaterOrEqual": left >= right,
                "lessOrEqual": left <= right,
            }
            return results[rule]


class ElementTest:
    """Compares the state of elements of the storyboard, or waits for one of their transitions."""

    def __init__(self, test: ByElement, elements: Sequence[Element]) -> None:
        """Listen to the elements that the condition means."""
        self.test = test
        self.news: list[tuple[State, str]] = []
        self.last = State.INIT
        for element in elements:
            element.listeners.append(self._note)

    def _note(self, _: Element, state: State, transition: str) -> None:
        """Take a change of state."""
        self.news.append((state, transition))

    def holds(self, _: float) -> bool:
        """Return whether a change since the last check leads to the state; without a change, whether it lasts."""
        if not self.news:
            return self.last.value == self.test.state
        found = any(self.test.state in {state.value, transition} for state, transition in self.news)
        self.last = self.news[-1][0]
        self.news.clear()
        return found


class SignalTest:
    """Compares what a signal shows."""

    def __init__(self, test: BySignal, world: World) -> None:
        """Take signal and state."""
        self.test, self.world = test, world

    def holds(self, time_s: float) -> bool:
        """Return whether the signal shows this state."""
        return signal_state(self.world, self.test.signal, time_s) == self.test.state


class SignalControllerTest:
    """Compares the phase of a controller of signals."""

    def __init__(self, test: BySignalController, world: World) -> None:
        """Take controller and phase."""
        self.test, self.world = test, world

    def holds(self, time_s: float) -> bool:
        """Return whether the controller is in this phase."""
        for controller in self.world.controllers:
            if controller.name == self.test.controller:
                return controller.phases[phase_of(self.world, controller, time_s)].name == self.test.phase
        return False


def phase_of(world: World, controller: SignalController, time_s: float) -> int:
    """Return which phase of a controller is on: cycles begin at 0 s, or where an action began a phase."""
    durations = [phase.duration_s for phase in controller.phases]
    into_s = time_s - _delay(world, controller)
    begun = world.phases.get(controller.name)
    if begun is not None:
        before = [phase.name for phase in controller.phases].index(begun[0])
        into_s = time_s - begun[1] + sum(durations[:before])
    into_s %= sum(durations)
    for nth, duration_s in enumerate(durations):
        if into_s < duration_s - SMALL:
            return nth
        into_s -= duration_s
    return len(durations) - 1


def _delay(world: World, controller: SignalController) -> float:
    """Return how much later than the reference's the cycle of a controller begins, through references of references."""
    by_name = {one.name: one for one in world.controllers}
    delay_s, seen = 0.0, set()
    current: SignalController | None = controller
    while current is not None and current.name not in seen:
        seen.add(current.name)
        delay_s += current.delay_s if current.reference else 0.0
        current = by_name.get(current.reference or "")
    return delay_s


def signal_state(world: World, signal: str, time_s: float) -> str:
    """Return what a signal shows: what an action has set, otherwise what its controller's phase says; empty if none."""
    if signal in world.signals:
        return world.signals[signal]
    for controller in world.controllers:
        states = controller.phases[phase_of(world, controller, time_s)].states
        if signal in states:
            return states[signal]
    return ""
