"""Claims about the agents' own contract, as far as it holds without a server."""

from typing import Any

import carla
import pytest

from basu.agents.autonomous_agent import AutonomousAgent
from basu.agents.basic import BasicAgent
from basu.agents.forward import THROTTLE, ForwardAgent
from basu.errors import UserError


def bound(agent: AutonomousAgent) -> AutonomousAgent:
    nothing: Any = None
    agent.bind(
        client=nothing, world=nothing, map=nothing, vehicle=nothing, route=None, config_values={}, time_step_s=0.05
    )
    return agent


def test_the_forward_agent_goes_ahead_whatever_it_sees() -> None:
    agent = bound(ForwardAgent())
    agent.setup()
    assert agent.run_step({}) == carla.VehicleControl(throttle=THROTTLE)
    assert agent.get_initial_route_locations() is None
    agent.destroy()


def test_the_basic_agent_without_a_route_says_what_it_needs() -> None:
    with pytest.raises(UserError, match="follows a route and was given none"):
        bound(BasicAgent()).setup()


def test_an_agent_needs_its_three_methods() -> None:
    class Idle(AutonomousAgent):
        def setup(self) -> None: ...

    with pytest.raises(TypeError, match="abstract"):
        Idle()  # type: ignore[abstract]


@pytest.mark.parametrize("agent", [BasicAgent(), ForwardAgent()])
def test_what_an_agent_configures_is_known_to_basu(agent: AutonomousAgent) -> None:
    assert set(agent.config()) <= {"routes", "sensors", "vehicle", "weather", "sumo"}
