"""What plays in the kinematic mode and not in a simulator, refused by name before anything moves."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.errors import ScenarioError
from basu_openscenario.reading import actions

if TYPE_CHECKING:
    from collections.abc import Iterator

    from basu_openscenario.reading.scenario_file import ScenarioFile

REFUSED: dict[type, str] = {
    actions.EnvironmentAction: "EnvironmentAction",
    actions.AddEntityAction: "AddEntityAction",
    actions.VisibilityAction: "VisibilityAction",
    actions.ConnectTrailerAction: "TrailerAction",
    actions.DisconnectTrailerAction: "TrailerAction",
}
"""Actions that a simulator would have to show and does not, with their elements."""
LAMPS = {2: ("Red", "Green"), 3: ("Red", "Yellow", "Green")}
"""The lamps of a light from top to bottom, by their number."""
WORDS = {"red": "Red", "yellow": "Yellow", "amber": "Yellow", "green": "Green", "off": "Off"}


def light_of(state: str) -> str | None:
    """Return the state of a traffic light of CARLA for a state of a signal; None where it has none.

    A state is a word, such as ``green``, or a list for the lamps from top to bottom, such as ``off;off;on``.
    """
    parts = [part.strip().lower() for part in state.split(";")]
    if len(parts) == 1:
        return WORDS.get(parts[0])
    if len(parts) not in LAMPS or not set(parts) <= {"on", "off"}:
        return None
    lit = [lamp for lamp, part in zip(LAMPS[len(parts)], parts, strict=True) if part == "on"]
    if not lit:
        return "Off"
    return "Yellow" if len(lit) > 1 else lit[0]  # red with yellow is about to be green: CARLA has no such state


def check_staged(scenario: ScenarioFile) -> None:
    """Refuse what a simulator cannot show.

    Raises:
        ScenarioError: names element, file and line.
    """
    if scenario.road_file is None:
        raise ScenarioError(f"{scenario.path}: the scenario has no road network; name one with <LogicFile>")
    for entity in scenario.entities.values():
        if entity.trailer:
            raise ScenarioError(
                f"{entity.line}: '{entity.name}' tows a trailer, which is not supported in the simulator; remove it"
            )
    for action, line in _actions(scenario):
        name = REFUSED.get(type(action))
        if name is not None:
            raise ScenarioError(f"{line}: <{name}> is not supported in the simulator; remove it")
        if isinstance(action, actions.TrafficSignalStateAction):
            _check_state(action.state, line)
    for controller in scenario.signal_controllers:
        for state in {state for phase in controller.phases for state in phase.states.values()}:
            _check_state(state, f"{scenario.path}: the controller '{controller.name}'")


def _check_state(state: str, where: str) -> None:
    """Refuse a state of a signal that no traffic light has."""
    if light_of(state) is None:
        raise ScenarioError(
            f"{where}: the state '{state}' of a signal is not supported in the simulator; write one of "
            f"{', '.join(WORDS)}, or two or three lamps such as off;off;on"
        )


def _actions(scenario: ScenarioFile) -> Iterator[tuple[actions.Action, str]]:
    """Yield actions with file and line: all but the environment and the visibility that every drive begins with."""
    board = scenario.storyboard
    where = str(scenario.path)
    yield from ((one, where) for one in board.global_actions if not isinstance(one, actions.EnvironmentAction))
    yield from ((action, line) for _, action, line in board.private_actions if not _shows_all(action))
    for group in (group for story in board.stories for act in story.acts for group in act.groups):
        for event in (event for maneuver in group.maneuvers for event in maneuver.events):
            yield from ((one.action, one.line) for one in event.actions if not _shows_all(one.action))


def _shows_all(action: actions.Action) -> bool:
    """Return whether an action makes an entity visible for all."""
    return isinstance(action, actions.VisibilityAction) and action.graphics and action.sensors and action.traffic
