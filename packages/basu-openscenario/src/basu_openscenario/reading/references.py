"""The names that a scenario refers to: every entity and every element of the storyboard must exist."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import TYPE_CHECKING, Any

from basu.errors import ScenarioError
from basu_openscenario.reading.conditions import ByElement, ByEntity
from basu_openscenario.reading.traffic import (
    MOST_ACTIONS,
    MOST_VEHICLES,
    TrafficAction,
    TrafficAreaAction,
    TrafficStopAction,
    TrafficSwarmAction,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from basu_openscenario.reading.conditions import Condition, Trigger
    from basu_openscenario.reading.scenario_file import ScenarioFile
    from basu_openscenario.reading.storyboard import Storyboard

ENTITY_FIELDS = frozenset({"entity", "master"})
"""Fields of actions, measures and positions that name an entity."""


def check_references(scenario: ScenarioFile) -> None:
    """Check the names of a scenario.

    Raises:
        ScenarioError: an entity or an element of the storyboard does not exist.
    """
    board = scenario.storyboard
    names = {*scenario.entities, *scenario.selections}
    elements = element_names(board)

    _check_traffic(board)
    for name, line in _entities_named(board):
        if name and name not in names:
            there = ", ".join(sorted(names)) or "none"
            raise ScenarioError(f"{line}: the entity '{name}' does not exist; there are {there}")
    for condition in conditions_of(board):
        test = condition.test
        if isinstance(test, ByElement) and not any(
            kind == test.kind and (path == test.name or path.endswith(f"::{test.name}")) for kind, path in elements
        ):
            raise ScenarioError(
                f"{condition.line}: the storyboard has no {test.kind} called '{test.name}'; correct the name"
            )


def _check_traffic(board: Storyboard) -> None:
    """Refuse more actions on traffic, or more vehicles at a time, than there may be, and ends of none of them."""
    groups = [group for story in board.stories for act in story.acts for group in act.groups]
    events = [event for group in groups for maneuver in group.maneuvers for event in maneuver.events]
    given = [*board.global_actions, *(one.action for event in events for one in event.actions)]
    found = [one for one in given if isinstance(one, TrafficAction)]
    names = {one.name for one in found if not isinstance(one, TrafficStopAction)}
    count = 0
    for nth, one in enumerate(found, 1):
        if nth > MOST_ACTIONS:
            raise ScenarioError(f"{one.line}: this is the {nth}th action on traffic; up to {MOST_ACTIONS} are played")
        if isinstance(one, TrafficSwarmAction | TrafficAreaAction):
            count += one.count
        if count > MOST_VEHICLES:
            raise ScenarioError(
                f"{one.line}: swarms and areas ask for {count} vehicles of traffic in all; a scenario has up to "
                f"{MOST_VEHICLES} at a time: make them fewer"
            )
        if isinstance(one, TrafficStopAction) and one.name and one.name not in names:
            there = ", ".join(sorted(name for name in names if name)) or "none with a name"
            raise ScenarioError(f"{one.line}: no action on traffic is called '{one.name}'; there are {there}")


def _entities_named(board: Storyboard) -> Iterator[tuple[str, str]]:
    """Yield every entity that a storyboard names, with file and line."""
    for one in board.global_actions:
        yield from ((name, getattr(one, "line", "")) for name in _named(one))
    for entity, action, line in board.private_actions:
        yield from ((name, line) for name in (entity, *_named(action)))
    for group in (group for story in board.stories for act in story.acts for group in act.groups):
        yield from ((name, group.line) for name in group.actors)
        for event in (event for maneuver in group.maneuvers for event in maneuver.events):
            yield from ((name, one.line) for one in event.actions for name in _named(one.action))
    for condition in conditions_of(board):
        test = condition.test
        if isinstance(test, ByEntity):
            names = (*test.entities, *_named(test.measure), *test.measure.entities)
            yield from ((name, condition.line) for name in names)


def _named(value: Any) -> Iterator[str]:  # noqa: ANN401 - any dataclass of a scenario
    """Yield the entities that a dataclass and the dataclasses inside it name."""
    if isinstance(value, tuple):
        for one in value:
            yield from _named(one)
    if not is_dataclass(value):
        return
    for field in fields(value):
        inside = getattr(value, field.name)
        if field.name in ENTITY_FIELDS and isinstance(inside, str):
            yield inside
        else:
            yield from _named(inside)


def conditions_of(board: Storyboard) -> Iterator[Condition]:
    """Yield all conditions of a storyboard."""
    triggers: list[Trigger | None] = [board.stop]
    for act in (act for story in board.stories for act in story.acts):
        triggers += [act.start, act.stop]
        triggers += [event.start for group in act.groups for maneuver in group.maneuvers for event in maneuver.events]
    for trigger in triggers:
        for group in () if trigger is None else trigger.groups:
            yield from group


def element_names(board: Storyboard) -> list[tuple[str, str]]:
    """Return kind and full name, with ``::`` between levels, of each element of a storyboard."""
    found = []
    for story in board.stories:
        found.append(("story", story.name))
        for act in story.acts:
            found.append(("act", f"{story.name}::{act.name}"))
            for group in act.groups:
                base = f"{story.name}::{act.name}::{group.name}"
                found.append(("maneuverGroup", base))
                for maneuver in group.maneuvers:
                    found.append(("maneuver", f"{base}::{maneuver.name}"))
                    for event in maneuver.events:
                        found.append(("event", f"{base}::{maneuver.name}::{event.name}"))
                        found += [
                            ("action", f"{base}::{maneuver.name}::{event.name}::{one.name}") for one in event.actions
                        ]
    return found
