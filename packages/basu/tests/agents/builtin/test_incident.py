"""Claims about the agent of 20 February 2020, with the basic agent's head and the vehicle put in by hand."""

from types import SimpleNamespace
from typing import Any

import carla
import pytest

from basu.agents.builtin.basic import BasicAgent
from basu.agents.builtin.driving.controllers import HOLD_BRAKE
from basu.agents.builtin.incident import DEVIATION_SHARE, DEVIATION_STEER, STANDING_S, STOP_MPS2, IncidentAgent

FULL_BRAKE_MPS2, END_M = 7.0, 100.0


@pytest.fixture
def agent(monkeypatch: pytest.MonkeyPatch) -> IncidentAgent:
    """Its basic half answers throttle 0.3 and a little steering; place and speed are the test's to set."""
    monkeypatch.setattr(BasicAgent, "run_step", lambda _self, _data: carla.VehicleControl(throttle=0.3, steer=0.1))
    monkeypatch.setattr(BasicAgent, "setup", lambda _self: None)
    made: Any = IncidentAgent()
    made.setup()
    made.time_step_s = 0.05
    made.facts = SimpleNamespace(model=SimpleNamespace(full_brake_mps2=FULL_BRAKE_MPS2))
    made.driver = SimpleNamespace(place=SimpleNamespace(s_m=0.0), path=SimpleNamespace(end_s_m=END_M))
    made.vehicle = SimpleNamespace(get_velocity=lambda: SimpleNamespace(length=lambda: made.speed_mps))
    made.speed_mps = 3.17
    incident: IncidentAgent = made
    return incident


def at(agent: Any, s_m: float, speed_mps: float = 3.17) -> carla.VehicleControl:
    agent.speed_mps = speed_mps
    if agent.driver is not None:
        agent.driver.place.s_m = s_m
    return agent.run_step({})


def test_until_the_deviation_it_drives_as_the_basic_agent(agent: IncidentAgent) -> None:
    control = at(agent, DEVIATION_SHARE * END_M - 0.1)
    assert (control.throttle, control.brake, control.steer) == pytest.approx((0.3, 0.0, 0.1))


def test_one_small_deviation_and_it_brakes_to_rest(agent: IncidentAgent) -> None:
    deviated = at(agent, DEVIATION_SHARE * END_M)
    assert deviated.steer == pytest.approx(0.1 + DEVIATION_STEER)
    for speed_mps in (3.17, 2.0, 0.1):
        control = at(agent, DEVIATION_SHARE * END_M + 1.0, speed_mps)
        assert (control.throttle, control.brake) == pytest.approx((0.0, STOP_MPS2 / FULL_BRAKE_MPS2))


def test_after_a_rest_it_gets_in_anew_and_does_not_stop_again(agent: IncidentAgent) -> None:
    at(agent, DEVIATION_SHARE * END_M)
    driver = agent.driver
    for _ in range(round(STANDING_S / 0.05)):
        assert at(agent, 80.0, 0.0).brake == pytest.approx(HOLD_BRAKE)
    assert agent.driver is None  # what it remembers of the road is forgotten
    agent.driver = driver
    control = at(agent, 90.0)
    assert (control.throttle, control.steer) == pytest.approx((0.3, 0.1))
    assert at(agent, 91.0).throttle == pytest.approx(0.3)
