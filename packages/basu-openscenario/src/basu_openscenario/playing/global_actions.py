"""Actions on the world: entities come and go, variables change, signals switch, the environment is set."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu_openscenario.playing.running_action import AtOnce
from basu_openscenario.reading.actions import (
    AddEntityAction,
    DeleteEntityAction,
    EnvironmentAction,
    ModifyVariableAction,
    SetVariableAction,
    TrafficSignalControllerAction,
    TrafficSignalStateAction,
)

if TYPE_CHECKING:
    from basu_openscenario.playing.world import World
    from basu_openscenario.reading.actions import GlobalAction


class WorldChange(AtOnce):
    """Does a global action."""

    def __init__(self, name: str, world: World, action: GlobalAction) -> None:
        """Take the action as its file has it."""
        super().__init__(name, world, None)
        self.action = action

    def prepare(self) -> None:
        """Change the world."""
        action, world = self.action, self.world
        if isinstance(action, SetVariableAction):
            world.variables[action.name] = action.value
        elif isinstance(action, ModifyVariableAction):
            value = float(world.variables[action.name])
            changed = value + action.value if action.rule == "add" else value * action.value
            world.variables[action.name] = str(int(changed)) if changed.is_integer() else repr(changed)
        elif isinstance(action, EnvironmentAction):
            world.environment.update(action.values)
        elif isinstance(action, TrafficSignalStateAction):
            world.signals[action.signal] = action.state
        elif isinstance(action, TrafficSignalControllerAction):
            world.phases[action.controller] = (action.phase, world.time_s)
        elif isinstance(action, DeleteEntityAction):
            world.mover(action.entity).is_there = False
        else:
            assert isinstance(action, AddEntityAction), "there are no other global actions"
            mover = world.mover(action.entity)
            mover.is_there = True
            mover.place, mover.rear_m = world.place_of(action.position, mover), None
            mover.teleported = True
