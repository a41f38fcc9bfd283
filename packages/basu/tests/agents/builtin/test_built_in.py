"""Claims about the agents' own contract, as far as it holds without a server."""

from typing import Any

import carla
import pytest

from basu.agents.autonomous_agent import AutonomousAgent
from basu.agents.builtin.baselines import THROTTLE, ForwardAgent
from basu.agents.builtin.basic import BasicAgent
from basu.agents.builtin.behavioral import BehavioralAgent, DeviatingAgent
from basu.agents.builtin.driving.manner import AGGRESSIVE, CAUTIOUS, NORMAL, Manner
from basu.agents.loader import load_agent
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


@pytest.mark.parametrize(
    ("name", "manner"),
    [
        ("behavioral", NORMAL),
        ("behavioral-cautious", CAUTIOUS),
        ("behavioral-aggressive", AGGRESSIVE),
        ("deviating", NORMAL),
    ],
)
def test_each_name_of_the_behavioral_agents_has_its_manner(name: str, manner: Manner) -> None:
    agent = load_agent(name).agent_class()
    assert isinstance(agent, BehavioralAgent)
    assert agent.manner is manner


def test_the_deviating_agent_wants_the_thesiss_car_route_and_weather() -> None:
    assert DeviatingAgent().config() == {
        "routes": "routes/linden_short.xml",
        "sensors": "config/sensors.json",
        "vehicle": "vehicle.tesla.model3",
        "weather": "ClearSunset",
    }


@pytest.mark.parametrize("agent", [BasicAgent(), BehavioralAgent(), DeviatingAgent(), ForwardAgent()])
def test_what_an_agent_configures_is_known_to_basu(agent: AutonomousAgent) -> None:
    assert set(agent.config()) <= {"routes", "sensors", "vehicle", "weather", "sumo"}
