"""Claims about a person beside the agent: which one is called, and which control counts."""

from types import SimpleNamespace
from typing import Any
from unittest.mock import Mock

import carla
import pytest

from basu.agents.autonomous_agent import AutonomousAgent
from basu.agents.loader import LoadedAgent
from basu.errors import AgentCrashedError
from basu.managers.agents_manager import AgentsManager
from basu_window.manual.inputs import Held, Input, Person, Strike
from basu_window.manual.session import Played, Session, Setting

P = Input(strikes=(Strike.AUTOPILOT,))
SETTING = Setting(town="Linden", route="1", vehicle="vehicle.tesla.model3", step_s=0.05)


class Steady(AutonomousAgent):
    """Always the same; ``asked`` counts."""

    asked = 0

    def setup(self) -> None: ...

    def run_step(self, sensor_data: Any) -> carla.VehicleControl:
        self.asked += 1
        if self.asked > 5:
            raise ValueError("enough")
        return carla.VehicleControl(throttle=0.5)

    def config(self) -> Any:
        return {}


def managed(*inputs: Input) -> AgentsManager:
    person = Person(
        Played(Session(setting=SETTING, inputs=inputs), None), drives_first=False, taken_by_any_input=False, live=False
    )
    manager = AgentsManager(LoadedAgent(Steady, "steady", None), step_limit_s=30.0, routes=None, person=person)
    run: Any = Mock(config=manager.config, step_s=0.05)
    manager.setup(run)
    return manager


def ticked(manager: AgentsManager, tick: int) -> tuple[bool, float]:
    frame: Any = SimpleNamespace(tick=tick, server_frame=tick)
    manager.tick(frame)
    return manager.manual, round(manager.control.throttle, 3)


def test_the_persons_control_counts_while_they_drive_and_the_agent_still_steps() -> None:
    manager = managed(Input(Held.THROTTLE), P, Input(Held.THROTTLE), P, Input())
    assert [ticked(manager, tick) for tick in range(5)] == [
        (False, 0.5),
        (True, 0.0),
        (True, 0.1),
        (False, 0.5),
        (False, 0.5),
    ]
    assert manager._agent.agent.asked == 5


def test_an_agent_that_fails_while_a_person_drives_has_failed() -> None:
    manager = managed(P)
    for tick in range(5):
        ticked(manager, tick)
    assert manager.manual
    with pytest.raises(AgentCrashedError, match="enough"):
        ticked(manager, 5)
