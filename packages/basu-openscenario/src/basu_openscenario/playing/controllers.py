"""Controllers: which leave an entity to the storyboard, and which move it by rules that only one program knows."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.errors import ScenarioError
from basu_openscenario.reading.actions import ActivateControllerAction, AssignControllerAction
from basu_openscenario.reading.entities import PROGRAMS_OWN

if TYPE_CHECKING:
    from basu_openscenario.reading.entities import Controller
    from basu_openscenario.reading.scenario_file import ScenarioFile

DEFAULT = "DefaultController"


def check_controllers(scenario: ScenarioFile, ego: str | None = None) -> None:
    """Refuse controllers that are activated and that would move an entity by rules of another program.

    A controller without the property `PROGRAMS_OWN` stands for the system under test: the storyboard moves its
    entity, or the agent does. A controller that is assigned and never activated does nothing.

    Args:
        scenario: the file.
        ego: the entity that an agent drives; its controllers do not count.

    Raises:
        ScenarioError: names controller and entity.
    """
    board = scenario.storyboard
    assigned: dict[str, list[Controller]] = {name: list(one.controllers) for name, one in scenario.entities.items()}
    found = [((entity,), action, line) for entity, action, line in board.private_actions]
    for group in (group for story in board.stories for act in story.acts for group in act.groups):
        for event in (event for maneuver in group.maneuvers for event in maneuver.events):
            found += [(group.actors, one.action, one.line) for one in event.actions if one.is_private]  # type: ignore[misc]
    for names, action, line in found:
        for name in (inside for one in names for inside in scenario.selections.get(one, (one,))):
            if isinstance(action, AssignControllerAction):
                assigned[name].append(action.controller)
            activates = isinstance(action, ActivateControllerAction | AssignControllerAction) and (
                action.lateral or action.longitudinal
            )
            if not activates or name == ego:
                continue
            for controller in assigned[name]:
                kind = controller.properties.get(PROGRAMS_OWN, DEFAULT)
                if kind != DEFAULT:
                    raise ScenarioError(
                        f"{line}: the controller '{controller.name}' of '{name}' is {kind}, which is esmini's own and "
                        "not supported; remove its activation, or let an agent drive the entity"
                    )
