"""Claims about agents that cheat with a client of their own: each is caught, and a hard drive is no cheating."""

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from basu.cli import main
from basu.errors import AgentCrashedError
from basu.managers.base_manager import Ego, WorldChanges
from basu.managers.conduct import LOOK_TICKS, Conduct
from cheating_agent import cheating_agent
from servers import RunningServer

TELEPORT = "self.vehicle.set_transform(self.route.waypoints[-1].transform)"
CREEP = (
    "pose = self.vehicle.get_transform(); ahead = pose.get_forward_vector(); "
    "pose.location += carla.Location(0.4 * ahead.x, 0.4 * ahead.y, 0.0); self.vehicle.set_transform(pose)"
)
BOOST = "self.vehicle.set_target_velocity(30.0 * self.vehicle.get_transform().get_forward_vector())"
NIGHT = "self.world.set_weather(carla.WeatherParameters.HardRainNight); self.world.get_weather()"
LIGHTER = (
    "physics = self.vehicle.get_physics_control(); physics.mass = 10.0; self.vehicle.apply_physics_control(physics)"
)
TICKS = "[self.world.tick() for _ in range(160)]"


def ego(x_m: float, speed_mps: float) -> Ego:
    return Ego(x_m, 0.0, 0.0, 0.0, 0.0, 0.0, speed_mps, *[0.0] * 8)


def watched(places_and_speeds: list[tuple[float, float]], contact_tick: int | None = None) -> Conduct:
    """A watch that has seen a drive along x, at 20 Hz in an empty world."""
    conduct = Conduct("Cheat")
    world = SimpleNamespace(get_actors=lambda _: [])
    box = SimpleNamespace(extent=SimpleNamespace(x=2.0, y=1.0))
    vehicle = SimpleNamespace(id=1, bounding_box=box)
    contacts: list[Any] = [] if contact_tick is None else [SimpleNamespace(tick=contact_tick, other_id=0)]
    changes = WorldChanges(contacts=lambda tick: [contact for contact in contacts if contact.tick >= tick])
    run: Any = SimpleNamespace(step_s=0.05, world=world, vehicle=vehicle, neighbours=None, changes=changes)
    conduct._run = run
    for number, (x_m, speed_mps) in enumerate(places_and_speeds):
        frame: Any = SimpleNamespace(tick=number, server_frame=number, ego=ego(x_m, speed_mps), snapshot=[])
        conduct.before(frame)
    return conduct


def test_a_drive_that_its_speed_explains_is_one() -> None:
    watched([(0.05 * 10.0 * n, 10.0) for n in range(100)])


def test_a_crash_is_no_cheating() -> None:
    watched([(0.5 * n, 10.0) for n in range(40)] + [(19.5, 0.0)] * 40, contact_tick=40)


def test_a_stop_that_no_tyre_gives_needs_a_contact() -> None:
    with pytest.raises(AgentCrashedError, match=r"lost 10\.0 m/s in one step and touched nothing"):
        watched([(0.5 * n, 10.0) for n in range(40)] + [(19.5, 0.0)] * 40)


@pytest.mark.parametrize("step_m", [0.15, 0.4, 50.0])
def test_jumps_are_seen_large_and_small(step_m: float) -> None:
    with pytest.raises(AgentCrashedError, match=r"m farther than its speed explains .* Cheat may drive it"):
        watched([(step_m * n, 0.0) for n in range(40)])


def test_speed_from_nowhere_is_seen() -> None:
    with pytest.raises(AgentCrashedError, match=r"gained 20\.0 m/s in one step with nothing near"):
        watched([(0.0, 0.0), (0.5, 20.0)])


def test_a_look_at_a_vehicle_that_is_gone_leaves_the_verdict_to_the_next_step() -> None:
    def gone() -> None:
        raise RuntimeError("Actor could not be found in the registry")

    conduct = watched([(0.0, 5.0)])
    run: Any = conduct._run
    run.own_simulator, run.world.get_weather, run.vehicle.get_physics_control = False, gone, gone
    frame: Any = SimpleNamespace(tick=1, server_frame=1)
    for _ in range(4 * LOOK_TICKS):
        conduct.after(frame)


@pytest.mark.parametrize(
    ("at_setup", "deed", "own", "sentence"),
    [
        pytest.param("pass", TELEPORT, False, "farther than its speed explains", id="jumps to the goal"),
        pytest.param("pass", CREEP, False, "farther than its speed explains", id="jumps a little each step"),
        pytest.param("pass", BOOST, False, "gained", id="speed from nowhere"),
        pytest.param(NIGHT, "pass", False, "changed the weather's", id="weather"),
        pytest.param(LIGHTER, "pass", False, "changed the vehicle's mass", id="physics"),
        pytest.param("pass", "self.world.tick()", True, "never ticks the world", id="ticks"),
        pytest.param(TICKS, "pass", True, "during setup() the simulator went from frame", id="ticks in setup"),
        pytest.param(TELEPORT, "pass", True, "farther than its speed explains", id="jumps in setup"),
        pytest.param("pass", "self.vehicle.destroy()", True, "out of the world", id="takes the vehicle away"),
    ],
)
@pytest.mark.usefixtures("one_server")
def test_an_agent_that_cheats_has_failed(
    simulator: RunningServer, route_file: Path, tmp_path: Path, *, at_setup: str, deed: str, own: bool, sentence: str
) -> None:
    agent = cheating_agent(tmp_path, "cheat", at_setup=at_setup, deed=deed)
    address = [] if own else ["--host", "127.0.0.1", "--port", str(simulator.port)]
    words = [str(agent), *address, "--routes", str(route_file), "--output", str(tmp_path / "runs")]
    assert main(["run", *words]) == 1
    result = json.loads((tmp_path / "runs" / "latest" / "result.json").read_text())
    assert (result["status"], result["fault"]) == ("AgentCrashed", "agent")
    assert sentence in result["message"]
