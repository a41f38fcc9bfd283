"""The storyboard of a rehearsed case: events that wait for triggers, with trajectories, lights and departures."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scenariogeneration import xosc

from basu.errors import ScenarioError
from basu.scenarios.stage import EGO
from basu_openscenario.exporting.conditions import ExportedTest, tests_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from basu.scenarios.stage import Pose
    from basu_openscenario.exporting.conditions import RehearsedCase, Tests
    from basu_openscenario.exporting.motions import Motion
    from basu_openscenario.exporting.phases import Guard, Phases

REFUSED = {
    "disturb": "a disturbance of the ego's controls",
    "friction": "friction of a part of the road",
    "open door": "an open door",
    "weather": "weather that changes around the ego",
}
"""What a scenario may do to the world that a storyboard cannot, by the command of the stage."""
LIGHTS = {"Red": "on;off;off", "Yellow": "off;on;off", "Green": "off;off;on", "Off": "off;off;off"}
"""The lamps of a signal of type 1000001 from above, as esmini has them."""
PHASE = "phase"
"""The variable that names the last trigger that came true, for events that must wait for it."""
AFTER_S = 1e-4
"""A time that has come so nearly counts."""


class StoryboardWriter:
    """Writes the storyboard of a case."""

    def __init__(self, case: RehearsedCase, phases: Phases) -> None:
        """Take the rehearsal and the phases of its tree."""
        self.case, self.phases = case, phases
        self.markers: dict[Guard, str] = {}
        """The event that marks that a guard has come true, by the guard; made where another event asks for it."""
        self.begins_s: dict[str, float] = {}
        """When each event of a motion begins in the rehearsal, by its name."""

    def acts(self, motions: Iterable[Sequence[Motion]]) -> list[xosc.Act]:
        """Return the one act: a group of maneuvers for each actor that does something, and one for the world."""
        act = xosc.Act("the case", _at(0.0), self._stop_of_act("the case"))
        for parts in motions:
            events = [event for nth, motion in enumerate(parts) for event in self._events(motion, nth)]
            if events:
                act.add_maneuver_group(group_of(parts[0].actor, events))
        events = self._lights()
        events += self._marking_events()
        if events:
            act.add_maneuver_group(group_of(EGO, events, name="the world"))
        return [act]

    def variables(self) -> list[xosc.Variable]:
        """Return the variables that the events use; ask for them last."""
        return [xosc.Variable(PHASE, xosc.ParameterType.string, "begun")]

    def init(self, motions: Iterable[Sequence[Motion]], places: dict[str, Pose]) -> xosc.Init:
        """Return the first places, and the lights that are set in the first frame."""
        init = xosc.Init()
        for command in self._lights_at_once():
            init.add_global_action(xosc.TrafficSignalStateAction(str(command[0]), LIGHTS[str(command[1])]))
        first = {parts[0].actor: parts[0].points[0] for parts in motions if parts}
        for name, pose in places.items():
            yaw_rad = float(first[name][3]) if name in first else pose.yaw_rad
            init.add_init_action(name, xosc.TeleportAction(_position(pose.x_m, pose.y_m, yaw_rad)))
            step = xosc.TransitionDynamics(xosc.DynamicsShapes.step, xosc.DynamicsDimension.time, 0)
            init.add_init_action(name, xosc.AbsoluteSpeedAction(0, step))
        return init

    def stop(self, longest_s: float) -> xosc.Trigger:
        """Return the trigger of the end: the last one of the tree, or the time limit."""
        tests: Tests = ((ExportedTest(None, xosc.SimulationTimeCondition(longest_s, xosc.Rule.greaterOrEqual)),),)
        last = self.phases.last
        if last is not None:
            over_s = float(self.case.played.times_s[-1]) - last.at_s
            tests = (*self._tests(last, over_s), *tests)
        return trigger_of("the end", tests, "stop")

    # events ------------------------------------------------------------------------------------------------------

    def _events(self, motion: Motion, nth: int) -> list[xosc.Event]:
        """Return the events of a part of a motion: a trajectory, and what the actor does at its end."""
        name = f"{motion.actor} {nth + 1}"
        found = []
        if motion.moves or motion.put:
            event = xosc.Event(name, xosc.Priority.override)
            if motion.put:
                x_m, y_m, yaw_rad = (float(value) for value in motion.points[0, 1:])
                event.add_action(f"{name} put", xosc.TeleportAction(_position(x_m, y_m, yaw_rad)))
            if motion.moves:
                event.add_action(f"{name} moves", _following(name, motion.points))
            event.add_trigger(trigger_of(f"{name} begins", self._begin(motion)))
            self.begins_s[name] = motion.late_s + (0.0 if motion.guard is None else motion.guard.at_s)
            found.append(event)
        if motion.vanishes:
            event = xosc.Event(f"{name} leaves", xosc.Priority.parallel)
            event.add_action(f"{name} leaves the world", xosc.DeleteEntityAction(motion.actor))
            event.add_trigger(trigger_of(f"{name} is due to leave", self._due(motion, motion.length_s)))
            found.append(event)
        return found

    def _stop_of_act(self, _name: str) -> xosc.Trigger | None:
        """Return the trigger of an act's end; None: the act ends with the storyboard."""
        return None

    def _begin(self, motion: Motion) -> Tests:
        """Return the tests for the begin of a motion."""
        if motion.late_s or motion.guard is None:
            return self._due(motion, 0.0)
        return self._tests(motion.guard, 0.0)

    def _due(self, motion: Motion, later_s: float) -> Tests:
        """Return the tests for a moment after the begin of a motion."""
        return self._after(motion.guard, motion.late_s + later_s)

    def _after(self, guard: Guard | None, later_s: float) -> Tests:
        """Return the tests for a moment after a guard, or after the beginning."""
        if guard is None:
            return ((ExportedTest(None, xosc.SimulationTimeCondition(round(later_s, 3), xosc.Rule.greaterOrEqual)),),)
        return ((self._marked(guard, later_s),),)

    def _tests(self, guard: Guard, later_s: float) -> Tests:
        """Return the tests for a guard, which must come true after the one before it."""
        if later_s > self.case.step_s:
            return self._after(guard, later_s)
        tests = tests_of(guard.node, self.case)
        if guard.before is None:
            waited_s = guard.since_s
            first = () if waited_s < AFTER_S else self._after(None, waited_s)[0]
        else:
            first = (self._marked(guard.before, guard.since_s - guard.before.at_s),)
        return tuple((*first, *group) for group in tests)

    def _marked(self, guard: Guard, later_s: float) -> ExportedTest:
        """Return the test whether a guard has come true so long ago."""
        name = self.markers.setdefault(guard, f"trigger {len(self.markers) + 1}")
        done = xosc.StoryboardElementStateCondition(
            xosc.StoryboardElementType.event, name, xosc.StoryboardElementState.completeState
        )
        return ExportedTest(None, done, max(round(later_s, 3), 0.0))

    def _marking_events(self) -> list[xosc.Event]:
        """Return the events that mark guards; a guard may need that of the one before it."""
        found, written = [], 0
        while written < len(self.markers):
            guard, name = list(self.markers.items())[written]
            event = xosc.Event(name, xosc.Priority.parallel)
            event.add_action(f"{name} is noted", xosc.VariableSetAction(PHASE, guard.node.name))
            event.add_trigger(trigger_of(guard.node.name, self._tests(guard, 0.0)))
            found.append(event)
            written += 1
        return found

    # the world ----------------------------------------------------------------------------------------------------

    def _lights_at_once(self) -> list[tuple[object, ...]]:
        """Return the lights that are set in the first frame."""
        return [one.details for one in self.case.played.commands if one.what == "light" and one.time_s < AFTER_S]

    def _lights(self) -> list[xosc.Event]:
        """Return the events of the lights that are set later."""
        found = []
        for nth, command in enumerate(self.case.played.commands):
            if command.what in REFUSED:
                raise ScenarioError(f"{REFUSED[command.what]} has no counterpart in OpenSCENARIO")
            if command.what == "light" and command.time_s >= AFTER_S:
                event = xosc.Event(f"light {nth + 1}", xosc.Priority.parallel)
                landmark, state = str(command.details[0]), LIGHTS[str(command.details[1])]
                event.add_action(f"light {nth + 1} shows", xosc.TrafficSignalStateAction(landmark, state))
                guard = self._latest(command.time_s)
                later_s = command.time_s - (0.0 if guard is None else guard.at_s)
                event.add_trigger(trigger_of(f"light {nth + 1} is due", self._after(guard, later_s)))
                found.append(event)
        return found

    def _latest(self, time_s: float) -> Guard | None:
        """Return the last guard that had come true by a time."""
        guards = [
            one.guard for one in self.phases.parts if one.guard is not None and one.guard.at_s <= time_s + AFTER_S
        ]
        return max(guards, key=lambda one: one.at_s, default=None)


def group_of(actor: str, events: Sequence[xosc.Event], name: str = "") -> xosc.ManeuverGroup:
    """Return a group of one maneuver of an actor."""
    maneuver = xosc.Maneuver(f"maneuver of {name or actor}")
    for event in events:
        maneuver.add_event(event)
    group = xosc.ManeuverGroup(name or actor)
    group.add_actor(actor)
    group.add_maneuver(maneuver)
    return group


def trigger_of(name: str, tests: Tests, kind: str = "start") -> xosc.Trigger:
    """Return groups of tests as a trigger."""
    trigger = xosc.Trigger(kind)
    for group in tests:
        conditions = xosc.ConditionGroup(kind)
        for nth, test in enumerate(group):
            edge, label = xosc.ConditionEdge.none, f"{name}, {nth + 1}" if len(group) > 1 else name
            if test.entity is None:
                conditions.add_condition(xosc.ValueTrigger(label, test.delay_s, edge, test.condition, kind))
            else:
                one = xosc.EntityTrigger(label, test.delay_s, edge, test.condition, test.entity, triggeringpoint=kind)
                conditions.add_condition(one)
        trigger.add_conditiongroup(conditions)
    return trigger


def _at(time_s: float) -> xosc.ValueTrigger:
    """Return the trigger of a time."""
    condition = xosc.SimulationTimeCondition(time_s, xosc.Rule.greaterOrEqual)
    return xosc.ValueTrigger("the beginning", 0, xosc.ConditionEdge.none, condition)


def _position(x_m: float, y_m: float, yaw_rad: float) -> xosc.WorldPosition:
    """Return a place in CARLA's axes as a position in OpenDRIVE's; the height is that of the road."""
    return xosc.WorldPosition(round(x_m, 4), round(-y_m, 4), h=round(-yaw_rad, 5))


def _following(name: str, points: NDArray) -> xosc.FollowTrajectoryAction:  # type: ignore[type-arg]
    """Return the action that follows points with times."""
    trajectory = xosc.Trajectory(f"way of {name}", closed=False)
    positions = [_position(*(float(value) for value in point[1:])) for point in points]
    trajectory.add_shape(xosc.Polyline([round(float(time_s), 3) for time_s in points[:, 0]], positions))
    return xosc.FollowTrajectoryAction(
        trajectory, xosc.FollowingMode.position, xosc.ReferenceContext.relative, scale=1, offset=0
    )
