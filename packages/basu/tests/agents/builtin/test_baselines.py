"""Claims about the control drivers; how they fare in the scenarios is tested with the scenarios."""

import math
from types import SimpleNamespace
from typing import Any

import carla
import pytest

from basu.agents.builtin.baselines import CREEP_MPS, BlindAgent, CreeperAgent, StandingAgent
from basu.agents.builtin.basic import BasicAgent
from basu.agents.builtin.driving.controllers import HOLD_BRAKE
from basu.agents.sight import ActorKind, Other, Sight

OTHERS = [Other(2, ActorKind.VEHICLE, 20.0, 0.0, 0.0, 0.0, 0.0, 0.0, 6.0, 1.25)]


class Recorder:
    """A driver that keeps what it is told about others."""

    def step(self, _ego: object, others: object, shows: object) -> SimpleNamespace:
        self.others, self.shows = others, shows
        return SimpleNamespace(throttle=0.4, brake=0.0, steer_rad=0.0)


def made(kind: type[BasicAgent]) -> Any:
    """An agent under way, with eyes that see a bus and lights that answer."""
    agent: Any = kind()
    pose = carla.Transform()
    box = carla.BoundingBox(carla.Location(0.0, 0.0, 1.4), carla.Vector3D(2.0, 1.0, 1.4))
    own = SimpleNamespace(get_transform=lambda: pose, get_velocity=carla.Vector3D)
    snapshot = SimpleNamespace(find=lambda _id: own, timestamp=SimpleNamespace(elapsed_seconds=1.0))
    agent.world = SimpleNamespace(get_snapshot=lambda: snapshot)
    agent.vehicle = SimpleNamespace(id=1, bounding_box=box, get_control=carla.VehicleControl)
    agent.facts = SimpleNamespace(steering=SimpleNamespace(command=lambda _angle_rad, _speed_mps: 0.0))
    agent.driver = Recorder()
    agent._sees = Sight(agent.world, agent.vehicle, knowledge=agent.knowledge)
    agent._sees._census = SimpleNamespace(near=lambda *_: OTHERS)
    agent._sees._visible = lambda found, _pose: [True for _ in found]
    agent._lights = SimpleNamespace(shows="lights")
    return agent


@pytest.mark.parametrize(("kind", "others"), [(BasicAgent, OTHERS), (BlindAgent, []), (CreeperAgent, [])])
def test_blind_drivers_know_the_lights_and_no_other_actor(kind: type[BasicAgent], others: list[Other]) -> None:
    agent = made(kind)
    assert agent.run_step({}).throttle == pytest.approx(0.4)
    assert (agent.driver.others, agent.driver.shows) == (others, "lights")


def test_only_the_creeper_has_a_speed_of_its_own() -> None:
    assert (BasicAgent.cruise_mps, BlindAgent.cruise_mps, CreeperAgent.cruise_mps) == (math.inf, math.inf, CREEP_MPS)


def test_the_standing_driver_holds_the_brake_from_the_first_step() -> None:
    control = made(StandingAgent).run_step({})
    assert (control.throttle, control.brake) == pytest.approx((0.0, HOLD_BRAKE))
