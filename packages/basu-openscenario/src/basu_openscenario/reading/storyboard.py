"""The storyboard of a scenario: init actions, stories, acts, groups of manoeuvres, manoeuvres and events."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from basu_openscenario.reading.action_reading import read_private_action
from basu_openscenario.reading.catalogs import resolved
from basu_openscenario.reading.conditions import Trigger, read_trigger
from basu_openscenario.reading.global_action_reading import read_global_action
from basu_openscenario.reading.parameters import declared

if TYPE_CHECKING:
    from basu_openscenario.reading.actions import Action, GlobalAction, PrivateAction
    from basu_openscenario.reading.catalogs import Catalogs
    from basu_openscenario.reading.xml_node import Node

PRIORITIES = {"override": "override", "overwrite": "override", "parallel": "parallel", "skip": "skip"}


@dataclass(frozen=True, slots=True)
class NamedAction:
    """An action of an event; ``is_private`` where each actor of the group does it."""

    name: str
    action: Action
    is_private: bool
    line: str


@dataclass(frozen=True, slots=True)
class Event:
    """Actions that begin together; ``most`` counts executions, None without a limit."""

    name: str
    priority: str
    most: int | None
    actions: tuple[NamedAction, ...]
    start: Trigger | None


@dataclass(frozen=True, slots=True)
class Maneuver:
    """Events of the same actors."""

    name: str
    events: tuple[Event, ...]


@dataclass(frozen=True, slots=True)
class ManeuverGroup:
    """Manoeuvres with their actors; ``by_trigger`` where the triggering entities become actors."""

    name: str
    most: int | None
    actors: tuple[str, ...]
    by_trigger: bool
    maneuvers: tuple[Maneuver, ...]
    line: str


@dataclass(frozen=True, slots=True)
class Act:
    """Groups of manoeuvres that begin and end by triggers."""

    name: str
    groups: tuple[ManeuverGroup, ...]
    start: Trigger | None
    stop: Trigger | None


@dataclass(frozen=True, slots=True)
class Story:
    """Acts."""

    name: str
    acts: tuple[Act, ...]


@dataclass(frozen=True, slots=True)
class Storyboard:
    """All that happens in a scenario."""

    global_actions: tuple[GlobalAction, ...]
    private_actions: tuple[tuple[str, PrivateAction, str], ...]
    """Entity, action, and file with line."""
    stories: tuple[Story, ...]
    stop: Trigger | None


def read_storyboard(node: Node, catalogs: Catalogs) -> Storyboard:
    """Return the storyboard.

    Raises:
        ScenarioError: something in it is not supported, or incomplete.
    """
    actions = node.child("Init").child("Actions")
    for one in actions.children("UserDefinedAction"):
        raise one.fault("<UserDefinedAction> is not supported; remove it")
    private: list[tuple[str, PrivateAction, str]] = []
    for block in actions.children("Private"):
        entity = block.text("entityRef")
        private += [(entity, read_private_action(one, catalogs), one.line) for one in block.children("PrivateAction")]
    return Storyboard(
        tuple(read_global_action(one, catalogs) for one in actions.children("GlobalAction")),
        tuple(private),
        tuple(_story(one, catalogs) for one in node.children("Story")),
        read_trigger(node.find("StopTrigger"), catalogs),
    )


def _most(node: Node) -> int | None:
    """Return how often an element is executed; None without a limit, which esmini's files write as -1."""
    count = node.integer("maximumExecutionCount", 1)
    return None if count < 0 else count


def _story(node: Node, catalogs: Catalogs) -> Story:
    """Return a story; its name may be missing since version 1.3."""
    node = node.within(declared(node))
    return Story(node.text("name", ""), tuple(_act(one, catalogs) for one in node.children("Act")))


def _act(node: Node, catalogs: Catalogs) -> Act:
    """Return an act."""
    return Act(
        node.text("name"),
        tuple(_group(one, catalogs) for one in node.children("ManeuverGroup")),
        read_trigger(node.find("StartTrigger"), catalogs),
        read_trigger(node.find("StopTrigger"), catalogs),
    )


def _group(node: Node, catalogs: Catalogs) -> ManeuverGroup:
    """Return a group of manoeuvres."""
    actors = node.child("Actors")
    maneuvers = []
    for one in node.children("Maneuver", "CatalogReference"):
        found = resolved(one, catalogs)
        if found.tag != "Maneuver":
            raise one.fault(f"the reference leads to a <{found.tag}>; it needs a <Maneuver>")
        maneuvers.append(_maneuver(found, catalogs))
    return ManeuverGroup(
        node.text("name"),
        _most(node),
        tuple(one.text("entityRef") for one in actors.children("EntityRef")),
        actors.boolean("selectTriggeringEntities"),
        tuple(maneuvers),
        node.line,
    )


def _maneuver(node: Node, catalogs: Catalogs) -> Maneuver:
    """Return a manoeuvre."""
    return Maneuver(node.text("name"), tuple(_event(one, catalogs) for one in node.children("Event")))


def _event(node: Node, catalogs: Catalogs) -> Event:
    """Return an event."""
    actions = []
    for one in node.children("Action"):
        inside = one.only()
        if inside.tag == "PrivateAction":
            action: Action = read_private_action(inside, catalogs)
        elif inside.tag == "GlobalAction":
            action = read_global_action(inside, catalogs)
        else:
            raise inside.fault(f"<{inside.tag}> is not supported; use PrivateAction or GlobalAction")
        actions.append(NamedAction(one.text("name"), action, inside.tag == "PrivateAction", one.line))
    return Event(
        node.text("name"),
        PRIORITIES[node.choice("priority", tuple(PRIORITIES))],
        _most(node),
        tuple(actions),
        read_trigger(node.find("StartTrigger"), catalogs),
    )
