"""The storyboard of a file as elements at work."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from basu.errors import ScenarioError
from basu_openscenario.playing.at_once import (
    Acquisition,
    ControllerActivation,
    ControllerAssignment,
    LightChange,
    RouteAssignment,
    Teleport,
    VisibilityChange,
)
from basu_openscenario.playing.condition_tests import (
    ElementTest,
    SignalControllerTest,
    SignalTest,
    TimeTest,
    VariableTest,
)
from basu_openscenario.playing.elements import Element, EventElement, RepeatedElement, StoryElement
from basu_openscenario.playing.entity_tests import EntityTest
from basu_openscenario.playing.following import TrajectoryFollowing
from basu_openscenario.playing.global_actions import WorldChange
from basu_openscenario.playing.lateral import LaneChange, LaneOffset
from basu_openscenario.playing.longitudinal import DistanceKeeping, SpeedChange
from basu_openscenario.playing.side_distance import SideDistance
from basu_openscenario.playing.speed_profile import SpeedProfile
from basu_openscenario.playing.synchronisation import Synchronisation
from basu_openscenario.playing.towing import TrailerConnection, TrailerDisconnection
from basu_openscenario.playing.traffic_actions import TRAFFIC_MAKERS
from basu_openscenario.playing.triggers import RunningCondition, RunningTrigger
from basu_openscenario.reading import actions
from basu_openscenario.reading.conditions import ByElement, ByEntity, BySignal, BySignalController, ByTime, ByVariable
from basu_openscenario.reading.xml_node import at_line

if TYPE_CHECKING:
    from collections.abc import Callable

    from basu_openscenario.playing.mover import Mover
    from basu_openscenario.playing.running_action import RunningAction
    from basu_openscenario.playing.triggers import Test
    from basu_openscenario.playing.world import World
    from basu_openscenario.reading.conditions import Condition, Trigger
    from basu_openscenario.reading.scenario_file import ScenarioFile
    from basu_openscenario.reading.storyboard import Event, NamedAction

MAKERS: dict[type, Callable[..., RunningAction]] = {
    actions.SpeedAction: SpeedChange,
    actions.SpeedProfileAction: SpeedProfile,
    actions.LongitudinalDistanceAction: DistanceKeeping,
    actions.LaneChangeAction: LaneChange,
    actions.LaneOffsetAction: LaneOffset,
    actions.LateralDistanceAction: SideDistance,
    actions.TeleportAction: Teleport,
    actions.SynchronizeAction: Synchronisation,
    actions.AssignRouteAction: RouteAssignment,
    actions.AcquirePositionAction: Acquisition,
    actions.FollowTrajectoryAction: TrajectoryFollowing,
    actions.VisibilityAction: VisibilityChange,
    actions.AssignControllerAction: ControllerAssignment,
    actions.ActivateControllerAction: lambda name, world, mover, _: ControllerActivation(name, world, mover),
    actions.LightStateAction: LightChange,
    actions.ConnectTrailerAction: TrailerConnection,
    actions.DisconnectTrailerAction: lambda name, world, mover, _: TrailerDisconnection(name, world, mover),
}
"""What does each private action."""


def private_action(name: str, world: World, mover: Mover, action: actions.PrivateAction, line: str) -> RunningAction:
    """Return a private action at work; its errors begin with its file and line."""
    try:
        made = MAKERS[type(action)](name, world, mover, action)
    except ScenarioError as error:
        raise at_line(line, error) from error
    made.line = line
    return made


def global_action(name: str, world: World, action: actions.GlobalAction, line: str = "") -> RunningAction:
    """Return the running form of a global action, such as one on parameters, signals or traffic."""
    made = TRAFFIC_MAKERS.get(type(action), WorldChange)(name, world, action)
    made.line = line or made.line
    return made


def build(scenario: ScenarioFile, world: World) -> tuple[Element, list[RunningAction]]:
    """Return the storyboard with its triggers, and its init actions in the order in which they are done.

    Raises:
        ScenarioError: triggering entities are to become actors, or a variable does not exist.
    """
    board = scenario.storyboard
    stories: list[Element] = []
    pending: list[tuple[Element, Trigger | None, Trigger | None]] = []
    for story in board.stories:
        acts: list[Element] = []
        for act in story.acts:
            groups: list[Element] = []
            for group in act.groups:
                if group.by_trigger:
                    raise ScenarioError(
                        f'{group.line}: selectTriggeringEntities="true" is not supported; name the actors'
                    )
                names = [inside for one in group.actors for inside in scenario.selections.get(one, (one,))]
                movers = [world.mover(name) for name in names]
                maneuvers: list[Element] = []
                for maneuver in group.maneuvers:
                    events = [_event(event, movers, world) for event in maneuver.events]
                    pending += [(made, event.start, None) for made, event in zip(events, maneuver.events, strict=True)]
                    maneuvers.append(StoryElement("maneuver", maneuver.name, events))
                groups.append(RepeatedElement("maneuverGroup", group.name, maneuvers, group.most))
            made_act = StoryElement("act", act.name, groups)
            pending.append((made_act, act.start, act.stop))
            acts.append(made_act)
        stories.append(StoryElement("story", story.name, acts))
    root = StoryElement("storyboard", "storyboard", stories)
    pending.append((root, None, board.stop))
    root.name_paths()
    everything = root.all()
    make = partial(_trigger, world=world, scenario=scenario, elements=everything)
    for element, start, stop in pending:
        element.start_trigger = make(start)
        element.stop_trigger = make(stop)
    init: list[RunningAction] = [global_action("init", world, action) for action in board.global_actions]
    for entity, action, line in board.private_actions:
        meant = scenario.selections.get(entity, (entity,))
        init += [private_action("init", world, world.mover(name), action, line) for name in meant]
    return root, init


def _event(event: Event, movers: list[Mover], world: World) -> EventElement:
    """Return an event with an action for each actor."""
    made: list[Element] = []
    for one in event.actions:
        if one.is_private:
            made += [_private(one, world, mover) for mover in movers]
        else:
            made.append(global_action(one.name, world, one.action, one.line))  # type: ignore[arg-type]
    return EventElement(event.name, made, event.most, event.priority)


def _private(one: NamedAction, world: World, mover: Mover) -> RunningAction:
    """Return the private action of an event for one actor."""
    return private_action(one.name, world, mover, one.action, one.line)  # type: ignore[arg-type]


def _trigger(
    trigger: Trigger | None, *, world: World, scenario: ScenarioFile, elements: list[Element]
) -> RunningTrigger | None:
    """Return a trigger at work; a trigger without conditions counts as none."""
    if trigger is None or not any(trigger.groups):
        return None
    groups = [
        [RunningCondition(one, _test(one, world, scenario, elements)) for one in group] for group in trigger.groups
    ]
    return RunningTrigger(groups, world)


def _test(condition: Condition, world: World, scenario: ScenarioFile, elements: list[Element]) -> Test:
    """Return what a condition compares."""
    test = condition.test
    if isinstance(test, ByTime):
        return TimeTest(test)
    if isinstance(test, ByElement):
        meant = [
            one
            for one in elements
            if one.kind == test.kind and (one.path == test.name or one.path.endswith(f"::{test.name}"))
        ]
        return ElementTest(test, meant)
    if isinstance(test, ByVariable):
        if test.name not in world.variables:
            raise ScenarioError(f"{condition.line}: the variable '{test.name}' is not declared; declare it")
        return VariableTest(test, world)
    if isinstance(test, BySignal):
        return SignalTest(test, world)
    if isinstance(test, BySignalController):
        return SignalControllerTest(test, world)
    assert isinstance(test, ByEntity), "there are no other conditions"
    members = tuple(inside for one in test.entities for inside in scenario.selections.get(one, (one,)))
    return EntityTest(test, world, members)
