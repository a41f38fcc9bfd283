"""The storyboard of a case for CARLA's ScenarioRunner. Its conditions stay true once they have been true.

ScenarioRunner 0.9.16 differs from the standard in four ways (decision 0182 has the places in its code):

- A condition that was true once counts as true from then on. Two conditions of a group need not hold at the same time.
- It waits for a delay from the moment at which it first looks, and then asks whether the condition holds. The
  standard asks what held so long ago.
- It counts the time and the distance of a condition from the moment at which it first looks.
- It does not read the stop trigger of the storyboard. In that of an act, one condition of a group is enough.

The conditions of an act's events are first looked at when the act begins. So each group of conditions has an act of its
own. Conditions that stay true in the standard as well (a distance travelled, a time, a mark) begin the act. The others
begin its event, which sets a mark. A mark is a variable that becomes 1, and all that follows waits for it.
Each act ends when the mark ``ENDED`` is set. The file means the same in the standard.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from scenariogeneration import xosc

from basu.scenarios.stage import EGO
from basu_openscenario.exporting.conditions import ExportedTest, tests_of
from basu_openscenario.exporting.storyboard import AFTER_S, StoryboardWriter, group_of, trigger_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from basu_openscenario.exporting.conditions import RehearsedCase, Tests
    from basu_openscenario.exporting.motions import Motion
    from basu_openscenario.exporting.phases import Guard, Phases

ENDED = "ended"
"""The mark of the end of the case."""
STAYS_TRUE = (xosc.TraveledDistanceCondition, xosc.SimulationTimeCondition, xosc.VariableCondition)
"""The conditions that stay true once they are, as they are used here."""

ALWAYS = ExportedTest(EGO, xosc.SpeedCondition(-100.0, xosc.Rule.greaterThan))
"""A test that always holds. One for a mark of 0 would not: ScenarioRunner compares its first value as a text."""


class OrderedActsWriter(StoryboardWriter):
    """Writes a storyboard in which no condition that may become false again is looked at too early."""

    def __init__(self, case: RehearsedCase, phases: Phases) -> None:
        """Take the rehearsal and the phases of its tree."""
        super().__init__(case, phases)
        self.waits: dict[tuple[Guard, float], str] = {}
        """The mark that is set some time after a guard has come true, by the guard and the time in s."""
        self.longest_s = 0.0

    def acts(self, motions: Iterable[Sequence[Motion]]) -> list[xosc.Act]:
        """Return the acts that set marks, in the order of the rehearsal, then the act of the motions, then the end."""
        motions_and_lights = super().acts(motions)
        last = self.phases.last
        end = () if last is None else self._tests(last, float(self.case.played.times_s[-1]) - last.at_s)
        marking = self._marking_acts()
        ending = [self._act(f"the end {nth + 1}", group, ENDED) for nth, group in enumerate((*end, self._too_late()))]
        return [*marking, *motions_and_lights, *ending]

    def variables(self) -> list[xosc.Variable]:
        """Return the marks, which are 0 at the beginning."""
        names = [*self.markers.values(), *self.waits.values(), ENDED]
        return [xosc.Variable(name, xosc.ParameterType.int, "0") for name in names]

    def stop(self, longest_s: float) -> xosc.Trigger:
        """Return the trigger of the end, which is a mark."""
        self.longest_s = longest_s
        return trigger_of("the end", ((_set(ENDED),),), "stop")

    # events ------------------------------------------------------------------------------------------------------

    def _stop_of_act(self, name: str) -> xosc.Trigger:
        return trigger_of(f"end of {name}", ((_set(ENDED),),), "stop")

    def _marking_events(self) -> list[xosc.Event]:
        """Return no events, since marks are set in acts of their own."""
        return []

    def _begin(self, motion: Motion) -> Tests:
        """Return the tests for the begin of a motion, which waits for a mark."""
        if motion.late_s or motion.guard is None:
            return self._due(motion, 0.0)
        return ((self._marked(motion.guard, 0.0),),)

    def _tests(self, guard: Guard, later_s: float) -> Tests:
        return ((self._marked(guard, later_s if later_s > self.case.step_s else 0.0),),)

    def _marked(self, guard: Guard, later_s: float) -> ExportedTest:
        """Return the test whether a guard has come true so long ago, which is a mark of its own after a delay."""
        name = self.markers.setdefault(guard, f"trigger_{len(self.markers) + 1}")
        if later_s < AFTER_S:
            return _set(name)
        return _set(self.waits.setdefault((guard, round(later_s, 3)), f"wait_{len(self.waits) + 1}"))

    # marks -------------------------------------------------------------------------------------------------------

    def _marking_acts(self) -> list[xosc.Act]:
        """Return the acts that set marks; a guard may need the mark of the one before it, or a wait after that."""
        acts: list[tuple[float, xosc.Act]] = []
        guards: list[Guard] = []
        while len(guards) < len(self.markers):
            guard = list(self.markers)[len(guards)]
            guards.append(guard)
            name = self.markers[guard]
            for nth, group in enumerate(self._groups(guard)):
                acts.append((guard.at_s, self._act(f"{name}_{nth + 1}", group, name)))
        for (guard, later_s), name in self.waits.items():
            over = ExportedTest(None, _set(self.markers[guard]).condition, later_s)
            acts.append((guard.at_s + later_s, self._act(name, (_set(self.markers[guard]), over), name)))
        return [act for _, act in sorted(acts, key=lambda one: one[0])]

    def _groups(self, guard: Guard) -> Tests:
        """Return the tests of a guard, behind those of the guard before it."""
        first: tuple[ExportedTest, ...] = ()
        if guard.before is not None:
            first = (self._marked(guard.before, guard.since_s - guard.before.at_s),)
        elif guard.since_s >= AFTER_S:
            first = self._after(None, guard.since_s)[0]
        return tuple((*first, *group) for group in tests_of(guard.node, self.case))

    def _too_late(self) -> tuple[ExportedTest, ...]:
        """Return the test for the time limit."""
        return (ExportedTest(None, xosc.SimulationTimeCondition(self.longest_s, xosc.Rule.greaterOrEqual)),)

    def _act(self, name: str, tests: Sequence[ExportedTest], mark: str) -> xosc.Act:
        """Return the act that sets a mark when all tests hold at one time."""
        lasting = [one for one in tests if isinstance(one.condition, STAYS_TRUE) and not one.delay_s]
        others = [one for one in tests if one not in lasting]
        begin = lasting or [ExportedTest(None, xosc.SimulationTimeCondition(0.0, xosc.Rule.greaterOrEqual))]
        event = xosc.Event(f"{name} is noted", xosc.Priority.parallel)
        event.add_action(f"{mark} is set by {name}", xosc.VariableSetAction(mark, 1))
        event.add_trigger(trigger_of(f"{name} holds", (tuple(others or [ALWAYS]),)))
        start = trigger_of(f"{name} may come", (tuple(begin), (_set(ENDED),)))
        act = xosc.Act(name, start, self._stop_of_act(name))
        act.add_maneuver_group(group_of(EGO, [event], name=f"group of {name}"))
        return act


def _set(mark: str) -> ExportedTest:
    """Return the test whether a mark is set."""
    return ExportedTest(None, xosc.VariableCondition(mark, 1, xosc.Rule.equalTo))
